"""Draws the nominal and the worst case of a `clearance run --out FOLDER`, as the picture in the README.

.venv/bin/clearance run campaigns/library/unicycle_navigation.yaml --out FOLDER
.venv/bin/python tools/picture.py FOLDER docs/images/worst-case.svg

The tracks are those of the folder's traces and the values those of its `result.json`: nothing is simulated here.
For one static obstacle in the plane.
"""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from typing import Any

from backend.reports.figures import Case, Quantity
from backend.reports.plan_view import plan_view
from backend.reports.plot import INK, NOMINAL, WORST
from campaigns.claims.numbers import limit
from campaigns.results.trace import Closest, TraceHead, TraceObstacle

FONT = "font:12px Inter,system-ui,sans-serif"


def read(folder: Path, name: str) -> dict[str, list[float | None]]:
    """The columns of a trace by their name without the unit."""
    with (folder / f"trace-{name}.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {key.partition(" ")[0]: [float(row[key]) for row in rows] for key in rows[0]}


def case(folder: Path, name: str, label: str, colour: str, campaign: dict[str, Any]) -> Case:
    """A track with its closest approach to the obstacle's centre, at the step where it is lowest."""
    data = read(folder, name)
    at = min(range(len(data["t"])), key=lambda i: data["separation"][i] or 0.0)
    scenario = campaign["scenario"]
    given = scenario["obstacles"][0]["parameters"]
    centre = [given["position.x"], given["position.y"]]
    free = campaign["criterion"]["threshold"]
    obstacle = TraceObstacle(title="Obstacle", position=centre, radius=given["radius"], free_radius=free)
    head = TraceHead(
        obstacles=[obstacle],
        start=[scenario["start"]["x"], scenario["start"]["y"]],
        goal=[scenario["goal"]["x"], scenario["goal"]["y"]],
        closest=Closest(
            time=data["t"][at] or 0.0,
            value=data["separation"][at] or 0.0,
            position=[data["x"][at] or 0.0, data["y"][at] or 0.0],
            obstacle=0,
            obstacle_position=centre,
        ),
    )
    # Without its separations the track is drawn whole; a tenth of its steps is enough for the eye.
    return Case(label, colour, head, {axis: data[axis][::10] for axis in ("x", "y")})


def legend(colour: str, row: int, words: str, dash: str = "") -> str:
    """One line of the legend."""
    y = 24 + 17 * row
    return (
        f'<path d="M60 {y}h22" stroke="{colour}" stroke-width="2" stroke-dasharray="{dash}"/>'
        f'<text x="90" y="{y + 4}" fill="{INK}" style="{FONT}">{words}</text>'
    )


def main(folder: Path, target: Path) -> None:
    """Write the picture."""
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    campaign = json.loads((folder / "campaign.json").read_text(encoding="utf-8"))
    worst, threshold = result["findings"][0], campaign["criterion"]["threshold"]
    values = f"nominal {result['nominal']['cost']:.4f} m, worst {worst['cost']:.4f} m"
    cases = [
        case(folder, "nominal", "Nominal", NOMINAL, campaign),
        case(folder, worst["label"], "Worst", WORST, campaign),
    ]
    drawn = str(plan_view(cases, Quantity("d_min", "m", threshold)))
    lines = [
        legend(NOMINAL, 0, f"Nominal: d_min {result['nominal']['cost']:.4f} m"),
        legend(WORST, 1, f"Worst case found, {worst['label']}: d_min {worst['cost']:.4f} m"),
        legend(INK, 2, f"Criterion: {limit(threshold)} m to the centre", "5 4"),
    ]
    opening, body = drawn.split(">", 1)
    opening = opening.replace("<svg ", f'<svg xmlns="http://www.w3.org/2000/svg" style="{FONT}" ', 1)
    ground = f'<title>{campaign["name"]}: {values}</title><rect width="100%" height="100%" fill="#fff"/>'
    picture = body.removesuffix("</svg>") + "".join(lines) + "</svg>\n"
    target.write_text(f"{opening}>{ground}{picture}", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
