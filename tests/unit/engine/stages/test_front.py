"""The Pareto front of several criteria: dominance, equal rows, and its form in a stage's result and file."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from campaigns.asked.load import load_document
from campaigns.results import SearchResult
from campaigns.results.base import FAILED, OK
from campaigns.stored.records import Columns
from clearance.local.results import write_results
from clearance.testing.problems import Problem
from tests.audited import audited
from tests.given.case_campaigns import CASE1, campaign
from worker.engine.stages.parts import front
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

TABLES = arrays(np.float64, st.tuples(st.integers(0, 30), st.integers(1, 4)), elements=st.integers(0, 5).map(float))


@settings(max_examples=40)
@given(TABLES)
def test_it_agrees_with_the_definition(costs: Any) -> None:
    found = front.undominated(costs)
    kept = costs[found]
    for i, row in enumerate(costs):
        bettered = ((costs <= row).all(axis=1) & (costs < row).any(axis=1)).any()
        assert (kept == row).all(axis=1).any() != bettered
        assert (i in found) == (not bettered and not (costs[:i] == row).all(axis=1).any())
    assert (np.diff(kept[:, 0]) >= 0).all()


def several(*objectives: str) -> Problem:
    document = campaign().document()
    document["objectives"] = [{"component": name} for name in objectives]
    return Problem(load_document(document))


def columns(costs: list[list[float]], status: list[int]) -> Columns:
    m = len(costs)
    points = np.column_stack([np.linspace(0, 1, m), np.linspace(1, 0, m)])
    return Columns(points, np.array(costs), np.array(status, dtype=np.uint8), np.arange(m, dtype=float), {})


def test_one_criterion_has_no_front() -> None:
    assert front.of_stage(several(), columns([[1.0]], [OK])) == (None, None)
    assert [c.name for c in front.criteria(several())] == ["separation"]


def test_values_have_their_own_sign_and_failures_are_omitted() -> None:
    problem = several("goal_miss")
    nan = float("nan")
    made = columns([[1.0, -3.0], [2.0, -4.0], [2.0, -3.0], [nan, nan], [0.5, 0.0]], [OK, OK, OK, FAILED, OK])
    points, size = front.of_stage(problem, made)
    assert points is not None
    assert size == 3
    assert [p.index for p in points] == [4, 0, 1]
    assert [p.values for p in points] == [
        {"separation": 0.5, "goal_miss": 0.0},
        {"separation": 1.0, "goal_miss": 3.0},
        {"separation": 2.0, "goal_miss": 4.0},
    ]
    assert str(points[0].values["goal_miss"]) == "0.0", "no negative zero"
    assert points[1].parameters == problem.named(made.points[0])
    assert [(c.unit, c.worse) for c in front.criteria(problem)] == [("m", "low"), ("m", "high")]


def test_without_a_completed_evaluation_the_front_is_empty() -> None:
    problem = several("goal_miss")
    assert front.of_stage(problem, None)[0] is None
    assert front.of_stage(problem, columns([[float("nan")] * 2], [FAILED]))[0] == []


def test_the_same_component_twice_has_two_names() -> None:
    document = campaign().document()
    radii = [{"component": "time_to_goal", "parameters": {"radius": r}} for r in (0.5, 1.0, 2.0)]
    document["objectives"] = radii
    names = [c.name for c in front.criteria(Problem(load_document(document)))]
    assert names == ["separation", "time_to_goal", "time_to_goal#2", "time_to_goal#3"]


@pytest.mark.nightly
def test_a_large_front_is_thinned_and_states_its_full_size() -> None:
    m = 3 * front.MOST
    line = np.linspace(1.0, 2.0, m)
    points, size = front.of_stage(several("goal_miss"), columns(np.column_stack([line, -line]).tolist(), [OK] * m))
    assert points is not None
    assert size == m
    assert len(points) == front.MOST
    assert [points[k].index for k in (0, -1)] == [0, m - 1]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("method", ["nsga2", "monte_carlo"])
def test_a_run_stores_it_and_the_file_has_every_criterion(method: str, tmp_path: Path) -> None:
    problem = campaign(
        stages={
            "sensitivity": {"points": 3},
            "search": [{"method": method, "evaluations": 120}],
            "validate": {"neighbours": 5, "evaluations": 20_000},
        },
        objectives=[
            {"component": "goal_miss"},
            {"component": "time_to_goal", "parameters": {"radius": 0.5}},
            {"component": "peak_command"},  # the loop is one that tests/physics/test_criteria.py compiles
        ],
        scenario=CASE1["scenario"] | {"horizon": 8.0},
    )
    store = MemoryStore()
    execute(problem, store, threads=1)
    audited(store, problem)
    result = next(s.result for s in store.stages if s.plan.method == method)
    assert isinstance(result, SearchResult)
    assert result.front is not None
    assert result.front_size == len(result.front) > 1
    write_results(tmp_path, problem, store, {})
    rows = list(csv.DictReader((tmp_path / "evaluations.csv").read_text(encoding="utf-8").splitlines()))
    assert {"cost", "goal_miss [m]", "time_to_goal [s]"} <= rows[0].keys()
    flown = {int(r["index"]): r for r in rows if r["method"] == method}
    assert len(flown) == 120
    for point in result.front:
        row = flown[point.index]
        assert float(row["cost"]) == point.values["separation"]
        assert float(row["goal_miss [m]"]) == point.values["goal_miss"] >= 0.0
        assert float(row["time_to_goal [s]"]) == point.values["time_to_goal"]
        assert float(row["vehicle.m"]) == point.parameters["vehicle.m"]
