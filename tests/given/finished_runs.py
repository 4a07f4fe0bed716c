"""A finished run with stored flights, written in the way of a worker."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from backend.db.queue import Queue
from backend.db.store import RunStore
from campaigns.results.finding import FoundBy
from campaigns.stored.records import Columns, StagePlan, Trace
from tests import results
from tests.given.service import Service

COLUMNS = [
    ("t", "s", "time"),
    *((name, "m", "pose") for name in ("x", "y", "z")),
    *((name, "rad", "pose") for name in ("roll", "pitch", "yaw")),
    ("v", "m/s", "state"),
    ("force", "N", "command"),
    ("separation", "m", "separation"),
]
PLAN = [StagePlan("nominal", None, 1), StagePlan("sensitivity", None, 42), StagePlan("search", "direct", 1000)]


def flight(name: str, rows: int = 3001, passing: float = 0.9) -> Trace:
    """A straight flight past the obstacle at (4, 4); the last separation is not a number."""
    t = np.linspace(0.0, 15.0, rows)
    x, y = 6 * t / 15, 4 + passing + 0 * t
    distance = np.hypot(x - 4, y - 4)
    distance[-1] = np.nan
    zero = 0 * t
    row = int(np.nanargmin(distance))
    closest = {"time": t[row], "value": distance[row], "position": [x[row], y[row], 0.0], "speed": 0.4}
    closest |= {"obstacle": 0, "obstacle_position": [4.0, 4.0, 0.0], "row": row}
    meta = {"frame": "enu", "closest": closest, "status": "ok", "reason": "", "cost": distance[row], "threshold": 0.5}
    meta |= {"obstacles": [{"title": "Circle", "position": [4.0, 4.0, 0.0], "radius": 0.5, "free_radius": 0.5}]}
    meta |= {"values": {"separation": distance[row], "goal_miss": 1.5 - passing}}
    speed, force = 0.4 + 0.05 * np.sin(t), 0.25 * np.cos(t) * passing
    data = np.column_stack([t, x, y, zero, zero, zero, zero, speed, force, distance])
    return Trace(name, results.columns(*COLUMNS), data, results.head(**meta))


def encounter(name: str, frame: str, intruder: Any, rows: int = 401, parameters: Any = None) -> Trace:
    """A flight of 20 s with an intruder at `intruder(t)` (m, 3); where z is down it climbs at 2 m/s, rolled, pitched.

    The vehicle is at (20 t, 5, -2 t), or at z = 0 where z is up.
    """
    t = np.linspace(0.0, 20.0, rows)
    aloft = 1.0 if frame == "ned" else 0.0
    one, zero = 1 + 0 * t, 0 * t
    own = np.column_stack([20 * t, 5 * one, -2 * t * aloft])
    turned = np.column_stack([0.3 * one * aloft, 0.1 * one * aloft, zero])
    other = np.asarray(intruder(t))
    distance = np.linalg.norm(own - other, axis=1)
    row = int(distance.argmin())
    closest = {"time": t[row], "row": row, "value": distance[row], "obstacle": 0}
    closest |= {"position": own[row].tolist(), "obstacle_position": other[row].tolist()}
    meta = {"frame": frame, "closest": closest, "status": "ok", "reason": "", "cost": distance[row]}
    meta |= {"parameters": parameters or {}}
    pose = [(n, "m", "pose") for n in "xyz"] + [(n, "rad", "pose") for n in ("roll", "pitch", "yaw")]
    way = [(f"obstacle.0.{n}", "m", "pose") for n in "xyz"]
    columns = [("t", "s", "time"), *pose, *way, ("separation", "m", "separation")]
    data = np.column_stack([t, own, turned, other, distance])
    return Trace(name, results.columns(*columns), data, results.head(**meta))


def straight(x: float, y: float, z: float, *speed: float) -> Any:
    """The path of an intruder at constant velocity."""
    return lambda t: np.array([x, y, z]) + t[:, None] * np.array(speed)


def turned(wxyz: Any, vector: Any) -> Any:
    """A vector turned by a unit quaternion."""
    w, axis = wxyz[0], wxyz[1:]
    return vector + 2 * np.cross(axis, np.cross(axis, vector) + w * vector)


def search(first: int, count: int, criteria: int = 1) -> Columns:
    """Evaluations of two parameters whose cost falls slowly, every tenth of them failed.

    A second criterion's cost, lower when worse as all are, rises with the first parameter.
    """
    index = first + np.arange(count)
    points = np.column_stack([(0.37 * index) % 1.0, (0.61 * index) % 1.0])
    failed = index % 10 == 9
    costs = np.where(failed, np.nan, 1.0 + 1.0 / (1 + index // 7) + 1.0 * (index % 7 > 0))
    reasons = {int(i): f"the speed exceeds 1000 m/s at {i} s" for i in index[failed]}
    every = np.column_stack([costs, np.where(failed, np.nan, points[:, 0] - 2.0)])[:, :criteria]
    return Columns(points, every, failed.astype(np.uint8), 0.001 * (1 + index), reasons)


class Work:
    """A worker's hold on the next run in the queue, to be carried on step by step."""

    def __init__(self, service: Service, plan: Sequence[StagePlan] = PLAN, simulators: Sequence[str] = ()) -> None:
        claim = Queue(service.engine).claim("w1", simulators)
        assert claim is not None
        self.store = RunStore(service.engine, claim)
        self.store.plan(plan)

    def nominal(self, flown: Trace | None = None) -> None:
        self.store.begin(0)
        self.store.finish(0, results.nominal(), 0.01, traces=[flown or flight("nominal")])

    def search(self, first: int, count: int, stage: int = 2) -> None:
        self.store.begin(stage)
        self.store.append(stage, first, search(first, count))

    def found(
        self,
        labels: tuple[str, ...] = ("F1",),
        flown: Trace | None = None,
        by: tuple[FoundBy, ...] = (),
        validated: bool = False,
    ) -> None:
        parameters: dict[str, float] = {"vehicle.m": 6.0, "vehicle.J": float(np.nextafter(0.06, 0))}
        findings = [
            results.finding(label, 0.1 + 0.2, 0.3 - 0.5, parameters, by, at_bounds={"vehicle.m": "high"})
            for label in labels
        ]
        if not validated:
            findings = [finding.model_copy(update={"validation": None}) for finding in findings]
        traces = [flown] if flown else [flight(label, passing=0.8) for label in labels]
        self.store.finish(2, results.searched(), 1.0, findings=findings, traces=traces)

    def conclude(self) -> None:
        self.store.conclude(results.verdict("violated", "A violation.", 0.9, 0.3))


def finish(service: Service) -> None:
    """Work off the next run in the queue."""
    work = Work(service)
    work.nominal()
    work.search(0, 700)
    work.search(700, 300)
    work.found()
    work.conclude()
