"""`make library-flights`: simulates the nominal case of every shipped campaign for the cards of the launch page.

The flights are stored in the repository, so that no page waits for a simulation and no service compiles for a picture.
They are simulated by the closed loop itself in its plain form: without a compiler, and alike on every machine. A test
simulates them again and compares; it also fails when a campaign or the code of its loop has changed since.
"""

from __future__ import annotations

from worker.running.runs import identity

# isort: split
import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from campaigns import Campaign, library, load_file, thin
from campaigns.results.drawn import FILE, DrawnClosest, DrawnFlight, DrawnTrack
from campaigns.results.trace import Closest
from worker.engine.kernels.bind import rebuilt
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.trace import trace
from worker.running.opening import opened

ROWS = 96
"""Rows of a stored flight: a card is 300 pixels wide."""

DIGITS = 4
"""Coordinates are rounded to about 1e-4 of the flight's extent, less than a tenth of a pixel."""

LOOP = "worker.engine.systems.closed_loop"
PARTS = ("worker.engine.components.", "worker.engine.physics.", "worker.engine.kernels.", f"{LOOP}.")
"""The code that a flight may depend on, as far as its loop imports it."""


def main() -> None:
    """Write the file again."""
    made = {}
    for name, path in library().items():
        made[name] = drawn(load_file(path))
        print(f"{name}: {made[name].status} {made[name].reason}".rstrip(), flush=True)
    before = FILE.read_text(encoding="utf-8") if FILE.exists() else ""
    text = written(made)
    FILE.write_text(text, encoding="utf-8")
    print(f"{len(made)} flights, {'unchanged' if text == before else 'changed'}")


def written(flights: Mapping[str, DrawnFlight]) -> str:
    """The file's text: one line for each flight, so that a change shows which."""
    lines = [f"{json.dumps(name)}: {json.dumps(flight.model_dump(mode='json'))}" for name, flight in flights.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def drawn(campaign: Campaign) -> DrawnFlight:
    """The nominal flight of a campaign, simulated now."""
    flights = opened.flights(campaign, compiled=False, lanes=1)
    flown = trace(flights, "nominal", {})
    head, columns = flown.meta, {column.name: flown.data[:, k] for k, column in enumerate(flown.columns)}
    rows = np.union1d(thin.even(len(flown.data), ROWS), [head.closest.row] if head.closest else [0])
    moving = [i for i, obstacle in enumerate(head.obstacles) if obstacle.moving]
    names = ["x", "y", *(f"obstacle.{i}.{axis}" for i in moving for axis in "xy")]
    decimals = _decimals([columns[name] for name in names])

    def kept(name: str) -> list[float]:
        return [round(float(value), decimals) + 0.0 for value in columns[name][rows]]

    return DrawnFlight(
        digest=campaign.digest,
        code=code_of(flights),
        status=head.status,
        reason=head.reason,
        value=_significant(head.values[flights.results[0].name]),
        frame=head.frame,
        x=kept("x"),
        y=kept("y"),
        tracks=[DrawnTrack(obstacle=i, x=kept(f"obstacle.{i}.x"), y=kept(f"obstacle.{i}.y")) for i in moving],
        closest=head.closest and _closest(head.closest, decimals),
    )


def _decimals(columns: Iterable[Floats]) -> int:
    extent = max([0.0, *(float(np.ptp(column)) for column in columns if len(column))])
    return DIGITS - math.ceil(math.log10(extent)) if extent > 0.0 else DIGITS


def _significant(value: float | None) -> float | None:
    """To nine digits: the last ones of the plain form differ from those of the compiled one."""
    return None if value is None else float(f"{value:.9g}")


def _closest(closest: Closest, decimals: int) -> DrawnClosest:
    at = [round(c, decimals) + 0.0 for c in (*closest.position[:2], *closest.obstacle_position[:2])]
    time = round(closest.time, 4)
    return DrawnClosest(time=time, x=at[0], y=at[1], obstacle=closest.obstacle, obstacle_x=at[2], obstacle_y=at[3])


def code_of(flights: Flights) -> str:
    """Identifies the code of a closed loop, without documentation: its components and everything that they import."""
    reached: set[str] = set()

    def note(kernel: Any) -> Any:
        reached.add(kernel.__module__)
        return kernel

    rebuilt(flights.loop.filled_template(), {}, note)
    known = identity.loaded()
    wanted = [name for name in known if name in reached or name.startswith(f"{LOOP}.")]
    modules = sorted(name for name in identity.closure(frozenset(wanted)).modules if name.startswith(PARTS))
    whole = "".join(f"{name}:{known[name].digest};" for name in modules)
    return hashlib.sha256(whole.encode()).hexdigest()[:16]


if __name__ == "__main__":
    main()
