"""The stages on real simulations: results of each, numbers in the parameters' units, distributions, the sample."""

from __future__ import annotations

from functools import cache
from typing import TypeVar

import numpy as np
import pytest

from campaigns import Campaign
from campaigns.codes import CheckCode, StopCode
from campaigns.results import SearchResult, ValidateResult, Verdict
from campaigns.results.base import Result
from campaigns.results.verdict import NominalCost
from campaigns.stages.nominal import NominalResult
from campaigns.stages.sensitivity import SensitivityResult
from tests.audited import audited
from tests.given.case_campaigns import campaign, case1, searching
from tests.given.sampled_stages import DRAWN
from tests.given.stated_facts import facts
from tests.given.verdict_evidence import check_of
from worker.engine.reference.reference import Reference
from worker.engine.stages.parts import encounter
from worker.engine.stages.parts.base import stream
from worker.evidence.audit import limits
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

R = TypeVar("R", bound=Result)
ALL_CHECKS = True

SEARCHES = (
    {"method": "direct", "evaluations": 200},
    {"method": "sqp", "evaluations": 300, "starts": [{"vehicle.m": 4.5, "vehicle.J": 0.05}]},
    {"method": "monte_carlo", "evaluations": 300},
)


@cache
def ran() -> tuple[MemoryStore, Verdict]:
    return run(searching(*SEARCHES))


def run(campaign: Campaign) -> tuple[MemoryStore, Verdict]:
    """With all spot checks; of evaluations besides the sample, a hundred are simulated beyond the horizon."""
    store = MemoryStore(sample_seed=DRAWN)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(encounter, "OTHERS", 100)
        patch.setattr(limits, "OTHERS", 100)
        conclusion = execute(campaign, store, threads=1)
        audited(store, campaign)
    return store, conclusion


def result(position: int, kind: type[R]) -> R:
    return result_of(ran()[0], position, kind)


def result_of(store: MemoryStore, position: int, kind: type[R]) -> R:
    found = store.stages[position].result
    assert isinstance(found, kind)
    return found


def test_the_stages_of_a_run() -> None:
    store, conclusion = ran()
    assert [r.plan.kind for r in store.stages] == [
        "nominal", "sensitivity", "search", "search", "search", "certify", "validate",
    ]  # fmt: skip
    assert all(r.state == "done" for r in store.stages)
    assert store.verdict is conclusion
    assert conclusion.verdict == "cleared"


def test_the_nominal_stage_states_cost_and_margin() -> None:
    assert result(0, NominalResult).model_dump() == {
        "stage": "nominal", "cost": pytest.approx(0.9435644, abs=2e-6), "margin": pytest.approx(0.4435644, abs=2e-6),
        "status": "ok", "reason": "", "parameters": {"vehicle.m": 5.0, "vehicle.J": 0.05},
    }  # fmt: skip


def test_sensitivity_against_the_published_curves() -> None:
    mass, inertia = result(1, SensitivityResult).curves
    assert (mass.path, inertia.path) == ("vehicle.m", "vehicle.J")
    assert mass.values == [4.0, 4.5, 5.0, 5.5, 6.0]
    assert inertia.values[0] == 0.04
    assert inertia.values[-1] == 0.06
    assert inertia.costs == pytest.approx([0.94426, 0.94391, 0.94356, 0.94322, 0.94287], abs=6e-6)
    assert mass.status == ["ok"] * 5


@pytest.mark.nightly
def test_sensitivity_over_a_region_that_is_excluded() -> None:
    uncertain = {"start.x": {"low": 0.0, "high": 4.0}, "start.y": {"low": -1.0, "high": 8.0}}
    store, conclusion = run(
        searching(
            {"method": "monte_carlo", "evaluations": 40},
            uncertain=uncertain,
            scenario__start__y=4.0,
            scenario__horizon=1.0,
        )
    )
    curve = result_of(store, 1, SensitivityResult).curves[0]
    assert curve.status[-1] == "excluded"
    assert [cost is None for cost in curve.costs] == [status != "ok" for status in curve.status]
    assert conclusion.verdict == "inconclusive"


def test_a_search_reports_its_best_point_in_the_units_of_the_parameters() -> None:
    problem, found = case1(), result(2, SearchResult)
    best = found.best
    assert best is not None
    assert best.cost == problem.system.loop.simulate(problem.vector(best.parameters)[None, :], 0.005, 3000).costs[0]
    assert best.margin == best.cost - 0.5
    store = ran()[0]
    columns = store.evaluations(2)
    assert columns is not None
    assert columns.costs[best.index, 0] == best.cost == columns.costs[columns.status == 0, 0].min()
    assert (found.method, found.title, found.kind, found.sample) == ("direct", "DIRECT", "global", None)
    assert found.stop is not None
    assert (found.stop.kind, found.stop.code) == ("budget", StopCode.BUDGET)
    assert found.stop.values == {"budget": 200}


