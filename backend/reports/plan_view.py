"""Plan view of the flights: nominal and worst case, obstacles, safety radius at the closest approach.

East is right and north is up, for any world axes of the vehicle.
"""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from backend.reports import plot
from backend.reports.figures import WIDE, Case, Quantity
from backend.reports.plot import Axes, Point
from campaigns.claims import numbers
from campaigns.results import TraceHead
from campaigns.results.trace import TraceObstacle

HEIGHT = 300
HUES = {plot.NOMINAL: "grey", plot.WORST: "vermillion", "#7b5ba6": "violet", "#0072b2": "blue", "#857c00": "olive"}
REACH = 4.0
"""The encounter is the part in which the separation is below this multiple of the larger of criterion and minimum."""


def plan_view(cases: Sequence[Case], of: Quantity) -> Markup | None:
    """The flights around the encounter at one scale; None if no flight has a position."""
    axis = ("y", "x") if cases and cases[0].head.frame == "ned" else ("x", "y")
    tracks = [_encounter(case, case.points(*axis), of) for case in cases]
    places = [p for track in tracks for p in track]
    if len(places) < 2:
        return None
    reach = of.threshold or 0.0
    for case in cases[-1:]:
        reach = max((_free(obstacle) for obstacle in _shown(case)), default=reach)
        places += [
            (x + dx, y + dy) for x, y in _centres(case, axis) for dx in (-reach, reach) for dy in (-reach, reach)
        ]
    view = cases[-1].view
    if view is not None:
        places += [point for _, outline in view.outlines for point in outline]
        moving = [i for i, obstacle in enumerate(cases[-1].head.obstacles) if obstacle.moving]
        places += [point for i in moving for point in cases[-1].points(f"obstacle.{i}.x", f"obstacle.{i}.y")]
    axes = _scaled(places)
    axes.frame(view.across if view else f"East ({axis[0]}), m", 8)
    _grid(axes)
    _obstacles(axes, cases[-1], axis)
    _outlines(axes, cases[-1])
    for case, track in zip(cases, tracks, strict=True):
        axes.line(track, case.colour, 1.8, case.dash)
    for case in cases:
        _approach(axes, case, axis)
    _landmarks(axes, cases[0].head, axis)
    if view is not None:
        return axes.svg(f"Nominal and worst case seen {view.seen}, as the simulator declares them")
    return axes.svg("Flights seen from above, with the obstacles at the closest approach of the worst flight")


def up(cases: Sequence[Case]) -> str:
    """What the drawing shows upwards."""
    view = cases[-1].view if cases else None
    return "North, m" if view is None else view.up


def _at(position: Sequence[float], axis: tuple[str, str]) -> Point:
    return (position[0], position[1]) if axis[0] == "x" else (position[1], position[0])


def _encounter(case: Case, track: list[Point], of: Quantity) -> list[Point]:
    """The track during the encounter, and shortly before and after it."""
    values = case.data.get("separation", [])
    known = [v for v in values if v is not None]
    if len(track) != len(values) or not known:
        return track
    far = REACH * max(of.threshold or 0.0, min(known))
    near = [i for i, v in enumerate(values) if v is not None and v <= far]
    if len(near) < 2:
        return track
    pad = (near[-1] - near[0]) // 8
    return track[max(0, near[0] - pad) : near[-1] + pad + 1]


def _centres(case: Case, axis: tuple[str, str]) -> list[Point]:
    """The centre of each obstacle: at the closest approach for the closest obstacle, at the start for the others."""
    closest = case.closest
    return [
        _at(closest.obstacle_position if closest is not None and i == closest.obstacle else obstacle.position, axis)
        for i, obstacle in _numbered(case)
    ]


def _scaled(places: Sequence[Point]) -> Axes:
    """Axes with the same scale in both directions, as large as the drawing allows."""
    (x0, x1), (y0, y1) = (plot.padded([p[k] for p in places], 0.05) for k in (0, 1))
    axes = Axes(WIDE, HEIGHT, (x0, x1), (y0, y1), left=48)
    across, up = axes.width - axes.left - axes.right, axes.height - axes.top - axes.bottom
    scale = max((x1 - x0) / across, (y1 - y0) / up)
    for name, low, high, size in (("x_range", x0, x1, across), ("y_range", y0, y1, up)):
        middle = (low + high) / 2
        setattr(axes, name, (middle - scale * size / 2, middle + scale * size / 2))
    return axes


