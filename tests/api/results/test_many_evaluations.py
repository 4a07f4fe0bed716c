"""Evaluations are read chunk by chunk: the same numbers as of the whole arrays, in the memory of a few chunks."""

from __future__ import annotations

import tracemalloc
from typing import Any

import httpx
import numpy as np
import pytest

from backend.db.engine import read
from backend.db.rows import stored_columns
from backend.results import evaluations
from campaigns import cube, thin
from campaigns.results.base import EXCLUDED, OK, STATUS, TIMEOUT
from campaigns.stages.found import declared
from campaigns.stored.records import Columns, StagePlan
from tests.given.finished_runs import Work
from tests.given.service import Service
from tests.given.submissions import submit

BOUNDS = {"vehicle.m": (5.0, 4.0, 6.0), "vehicle.J": (0.05, 0.04, 0.06)}
CHUNKS = (1, 700, 3, 1296, 1)
PLAN = [StagePlan("nominal", None, 1), *(StagePlan("search", method, 2001) for method in ("direct", "sqp"))]


def drawn(random: Any, first: int, count: int) -> Columns:
    """Evaluations with every status, and costs that seldom improve."""
    status = random.choice([OK, OK, OK, OK, 1, TIMEOUT, EXCLUDED], count).astype(np.uint8)
    costs = np.where(status == OK, 1.0 + random.random(count) ** 4 / (1 + first), np.nan)
    reasons = {first + int(i): f"reason {first + i}" for i in np.flatnonzero(status)}
    return Columns(random.random((count, 2)), costs[:, None], status, random.random(count), reasons)


def whole(columns: Columns, most: int) -> dict[str, Any]:
    """What is shown of a stage, from all of its evaluations at once."""
    costs = np.where(columns.status == OK, columns.costs[:, 0], np.nan)
    better = thin.improvements(costs)
    chosen = thin.with_kept(len(costs), most, better)
    last = len(costs) - 1
    steps = [*better.tolist(), *([] if better[-1] == last else [last])]
    best = np.fmin.accumulate(costs)
    return {
        "timeouts": int((columns.status == TIMEOUT).sum()),
        "index": chosen.tolist(),
        "seconds": columns.seconds[chosen].tolist(),
        "cost": [None if np.isnan(cost) else cost for cost in costs[chosen].tolist()],
        "status": [STATUS[code] for code in columns.status[chosen].tolist()],
        "parameters": {
            path: cube.natural(columns.points[chosen, k], *limits).tolist()
            for k, (path, limits) in enumerate(BOUNDS.items())
        },
        "improvements": {
            "index": steps,
            "seconds": columns.seconds[steps].tolist(),
            "cost": best[steps].tolist(),
        },
    }


def failures(position: int, columns: Columns) -> list[dict[str, Any]]:
    """All evaluations of a stage without a cost."""
    return [
        {
            "position": position,
            "index": i,
            "status": STATUS[columns.status[i]],
            "reason": f"reason {i}",
            "parameters": {
                path: float(cube.natural(columns.points[i, k], *limits))
                for k, (path, limits) in enumerate(BOUNDS.items())
            },
        }
        for i in np.flatnonzero(columns.status).tolist()
    ]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("most", [2, 50, 2000, 100_000])
def test_the_numbers_are_those_of_the_whole_arrays(service: Service, client: httpx.Client, most: int) -> None:
    run, random = submit(client), np.random.default_rng(4)
    work = Work(service, PLAN)
    for position, used in ((1, CHUNKS[:2]), (2, CHUNKS)):
        work.store.begin(position)
        for k, count in enumerate(used):
            work.store.append(position, sum(used[:k]), drawn(random, sum(used[:k]), count))
    answer = client.get(f"/api/v1/runs/{run}/evaluations", params={"max_points": most}).json()
    lost: list[dict[str, Any]] = []
    for shown in answer["stages"]:
        with read(service.engine) as reader:
            columns = stored_columns(reader, 1, shown["position"])
        assert columns is not None
        expected = whole(columns, most)
        assert {name: shown[name] for name in expected} == expected
        lost += failures(shown["position"], columns)
    assert [stage["total"] for stage in answer["stages"]] == [sum(CHUNKS[:2]), sum(CHUNKS)]
    failed_first = sorted(lost, key=lambda one: one["status"] == "excluded")[: evaluations.MOST_FAILURES]
    assert {one["status"] for one in lost} == {"failed", "timeout", "excluded"}
    assert answer["failures"] == sorted(failed_first, key=lambda one: (one["position"], one["index"]))


def test_no_more_than_a_few_chunks_are_in_memory(service: Service, client: httpx.Client) -> None:
    submit(client)
    work, random = Work(service, PLAN), np.random.default_rng(5)
    work.store.begin(1)
    count, total = 4096, 200_000
    for first in range(0, total, count):
        points = random.random((count, 2))
        work.store.append(1, first, Columns(points, 1.0 + points[:, :1], np.zeros(count, np.uint8), points[:, 0], {}))
    chunk = count * 8 * 5
    with read(service.engine) as reader:
        evaluations.read(reader, 1, 100, None)  # what is loaded or compiled once
        tracemalloc.start()
        evaluations.read(reader, 1, 100, None)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < 8 * chunk < 0.2 * total * chunk / count, peak


def test_a_stage_says_whether_its_lowest_value_counts_for_the_run(service: Service, client: httpx.Client) -> None:
    """As stored with the run: each stage in its turn evaluates less than all before it."""
    run, random = submit(client), np.random.default_rng(6)
    work = Work(service, [StagePlan(kind, "direct" if kind == "search" else None, 1) for kind in declared()])
    counts = {}
    for position, kind in enumerate(declared()):
        work.store.begin(position)
        cost = np.array([[10.0 - position]])
        work.store.append(position, 0, Columns(random.random((1, 2)), cost, np.zeros(1, np.uint8), np.ones(1), {}))
        counts[kind] = client.get(f"/api/v1/runs/{run}").json()["worst_cost"] == cost[0, 0]
    shown = client.get(f"/api/v1/runs/{run}").json()["stages"]
    assert {stage["kind"]: stage["own"] for stage in shown} == counts
    assert set(counts.values()) == {False, True}
