"""The flight that shows a case: time, pose, states, commands, separation as columns, and the closest approach.

States come from the compiled loop itself, so a trace shows the very flight whose cost was counted.
Start reading at `trace`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from worker.problem import Floats, Problem
from worker.search.base import FAILED, STATUS
from worker.store import Trace

POSE = 6


def trace(problem: Problem, name: str, values: Mapping[str, float], rows: int | None = None) -> Trace:
    """Fly one case and return its trace, thinned to about `rows` rows around the closest approach where given.

    values: parameters by path; what is left out is nominal. Raises KeyError for an unknown path.
    """
    vector = problem.vector(values)
    flown = problem.loop.fly(vector[None, :], problem.step, *problem.counts(problem.step), traced=1)
    status, reasons = problem.judge(flown.status, flown.when)
    states = flown.trace[0]
    flying = np.isfinite(states).all(axis=1)
    states = states[: int(np.argmin(flying)) if not flying.all() else len(states)]
    if status[0] == FAILED:  # the loop looks up only now and then; what follows the failure means nothing
        states = states[: round(float(flown.when[0]) / problem.step) + 1]
    signals = problem.loop.signals
    channels = len(signals) - problem.loop.n_channels
    seen = problem.loop.observe(states, vector, problem.step)
    closest = _closest(problem, seen[:, channels:], seen, vector)
    kept = _kept(len(states), rows, closest)
    data = np.column_stack(
        (
            kept * problem.step,
            seen[kept, :POSE],
            states[kept][:, _further(problem)],
            seen[kept, POSE:channels],
            _separation(problem, seen[kept, channels:], vector),
        )
    )
    meta = _meta(problem, vector, values) | {
        "closest": closest,
        "status": STATUS[int(status[0])],
        "reason": reasons.get(0, ""),
        "cost": None if np.isnan(flown.costs[0]) else float(flown.costs[0]),
    }
    return Trace(name, _columns(problem), data, meta)


def _further(problem: Problem) -> list[int]:
    """The vehicle's states that the pose does not show already."""
    shown = {"x", "y", "z", "roll", "pitch", "yaw", "theta"} if problem.parts.vehicle.dimension == 2 else set()
    return [k for k, s in enumerate(problem.parts.vehicle.states) if s.name not in shown]


def _columns(problem: Problem) -> list[dict[str, str]]:
    vehicle, signals = problem.parts.vehicle, problem.loop.signals
    criterion = problem.parts.criterion

    def column(name: str, symbol: str, unit: str, group: str) -> dict[str, str]:
        return {"name": name, "symbol": symbol, "unit": unit, "group": group}

    commands = signals[POSE : len(signals) - problem.loop.n_channels]
    return [
        column("t", "t", "s", "time"),
        *(column(s.name, s.symbol, s.unit, "pose") for s in signals[:POSE]),
        *(column(s.name, s.symbol, s.unit, "state") for s in (vehicle.states[k] for k in _further(problem))),
        *(column(s.name, s.symbol, s.unit, "command") for s in commands),
        column("separation", "d", criterion.unit, "separation"),
    ]


def _separation(problem: Problem, channels: Floats, vector: Floats) -> Floats:
    """The criterion's value at every row (m,)."""
    cost, p = problem.loop.part("cost"), problem.loop.extend(vector)
    return np.array([cost(tuple(map(float, row)), p) for row in channels])


def _closest(problem: Problem, channels: Floats, seen: Floats, vector: Floats) -> dict[str, Any] | None:
    """When, where and to which obstacle the flight came closest, refined by the parabola as the cost is."""
    if len(channels) == 0 or not np.isfinite(channels).all():
        return None
    row, obstacle = (int(i) for i in np.unravel_index(np.argmin(channels), channels.shape))
    lowest, shift = float(channels[row, obstacle]), 0.0
    position = seen[row, :3]
    if 0 < row < len(channels) - 1:
        left, mid, right = (float(c) for c in channels[row - 1 : row + 2, obstacle])
        bend = left - 2 * mid + right
        if bend > 0:
            shift = 0.5 * (left - right) / bend
            lowest = mid - 0.125 * (left - right) ** 2 / bend
            back, ahead = seen[row - 1, :3], seen[row + 1, :3]
            position = position + 0.5 * shift * (ahead - back) + 0.5 * shift**2 * (back - 2 * position + ahead)
    time = (row + shift) * problem.step
    cost = problem.loop.part("cost")
    return {
        "time": time,
        "row": row,
        "value": float(cost((lowest,) * channels.shape[1], problem.loop.extend(vector))),
        "position": [float(c) for c in position],
        "obstacle": obstacle,
        "obstacle_position": _bodies(problem, vector, time)[obstacle]["position"],
    }


def _kept(count: int, rows: int | None, closest: Mapping[str, Any] | None) -> Any:
    if rows is None or count <= rows:
        return np.arange(count)
    even = np.linspace(0, count - 1, max(rows - 21, 2)).round().astype(int)
    around = np.arange(-10, 11) + (closest["row"] if closest else 0)
    return np.unique(np.concatenate([even, around[(around >= 0) & (around < count)]]))


def _bodies(problem: Problem, vector: Floats, time: float) -> list[dict[str, Any]]:
    found = problem.loop.part("bodies")(time, problem.loop.extend(vector))
    return [
        {
            "component": obstacle.name,
            "title": obstacle.title,
            "position": [float(body.x), float(body.y), float(getattr(body, "z", 0.0))],
            "radius": float(body.radius),
        }
        for obstacle, body in zip(problem.parts.obstacles, found, strict=True)
    ]


def _meta(problem: Problem, vector: Floats, values: Mapping[str, float]) -> dict[str, Any]:
    def place(prefix: str) -> list[float]:
        return [
            float(vector[problem.paths[f"{prefix}.{a}"]]) if f"{prefix}.{a}" in problem.paths else 0.0 for a in "xyz"
        ]

    return {
        "frame": "enu",
        "vehicle": problem.parts.vehicle.name,
        "obstacles": _bodies(problem, vector, 0.0),
        "start": place("start"),
        "goal": place("goal"),
        "threshold": problem.threshold,
        "parameters": {r.path: float(vector[r.index]) for r in problem.ranges} | dict(values),
    }
