"""A run with excluded and failed evaluations: its intruder may start inside the safety radius, its robot may spin."""

from __future__ import annotations

from typing import Any, NamedTuple

import httpx
import numpy as np

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.results.base import OK
from campaigns.results.search import Best
from campaigns.stored.records import Columns
from clearance.testing.problems import Problem
from tests import results
from tests.given.finished_runs import Work
from tests.given.service import Service
from tests.given.small_catalogue import published_by_workers

UNCERTAIN = {
    "obstacles.0.position.x": {"low": 0.1, "high": 4.1},
    "obstacles.0.position.y": {"low": 0.1, "high": 4.1},
    "vehicle.J": {"low": 0.004, "high": 0.06},
}
INSIDE = np.array([[0.01 * i, 0.02, 0.9] for i in range(1, 5)])
"""The obstacle is within 0.5 m of the start."""
SPINNING = np.array([[0.8, 0.1 * i, 0.0] for i in range(1, 8)])
"""So little inertia that the loop does not hold: the turn rate leaves the model's envelope."""
FLYING = np.array([[0.3 + 0.06 * i, 0.9 - 0.05 * i, 0.8] for i in range(10)])


class Lost(NamedTuple):
    """The run, its evaluations in the order `INSIDE`, `SPINNING`, `FLYING`, and why those without a value have none."""

    run: str
    points: Any
    costs: Any
    reasons: dict[int, str]


def lose(service: Service, client: httpx.Client, publish: bool = True) -> Lost:
    """A finished run with a simulated search: 4 evaluations excluded, 7 failed, 10 with a value."""
    if publish:
        service.publish(published_by_workers())
    document: dict[str, Any] = load_file(library()["unicycle_static"]).document()
    document["uncertain"] = UNCERTAIN
    document["stages"]["search"] = [{"method": "direct", "evaluations": 1000}]
    answer = client.post("/api/v1/runs", json={"campaign": document, "name": "Lost flights"})
    assert answer.status_code == 201, answer.text
    points = np.concatenate([INSIDE, SPINNING, FLYING])
    batch, reasons = Problem(load_document(document)).evaluate(points)
    assert np.isfinite(batch.costs[batch.status == OK]).all()
    work = Work(service)
    work.nominal()
    work.store.begin(2)
    seconds = 0.001 * np.arange(1, len(points) + 1)
    work.store.append(2, 0, Columns(points, batch.costs, batch.status, seconds, reasons))
    row = int(np.nanargmin(batch.costs[:, 0]))
    lowest = float(batch.costs[row, 0])
    best = Best(cost=lowest, margin=lowest - 0.5, parameters=values(points[row]), index=row)
    counts = {"evaluations": len(points), "failed": len(SPINNING), "excluded": len(INSIDE)}
    work.store.finish(2, results.searched().model_copy(update=counts | {"best": best}), 1.0)
    work.conclude()
    return Lost(answer.json()["id"], points, batch.costs[:, 0], reasons)


def values(point: Any) -> dict[str, float]:
    """A point of the unit cube as parameters by path."""
    return {
        path: b["low"] + float(u) * (b["high"] - b["low"])
        for (path, b), u in zip(UNCERTAIN.items(), point, strict=True)
    }
