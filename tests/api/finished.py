"""A run with a flight or two, written as a worker writes it. Start reading at `finish`."""

from __future__ import annotations

from typing import Any

import numpy as np

from backend.db.queue import Queue
from backend.db.records import Columns, Conclusion, Finding, StagePlan, Trace
from backend.db.store import RunStore
from tests.api.server import Service

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
    closest = {"time": t[row], "value": distance[row], "position": [x[row], y[row], 0.0]}
    closest |= {"obstacle": 0, "obstacle_position": [4.0, 4.0, 0.0], "row": row}
    meta = {"frame": "enu", "closest": closest, "status": "ok", "reason": "", "cost": distance[row], "threshold": 0.5}
    described = [{"name": n, "symbol": n, "unit": u, "group": g} for n, u, g in COLUMNS]
    return Trace(name, described, np.column_stack([t, x, y, zero, zero, zero, zero, zero, zero, distance]), meta)


def search(first: int, count: int) -> Columns:
    """Evaluations of two parameters whose cost falls slowly, every tenth of them failed."""
    index = first + np.arange(count)
    points = np.column_stack([(0.37 * index) % 1.0, (0.61 * index) % 1.0])
    failed = index % 10 == 9
    costs = np.where(failed, np.nan, 1.0 + 1.0 / (1 + index // 7) + 1.0 * (index % 7 > 0))
    reasons = {int(i): f"the speed exceeds 1000 m/s at {i} s" for i in index[failed]}
    return Columns(points, costs[:, None], failed.astype(np.uint8), 0.001 * (1 + index), reasons)


class Work:
    """A worker's hold on the next run in the queue, to be carried on step by step."""

    def __init__(self, service: Service) -> None:
        claim = Queue(service.engine).claim("w1")
        assert claim is not None
        self.store = RunStore(service.engine, claim)
        self.store.plan(PLAN)

    def nominal(self) -> None:
        self.store.begin(0)
        self.store.finish(0, {"cost": 0.9, "margin": 0.4}, 0.01, traces=[flight("nominal")])

    def search(self, first: int, count: int) -> None:
        self.store.begin(2)
        self.store.append(2, first, search(first, count))

    def found(self, labels: tuple[str, ...] = ("F1",)) -> None:
        parameters: dict[str, float] = {"vehicle.m": 6.0, "vehicle.J": float(np.nextafter(0.06, 0))}
        findings = [
            Finding(
                label, 0.1 + 0.2, 0.3 - 0.5, parameters, [1.0, 1.0], ["direct"], {"vehicle.m": "high"}, {"ok": True}
            )
            for label in labels
        ]
        traces = [flight(label, passing=0.8) for label in labels]
        self.store.finish(2, {"method": "direct"}, 1.0, findings=findings, traces=traces)

    def conclude(self) -> None:
        summary: dict[str, Any] = {"quantity": "d_min", "unit": "m"}
        self.store.conclude(Conclusion("violated", "A violation.", 0.9, 0.3, "direct", summary))


def finish(service: Service) -> None:
    """Work off the next run in the queue."""
    work = Work(service)
    work.nominal()
    work.search(0, 700)
    work.search(700, 300)
    work.found()
    work.conclude()