def test_a_local_search_reports_its_minima() -> None:
    found = result(3, SearchResult)
    (minimum,) = found.minima
    assert found.best is not None
    assert found.stop is not None
    assert minimum.start == {"vehicle.m": 4.5, "vehicle.J": 0.05}
    assert minimum.parameters == {"vehicle.m": 6.0, "vehicle.J": 0.06}
    assert minimum.cost == found.best.cost == pytest.approx(0.9417405, abs=2e-6)
    assert found.stop.kind == "rule"


def test_the_sample_of_a_random_search() -> None:
    drawn = result(4, SearchResult).sample
    columns = ran()[0].evaluations(4)
    assert columns is not None
    assert drawn is not None
    assert drawn.histogram is not None
    costs = columns.costs[:, 0]
    assert (drawn.samples, drawn.violations, drawn.failed, drawn.confidence) == (300, 0, 0, 0.95)
    assert drawn.upper_bound == pytest.approx(1 - 0.05 ** (1 / 300))
    assert drawn.lowest == costs.min()
    assert drawn.mean == pytest.approx(costs.mean())
    assert drawn.deviation == pytest.approx(costs.std(ddof=1))
    assert sum(drawn.histogram.counts) == 300
    assert len(drawn.histogram.edges) == len(drawn.histogram.counts) + 1
    assert "0 of 300 samples drawn" in drawn.text
    assert "P(violation) is at most 0.994 % with 95 % confidence" in drawn.text


@pytest.mark.nightly
def test_excluded_flights_are_no_samples_and_violations_are_counted() -> None:
    uncertain = {"start.x": {"low": 3.0, "high": 5.0}, "start.y": {"low": 3.0, "high": 5.0}}
    changes = {"scenario__start": {"x": 3.0, "y": 3.0}, "scenario__horizon": 1.0, "criterion__threshold": 0.6}
    sampling = searching({"method": "monte_carlo", "evaluations": 400}, uncertain=uncertain, **changes)
    store, _ = run(sampling)
    found = result_of(store, 2, SearchResult)
    columns = store.evaluations(2)
    assert columns is not None
    drawn = found.sample
    assert drawn is not None
    excluded = int((columns.status == 3).sum())
    flown = columns.costs[columns.status == 0, 0]
    assert 50 < excluded < 200
    assert (found.excluded, found.evaluations) == (excluded, 400)
    assert drawn.samples == 400 - excluded == len(flown)
    assert drawn.violations == int((flown <= 0.6).sum())


def test_failed_flights_count_as_violations() -> None:
    uncertain = {"vehicle.J": {"low": 0.001, "high": 0.06}}
    store, conclusion = run(
        searching({"method": "monte_carlo", "evaluations": 100}, uncertain=uncertain, scenario__horizon=1.0)
    )
    found = result_of(store, 2, SearchResult)
    drawn = found.sample
    assert drawn is not None
    assert 0 < drawn.failed < 100
    assert drawn.violations == drawn.failed == found.failed
    assert conclusion.verdict == "inconclusive"
    assert "evaluations failed" in conclusion.reason


def test_a_run_in_which_every_flight_fails_has_no_verdict() -> None:
    request = searching(
        {"method": "direct", "evaluations": 50},
        {"method": "sqp", "evaluations": 50},
        {"method": "monte_carlo", "evaluations": 20},
        scenario__vehicle__parameters__J=0.001, uncertain={"vehicle.m": {"plus_minus": "20%"}},
    )  # fmt: skip
    store, conclusion = run(request)
    assert (conclusion.verdict, conclusion.worst) == ("inconclusive", None)
    assert conclusion.nominal == NominalCost(cost=None, margin=None)
    nominal = check_of(CheckCode.NOMINAL, conclusion)
    assert not nominal.ok
    assert f": {store.traces['nominal'].meta.reason}" in nominal.text
    assert "at t = 0.005 s" in nominal.text
    assert nominal.text in conclusion.reason
    assert store.findings == []
    assert list(store.traces) == ["nominal"]
    assert store.traces["nominal"].meta.status == "failed"
    stop = result_of(store, 3, SearchResult).stop
    assert stop is not None
    assert stop.code == StopCode.MEMBERS


