"""Evaluations, findings and traces: thinned for charts, with unchanged numbers."""

from __future__ import annotations

import httpx
import numpy as np
import pytest

from campaigns import thin
from campaigns.results.finding import FoundBy
from tests import results
from tests.given.finished_runs import Work, finish, flight, search
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit


@pytest.fixture(scope="module")
def run(still: Service, guest: httpx.Client) -> str:
    """A finished run, which the tests only read."""
    run = submit(guest)
    finish(still)
    return run


def test_thinning_of_evaluations_retains_every_improvement(guest: httpx.Client, run: str) -> None:
    answer = guest.get(f"/api/v1/runs/{run}/evaluations", params={"max_points": 400}).json()
    (stage,) = answer["stages"]
    flown = search(0, 1000)
    assert (stage["position"], stage["method"], stage["total"], stage["failed"]) == (2, "direct", 1000, 100)
    assert len(stage["index"]) <= 400
    better = thin.improvements(flown.costs[:, 0]).tolist()
    assert set(better) <= set(stage["index"])
    assert {0, 999} <= set(stage["index"])
    assert stage["index"] == sorted(set(stage["index"]))
    for column, expected in (("seconds", flown.seconds), ("cost", flown.costs[:, 0])):
        values = [None if np.isnan(v) else v for v in expected[stage["index"]].tolist()]
        assert stage[column] == values
    assert stage["status"] == ["failed" if i % 10 == 9 else "ok" for i in stage["index"]]


def test_parameters_are_in_units_at_full_precision(guest: httpx.Client, run: str) -> None:
    (stage,) = guest.get(f"/api/v1/runs/{run}/evaluations").json()["stages"]
    points = search(0, 1000).points[stage["index"]]
    assert list(stage["parameters"]) == ["vehicle.m", "vehicle.J"]
    assert stage["parameters"]["vehicle.m"] == (4.0 + (6.0 - 4.0) * points[:, 0]).tolist()
    assert stage["parameters"]["vehicle.J"] == (0.04 + (0.06 - 0.04) * points[:, 1]).tolist()


def test_improvements_end_at_the_last_evaluation(guest: httpx.Client, run: str) -> None:
    (stage,) = guest.get(f"/api/v1/runs/{run}/evaluations", params={"max_points": 2}).json()["stages"]
    steps, flown = stage["improvements"], search(0, 1000)
    better = thin.improvements(flown.costs[:, 0]).tolist()
    assert steps["index"] == [*better, 999]
    assert steps["cost"] == [*flown.costs[better, 0].tolist(), float(np.nanmin(flown.costs))]
    assert steps["seconds"] == flown.seconds[[*better, 999]].tolist()
    assert len(stage["index"]) == 2


def test_failures_state_their_reason(guest: httpx.Client, run: str) -> None:
    failures = guest.get(f"/api/v1/runs/{run}/evaluations").json()["failures"]
    assert len(failures) == 100
    assert (failures[0]["index"], failures[0]["status"]) == (9, "failed")
    assert failures[0]["reason"] == "the speed exceeds 1000 m/s at 9 s"
    assert set(failures[0]["parameters"]) == {"vehicle.m", "vehicle.J"}


def test_one_stage_can_be_asked_for(guest: httpx.Client, run: str) -> None:
    other = guest.get(f"/api/v1/runs/{run}/evaluations", params={"position": 1}).json()
    assert (other["stages"], other["failures"]) == ([], [])
    assert len(guest.get(f"/api/v1/runs/{run}/evaluations", params={"position": 2}).json()["stages"]) == 1


@pytest.mark.parametrize("query", [{"max_points": 1}, {"max_points": 10**7}, {"position": -1}, {"position": "x"}])
def test_a_bad_question_is_refused(guest: httpx.Client, query: dict[str, object]) -> None:
    problem(guest.get("/api/v1/runs/R-0001/evaluations", params=query), 422)  # type: ignore[arg-type]


def test_a_run_without_evaluations_has_empty_results(client: httpx.Client) -> None:
    run = submit(client)
    flown = client.get(f"/api/v1/runs/{run}/evaluations").json()
    assert (flown["stages"], flown["failures"]) == ([], [])
    for what in ("findings", "traces", "stages"):
        assert client.get(f"/api/v1/runs/{run}/{what}").json() == []