def _grid(axes: Axes) -> None:
    for tick in plot.linear_ticks(*axes.x_range, 8):
        axes.rule(axes.x(tick), axes.top, axes.x(tick), axes.height - axes.bottom, plot.GRID)


def _obstacles(axes: Axes, case: Case, axis: tuple[str, str]) -> None:
    scale = abs(axes.x(1.0) - axes.x(0.0))
    for i, obstacle in enumerate(case.head.obstacles):
        if obstacle.moving:
            track = case.points(f"obstacle.{i}.{axis[0]}", f"obstacle.{i}.{axis[1]}")
            axes.line(track, plot.OBSTACLE, 1.3, "6 4")
            if case.view is not None and track:
                axes.text(axes.x(track[-1][0]), axes.y(track[-1][1]) - 6, obstacle.title, colour=plot.OBSTACLE)
    body = '<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}" fill="{}" fill-opacity="{}" stroke="{}" stroke-width="1"{}/>'
    dashed = Markup(' stroke-dasharray="5 4"')
    for (x, y), obstacle in zip(_centres(case, axis), _shown(case), strict=False):
        place = (axes.x(x), axes.y(y))
        radius = obstacle.radius * scale
        axes.add(body, *place, max(radius, 2.5), plot.OBSTACLE, 0.16, plot.OBSTACLE, Markup(""))
        free = _free(obstacle) * scale
        if free > 0:
            axes.add(body, *place, free, "none", 0, plot.INK, dashed)
        edge = max(radius, free)
        axes.text(
            place[0],
            min(place[1] + edge + 12, axes.height - axes.bottom - 4),
            obstacle.title,
            colour=plot.OBSTACLE,
        )


def _outlines(axes: Axes, case: Case) -> None:
    """What a simulator declares and is no circle."""
    for name, outline in case.view.outlines if case.view else ():
        axes.line(outline, plot.OBSTACLE, 1.3)
        low = max(axes.y(y) for _, y in outline)
        axes.text(axes.x(outline[0][0]), min(low + 12, axes.height - axes.bottom - 4), name, colour=plot.OBSTACLE)


def _free(obstacle: TraceObstacle) -> float:
    return obstacle.free_radius or 0.0


def _shown(case: Case) -> list[TraceObstacle]:
    return [obstacle for _, obstacle in _numbered(case)]


def _numbered(case: Case) -> list[tuple[int, TraceObstacle]]:
    """The obstacles that are drawn as bodies: static ones, and the closest one."""
    nearest = None if case.closest is None else case.closest.obstacle
    numbered = enumerate(case.head.obstacles)
    return [(i, o) for i, o in numbered if o.position and (not o.moving or i == nearest)]


def _approach(axes: Axes, case: Case, axis: tuple[str, str]) -> None:
    """Mark the closest approach, with a line to the obstacle's centre."""
    closest = case.closest
    if closest is None:
        return
    here, there = _at(closest.position, axis), _at(closest.obstacle_position, axis)
    axes.rule(axes.x(here[0]), axes.y(here[1]), axes.x(there[0]), axes.y(there[1]), case.colour, 1, "2 2")
    axes.dot(*here, case.colour)


def _landmarks(axes: Axes, head: TraceHead, axis: tuple[str, str]) -> None:
    for name, position in (("start", head.start), ("goal", head.goal)):
        if not position:
            continue
        x, y = _at(position, axis)
        if axes.x_range[0] <= x <= axes.x_range[1] and axes.y_range[0] <= y <= axes.y_range[1]:
            axes.dot(x, y, plot.INK3, 2.6)
            axes.text(axes.x(x) + 6, axes.y(y) - 5, name.capitalize(), "start")


def caption(cases: Sequence[Case], of: Quantity) -> str:
    drawn = "; ".join(f"{case.label}: {HUES.get(case.colour, 'dashed')}" for case in cases)
    view = cases[-1].view if cases else None
    if view is not None:
        moving = " Dashed: what else moves." if any(o.moving for o in cases[-1].head.obstacles) else ""
        return f"Seen {view.seen}, as the simulator declares; upwards: {view.up}. {drawn}.{moving}"
    limit = f" Dashed: the criterion of {numbers.exact(of.threshold)} {of.unit}." if of.threshold else ""
    return f"Flights seen from above. {drawn}.{limit} Moving obstacles are shown at the time of the closest approach."
