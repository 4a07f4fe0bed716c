"""Case 1, pinned: a change here means that the model, the loop or a method changed, and must be explained.

Tolerances leave room for another processor's fused operations, nothing more.
"""

from __future__ import annotations

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.limits import OTHERS
from campaigns.results import SearchResult, ValidateResult
from clearance.testing.problems import Problem
from tests.audited import audited
from worker.engine.systems.closed_loop.trace import trace
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

CASE = load_file(library()["unicycle_static"])


def test_the_trajectory_is_the_stored_one() -> None:
    # Nominal flight at t = 1, 3, 5, 10, 15 s: it swings left of the obstacle at (4, 4) and settles on the goal (6, 7).
    flown = trace(Problem(CASE).system, "nominal", {})
    names = [c.name for c in flown.columns]
    rows = flown.data[[200, 600, 1000, 2000, 3000]][:, [names.index(n) for n in ("x", "y", "yaw", "v", "separation")]]
    assert rows == pytest.approx(
        np.array(PINNED),
        abs=1e-9,
    )


PINNED = [
    [0.732544962815, 0.666827626495, 0.861684450979, 1.702492412686, 4.667579725246],
    [3.090156018502, 3.549495492731, 1.153223646145, 1.468351682292, 1.015268625408],
    [3.66267140734, 5.544872760512, 0.709834828374, 1.022989271376, 1.581272407145],
    [5.765745345531, 6.865748169165, 0.521283432949, 0.143107179135, 3.36606137709],
    [5.988493128937, 6.993445351185, 0.518657656437, 0.009603092918, 3.593719520825],
]


def test_the_closest_approach_is_the_stored_one() -> None:
    closest = trace(Problem(CASE).system, "nominal", {}).meta.closest
    assert closest is not None
    assert closest.time == pytest.approx(3.12361551, abs=1e-6)
    assert closest.value == pytest.approx(0.9435644009164, abs=1e-11)


def test_the_searches_of_a_whole_run_give_the_stored_results() -> None:
    """The sample is smaller than that of the library, whose verdict is tested by night, as is what it is based on."""
    # DIRECT's 100 iterations end 4e-3 kg short of the corner, SQP from both published starts ends on it; Monte Carlo
    # with this seed comes within 2e-5 m. The corner is the worst case because d_min falls with both parameters.
    document, store = CASE.document(), MemoryStore()
    document["stages"]["certify"] = {"samples": 60}
    case = load_document(document)
    conclusion = execute(case, store, threads=1)
    audited(store, case)
    results = [r.result for r in store.stages]
    found = {r.method: r.best for r in results if isinstance(r, SearchResult) and r.best is not None}
    assert conclusion.verdict == "cleared"
    assert found["direct"].cost == pytest.approx(0.94174626738275, abs=1e-10)
    assert found["direct"].parameters["vehicle.m"] == pytest.approx(5.995884773662551, abs=1e-12)
    assert found["sqp"].cost == pytest.approx(0.94174051663972, abs=1e-10)
    assert found["sqp"].parameters == {"vehicle.m": 6.0, "vehicle.J": 0.06}
    assert found["monte_carlo"].cost == pytest.approx(0.94175796517680, abs=1e-10)
    assert isinstance(results[3], SearchResult)
    assert [m.parameters for m in results[3].minima] == [{"vehicle.m": 6.0, "vehicle.J": 0.06}] * 2
    beyond = next(r.encounter.beyond for r in results if isinstance(r, ValidateResult) and r.encounter)
    assert beyond is not None
    assert beyond.flights == 1 + len(store.findings) + 60 + OTHERS
    assert beyond.not_continued > 0