def test_validation_repeats_evaluations_by_independent_means() -> None:
    found = result(6, ValidateResult)
    nominal, (worst,) = found.nominal, [f.validation for f in ran()[0].findings]
    assert found.ok
    assert nominal is not None
    assert worst is not None
    assert (nominal.name, worst.name) == ("nominal", "F1")
    for case in (nominal, worst):
        assert case.cost is not None
        assert case.half_step.cost is not None
        assert case.half_step.difference is not None
        assert case.integrator.difference is not None
        assert case.half_step.step == 0.0025
        assert case.half_step.difference == case.half_step.cost - case.cost
        assert 0 < abs(case.half_step.difference) < 1e-6
        assert case.integrator.name == "DOP853"
        assert abs(case.integrator.difference) < 1e-6
        assert case.allowed == min(1e-3 * case.cost, 0.1 * (case.cost - 0.5))
    assert nominal.neighbours is None
    assert worst.neighbours is not None
    assert worst.neighbours.flown == 20
    assert worst.neighbours.lower_by == 0.0


def test_the_finding_is_the_lowest_of_everything() -> None:
    store = ran()[0]
    (found,) = store.findings
    lowest = min(float(np.nanmin(c.costs)) for chunks in store.chunks.values() for c in chunks)
    assert found.cost == lowest
    assert found.point == [1.0, 1.0]
    assert found.parameters == {"vehicle.m": 6.0, "vehicle.J": 0.06}
    assert found.at_bounds == {"vehicle.m": "high", "vehicle.J": "high"}
    assert found.methods == ["direct", "sqp"]  # no sample came within 5 % of both ranges
    assert store.traces["F1"].meta.cost == found.cost


@pytest.mark.nightly
def test_what_only_polishing_found_names_no_method() -> None:
    # One evaluation at the centre of the box, far from the worst corner.
    store, _ = run(searching({"method": "direct", "evaluations": 1}, stages__sensitivity=None, scenario__horizon=4.0))
    (found,) = store.findings
    assert (found.methods, found.found) == ([], [])
    assert found.point == [1.0, 1.0]
    result = result_of(store, -1, ValidateResult)
    (row,) = result.comparison
    assert (row.method, row.findings, row.to_near_best) == ("direct", [], None)
    assert result.findings is not None
    assert result.findings.complete


def test_the_methods_side_by_side() -> None:
    rows = {row.method: row for row in result(6, ValidateResult).comparison}
    assert list(rows) == ["direct", "sqp", "monte_carlo"]
    store = ran()[0]
    for position, row in zip((2, 3, 4), rows.values(), strict=True):
        columns = store.evaluations(position)
        assert columns is not None
        assert row.evaluations == len(columns.status)
        assert row.best == columns.costs[:, 0].min()
        assert row.stop == result(position, SearchResult).stop
    assert rows["direct"].findings == rows["sqp"].findings == ["F1"]
    near = rows["direct"].to_near_best
    assert near is not None
    columns = store.evaluations(2)
    assert columns is not None
    limit = 0.9417405 + 0.01 * (0.9435644 - 0.9417405)
    assert columns.costs[near - 1, 0] <= limit + 1e-7 < columns.costs[: near - 1, 0].min()


def test_validation_catches_a_step_that_is_too_long() -> None:
    # 10 ms is beyond the stable step at J = 0.03; the flight survives on its envelope but is wrong.
    changes = {
        "scenario__step": 0.0075,
        "scenario__horizon": 6.0,
        "stages__validate": {"tolerance": 1e-9, "neighbours": 0, "evaluations": 20_000},
        "stages__certify": {"samples": 60},
    }
    _, conclusion = run(campaign(**changes, stages__search=[{"method": "direct", "evaluations": 20}]))
    assert conclusion.verdict == "inconclusive"
    assert not check_of(CheckCode.VALIDATION, conclusion).ok
    assert facts(check_of(CheckCode.VALIDATION, conclusion).statement)[0] == "F1"


def test_the_reference_integrator_reports_why_it_failed() -> None:
    problem = case1()
    flight = Reference(problem.system).simulate(problem.vector({"vehicle.J": 1e-300}))
    assert flight.cost is None
    assert "DOP853" in flight.reason


def test_streams_are_independent_of_each_other_and_known_by_seed_and_stage() -> None:
    draws = {(s, k): tuple(stream(s, k).random(3)) for s in (1, 2) for k in (0, 1)}
    assert len(set(draws.values())) == 4
    assert tuple(stream(1, 1).random(3)) == draws[1, 1]