def test_findings_are_as_stored_the_worst_first(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    work.found(("F2", "F10", "F1"), validated=True)
    found = client.get(f"/api/v1/runs/{run}/findings").json()
    assert [f["label"] for f in found] == ["F1", "F2", "F10"]
    assert found[0]["cost"] == 0.1 + 0.2
    assert found[0]["parameters"] == {"vehicle.m": 6.0, "vehicle.J": float(np.nextafter(0.06, 0))}
    assert (found[0]["nominal"]["vehicle.J"], found[0]["low"]["vehicle.m"], found[0]["high"]["vehicle.m"]) == (
        0.05,
        4,
        6,
    )
    assert found[0]["at_bounds"] == {"vehicle.m": "high"}
    assert found[0]["validation"] == results.validation("F1", 0.1 + 0.2).model_dump()


def test_findings_list_the_searches_that_found_them(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    by = FoundBy(position=2, method="direct", evaluations=417)
    Work(service).found(("F1",), by=(by,))
    assert client.get(f"/api/v1/runs/{run}/findings").json()[0]["found"] == [by.model_dump()]


def test_traces_are_listed_without_their_data(guest: httpx.Client, run: str) -> None:
    traces = guest.get(f"/api/v1/runs/{run}/traces").json()
    assert [(t["name"], t["rows"]) for t in traces] == [("nominal", 3001), ("F1", 3001)]
    assert traces[0]["columns"][0] == {"name": "t", "symbol": "t", "unit": "s", "group": "time"}
    assert "data" not in traces[0]


def test_a_trace_is_thinned_but_not_around_its_closest_approach(guest: httpx.Client, run: str) -> None:
    answer = guest.get(f"/api/v1/runs/{run}/traces/F1", params={"max_points": 200}).json()
    stored = flight("F1", passing=0.8).data
    times = answer["data"]["t"]
    assert 150 <= len(times) <= 200
    assert (times[0], times[-1]) == (0.0, 15.0)
    rows = np.searchsorted(stored[:, 0], times)
    closest = answer["meta"]["closest"]["row"]
    assert set(range(closest - thin.NEAR, closest + thin.NEAR + 1)) <= set(rows.tolist())
    assert answer["data"]["x"] == stored[rows, 1].tolist()
    assert answer["data"]["separation"][:-1] == stored[rows[:-1], 9].tolist()
    assert answer["data"]["separation"][-1] is None
    whole = guest.get(f"/api/v1/runs/{run}/traces/F1", params={"max_points": 5000}).json()
    assert len(whole["data"]["t"]) == 3001


def test_an_unknown_trace_is_not_found(guest: httpx.Client, run: str) -> None:
    assert "F7" in str(problem(guest.get(f"/api/v1/runs/{run}/traces/F7"), 404)["detail"])
    problem(guest.get(f"/api/v1/runs/{run}/traces/F1", params={"max_points": 2}), 422)


@pytest.mark.parametrize("count", [0, 1, 2, 3, 10, 999, 1000])
@pytest.mark.parametrize("most", [2, 3, 7, 1000])
def test_an_even_choice_has_both_ends_and_no_more_than_asked(count: int, most: int) -> None:
    chosen = thin.even(count, most)
    assert len(chosen) == min(count, most)
    if count:
        assert (chosen[0], chosen[-1]) == (0, count - 1)
        gaps = np.diff(chosen)
        assert count <= most or gaps.max() - gaps.min() <= 1


def test_required_points_are_thinned_only_when_they_alone_are_too_many() -> None:
    kept = np.arange(100, 200)
    assert set(kept.tolist()) <= set(thin.with_kept(1000, 150, kept).tolist())
    assert len(thin.with_kept(1000, 150, kept)) <= 150
    few = thin.with_kept(1000, 10, kept).tolist()
    assert len(few) == 10
    assert (few[0], few[-1]) == (100, 199)


def test_improvements_skip_what_is_no_number() -> None:
    assert thin.improvements(np.array([np.nan, 3.0, 3.0, np.nan, 2.0, 2.5, 1.0])).tolist() == [1, 4, 6]
    assert thin.improvements(np.array([3.0, 1.0]), best=2.0).tolist() == [1]
    assert thin.improvements(np.array([])).tolist() == []
