"""The findings of a run on functions with known worst cases: number, methods, evaluations until found."""

from __future__ import annotations

import numpy as np
import pytest

from campaigns import Campaign
from campaigns.results import Finding
from campaigns.results.finding import FoundBy
from campaigns.stages.nominal import NominalResult
from campaigns.stored.records import StagePlan
from clearance.testing.searching import Function, batch
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import case1, searching
from worker.engine.search.parts.basin import Basin
from worker.engine.stages import search
from worker.engine.stages.parts import candidates, findings, scales
from worker.engine.stages.parts.base import drive, stream
from worker.engine.stages.parts.comparison import compare, reached
from worker.engine.stages.parts.context import Context, Driven
from worker.engine.stages.parts.findings import Found
from worker.engine.stages.parts.left import Left
from worker.engine.systems.base import Floats
from worker.running.catalogue.installed import methods
from worker.running.runs.store import MemoryStore

GLOBAL = [m.name for m in methods().values() if m.kind == "global"]
BUDGET = 3000
BUDGETS = {"turbo": 1000, "lq_cma_es": 1000}
"""Of methods whose own time is milliseconds per evaluation."""
WELL = 0.005
"""Squared width of a well: 5 % of the box is below half its depth."""
SLOW = {"turbo", "lq_cma_es", "cma_es", "mlsl", "nlopt_global"}
"""Methods that take most of a second and more here: at night."""
OPTIONS: dict[str, dict[str, int]] = {"nlopt_global": {"population": 300}}
"""Controlled random search with NLopt's own population of 30 contracts on one well before it has seen the other."""


def two_failures(x: Floats) -> Floats:
    """Two symmetric wells in the plane, below the threshold of 0.5 at their bottoms; 1 far from both."""
    wells = sum(np.exp(-((x - place) ** 2).sum(axis=1) / WELL) for place in ([0.23, 0.31], [0.77, 0.69]))
    return np.asarray(1.0 - 0.7 * wells + 0.05 * ((x - 0.5) ** 2).sum(axis=1))


def context(campaign: Campaign, function: Function) -> Context:
    """A run in memory whose evaluations are this function's values."""
    store = MemoryStore()
    searches = [StagePlan("search", s.method, s.evaluations) for s in campaign.stages.search]
    planned = [StagePlan("nominal", None, 1), *searches, StagePlan("validate", None, 10**6)]
    store.plan(planned)
    made = Context(
        campaign,
        case1(),
        lambda points, seeds=None: (batch(function(points)), {}),
        store,
        plan=planned,
        methods=methods(),
    )
    nominal = float(function(case1().nominal_point[None, :])[0])
    made.results[0] = NominalResult(cost=nominal, margin=nominal - case1().threshold, status="ok")
    return made


def found_by(campaign: Campaign, function: Function, budget: int = 10**6) -> tuple[Context, Found, Driven]:
    """All searches, then what the findings stage makes of them."""
    made = context(campaign, function)
    for index in range(len(campaign.stages.search)):
        made.results[index + 1] = search.run(made, index + 1).result
    found = Found()
    position = len(campaign.stages.search) + 1
    return made, found, drive(made, position, findings.search(made, position, found), budget, repeats=True)


@pytest.mark.by_day(3)
@pytest.mark.parametrize("method", [pytest.param(m, marks=[pytest.mark.nightly] if m in SLOW else []) for m in GLOBAL])
def test_two_symmetric_failures_are_exactly_two_findings(method: str) -> None:
    request = {"method": method, "evaluations": BUDGETS.get(method, BUDGET), "options": OPTIONS.get(method, {})}
    made, found, driven = found_by(searching(request), two_failures)
    assert driven.stop == "rule"
    assert len(found.basins) == 2
    assert sorted(tuple(np.round(b.point, 2)) for b in found.basins) == [(0.23, 0.31), (0.77, 0.69)]
    assert all(b.cost < 0.5 for b in found.basins)
    columns = made.store.evaluations(1)
    assert columns is not None
    counts = [reached(made, found, 1, columns, i) for i in range(2)]
    assert any(c is not None for c in counts), "the method came to neither by itself"


@pytest.mark.parametrize("value", [10.0, 100.0, 1e6, 1e12])
def test_a_large_value_at_the_nominal_point_joins_no_failures(value: float) -> None:
    """Where nothing is met; next to it every ridge between two wells is flat."""

    def function(x: Floats) -> Floats:
        return np.where(np.abs(x - 0.5).max(axis=1) < 0.05, value, two_failures(x + np.array([0.0, 0.19])))

    made, found, _ = found_by(searching({"method": "direct", "evaluations": 600}), function)
    assert sorted(tuple(np.round(b.point, 2)) for b in found.basins[:2]) == [(0.23, 0.12), (0.77, 0.5)]
    assert scales.spanned(made, found.basins[0].cost) < 1.0
    assert scales.rounding(made, found.basins[0].cost) < 1e-6


def test_a_method_is_named_with_the_evaluation_at_which_it_came_close() -> None:
    campaign = searching({"method": "direct", "evaluations": 500}, {"method": "monte_carlo", "evaluations": 20})
    made, found, _ = found_by(campaign, two_failures)
    columns = made.store.evaluations(1)
    assert columns is not None
    for i, basin in enumerate(found.basins):
        needed = reached(made, found, 1, columns, i)
        assert needed is not None
        near = basin.cost + 0.01 * scales.scale(made, basin.cost)
        close = [
            i for i, (p, c) in enumerate(zip(columns.points, columns.costs[:, 0], strict=True))
            if c <= near and np.abs(p - basin.point).max() <= 0.05
        ]  # fmt: skip
        assert needed == close[0] + 1
    named = [
        Finding(
            label=f"F{i}",
            cost=b.cost,
            margin=b.cost - 0.5,
            parameters={},
            point=b.point.tolist(),
            methods=["direct"],
            found=[FoundBy(position=1, method="direct", evaluations=1)],
            validation=None,
        )
        for i, b in enumerate(found.basins, 1)
    ]
    direct, sample = compare(made, named, found, ["F1", "F2"])
    assert (direct.findings, sample.findings) == (["F1", "F2"], [])
    assert direct.best == columns.costs[:, 0].min()
    best = columns.points[int(np.argmin(columns.costs[:, 0]))]  # the first of two points of one value, one in each well
    assert direct.basin == min(named, key=lambda f: float(np.abs(best - f.point).max())).label


@pytest.mark.parametrize(
    ("function", "count"),
    [
        (lambda x: 1.0 - x[:, 0], 1),
        (lambda x: np.maximum(0.0, x[:, 0] - 0.3), 1),
        (lambda x: np.cos(14.0 * x[:, 0]) + 0.002 * x[:, 0], 2),
    ],
    ids=["parameter that does not matter", "plateau", "two valleys"],
)
def test_a_search_with_a_result_of_its_own_in_a_basin_has_reached_its_worst_case(
    function: Function, count: int
) -> None:
    """Two searches end far from each other in the parameter that does not matter, at the same cost."""
    starts = [[{"vehicle.m": m, "vehicle.J": j} for m in (4.35, 5.35)] for j in (0.042, 0.058)]
    made, found, _ = found_by(
        searching(*({"method": "sqp", "evaluations": 300, "starts": s} for s in starts)), function
    )
    for at in (1, 2):
        columns = made.store.evaluations(at)
        assert columns is not None
        needed = [reached(made, found, at, columns, i) for i in range(count)]
        assert None not in needed


def test_each_minimum_of_a_search_is_in_the_basin_of_the_finding_that_it_ended_in() -> None:
    """Descents from everywhere end in two wells, or on the plain around them, which no barrier separates from one."""
    starts = [{"vehicle.m": m, "vehicle.J": j} for m in (4.3, 4.6, 5.4, 5.6) for j in (0.046, 0.053)]
    campaign = searching(
        {"method": "direct", "evaluations": 500}, {"method": "sqp", "evaluations": 900, "starts": starts}
    )
    made, found, _ = found_by(campaign, two_failures)
    known = [FoundBy(position=1, method="direct", evaluations=1)]
    named = [
        Finding(
            label=f"F{i}", cost=b.cost, margin=b.cost - 0.5, parameters={}, point=b.point.tolist(), methods=["direct"],
            found=known, validation=None,
        )
        for i, b in enumerate(found.basins, 1)
    ]  # fmt: skip
    direct, sqp = compare(made, named, found, ["F1", "F2"])
    ends = made.searched[2].minima
    assert (direct.minima, len(sqp.minima)) == ([], len(ends))
    inside = [(end, of) for end, of in zip(ends, sqp.minima, strict=True) if end.cost < 0.5]
    for end, of in inside:
        nearest = min(named, key=lambda f: float(np.abs(np.array(end.point) - f.point).max()))
        assert of == nearest.label
    assert {of for _, of in inside} == {"F1", "F2"}, "at least one descent ended in each well"
    assert set(sqp.minima) <= {"F1", "F2", None}


def test_starts_walk_down_what_is_stored_but_for_the_best_of_a_stage() -> None:
    campaign = searching({"method": "direct", "evaluations": 500}, {"method": "monte_carlo", "evaluations": 300})
    made, _, _ = found_by(campaign, two_failures)
    state = Found()
    state.candidates, _ = candidates.gather(made, 3)
    starts = [Basin(c.point, c.cost, [i]) for i, c in enumerate(state.candidates)]
    alone = candidates.walked(made, 3, state.candidates, starts)
    bests = {(at, result.best.cost) for at, result in made.searched.items() if result.best is not None}
    moved = [s.cost < c.cost for s, c in zip(starts, state.candidates, strict=True)]
    claimed = [(c.position, c.cost) in bests for c in state.candidates]
    assert {c.position for c, own in zip(state.candidates, claimed, strict=True) if own} == {1, 2}
    assert not any(np.array(moved) & np.array(claimed))
    assert sum(moved) > 5
    assert all(s.cost == two_failures(s.point[None, :])[0] for s in starts)
    assert all(i in alone for i, s in enumerate(starts) if s.cost == min(s.cost for s in starts))


def test_where_more_findings_are_requested_descents_begin_from_more_points() -> None:
    counts = []
    for most in (1, 8, 32):
        stages = {"stages__findings": {"at_most": most}, "stages__validate": {"evaluations": 100_000}}
        campaign = searching({"method": "monte_carlo", "evaluations": 3000}, **stages)
        made, _, _ = found_by(campaign, lambda x: np.cos(25 * x).sum(axis=1), budget=1)
        counts.append(len(candidates.gather(made, 2)[0]))
    few, usual, many = counts
    assert few == usual < many


def many(most: int) -> tuple[Context, Found, Driven]:
    """The findings of twelve wells of which a small search has seen few."""
    grid = np.array([[x, y] for x in (0.12, 0.38, 0.64, 0.9) for y in (0.15, 0.5, 0.85)])

    def wells(x: Floats) -> Floats:
        apart = ((x[:, None, :] - grid) ** 2).sum(axis=2)
        return np.asarray(1.0 - 0.7 * np.exp(-apart / WELL).sum(axis=1) + 0.05 * ((x - 0.5) ** 2).sum(axis=1))

    stages = {"stages__findings": {"at_most": most}, "stages__validate": {"evaluations": 60_000}}
    return found_by(searching({"method": "monte_carlo", "evaluations": 6}, **stages), wells, budget=60_000)


@pytest.mark.nightly
def test_where_more_findings_are_requested_what_is_left_looks_for_further_ones() -> None:
    _, found, driven = many(24)
    _, usual, few = many(8)
    assert len(usual.basins) < 8
    assert len(found.basins) == 12
    assert few.tally.evaluations < driven.tally.evaluations <= 60_000
    assert driven.stop == "rule"
    assert all(found.of(basin).neighbours is not None for basin in found.basins)


@pytest.mark.nightly  # by day whole runs have the same bits when they are resumed: test_same_numbers.py
def test_what_is_left_looks_for_the_same_ones_again() -> None:
    again, columns = (many(24)[0].store.evaluations(2) for _ in range(2))
    assert columns is not None
    assert again is not None
    assert np.array_equal(columns.points, again.points)


def rugged(x: Floats) -> Floats:
    """Many minima, with dips of every size."""
    dips = (np.cos(60.0 * x) + 0.6 * np.cos(199.0 * x) + 0.3 * np.cos(701.0 * x)).sum(axis=1)
    return np.asarray(2.0 + 0.2 * dips + ((x - 0.4) ** 2).sum(axis=1))


def smooth(x: Floats) -> Floats:
    """Some 16 minima, most of them violations."""
    return np.asarray(0.9 + 0.3 * np.cos(25.0 * x).sum(axis=1) + 0.5 * ((x - 0.4) ** 2).sum(axis=1))


@pytest.mark.by_day(2)
@pytest.mark.parametrize("function", [rugged, smooth, two_failures])
@pytest.mark.parametrize("allowed", nightly_but((700, 6_000), [700, 3_000, 6_000, 12_000, 40_000]))
def test_who_requests_more_findings_gets_no_less(function: Function, allowed: int) -> None:
    ends = []
    for most in (8, 9):
        stages = {"stages__findings": {"at_most": most}, "stages__validate": {"evaluations": allowed}}
        campaign = searching({"method": "monte_carlo", "evaluations": 3000}, **stages)
        _, found, driven = found_by(campaign, function, budget=findings.validation(campaign).stored)
        complete = [b for b in found.basins if found.of(b).neighbours is not None and found.of(b).after is not None]
        assert driven.stop == "budget" or len(complete) == len(found.basins)
        ends.append((driven.stop == "rule", len(complete), -found.basins[0].cost))
        points, distance = [b.point for b in found.basins], campaign.stages.findings.distance
        assert all(np.abs(a - b).max() >= distance for i, a in enumerate(points) for b in points[:i])
    (rule, many, deep), (rule_of_more, more, deeper) = ends
    assert rule_of_more >= rule
    assert not rule or (more >= many and deeper >= deep - 1e-6)


def test_minima_no_worse_than_nominal_are_counted_once() -> None:
    def wells(x: Floats) -> Floats:
        high = [([0.9, 0.1], 0.2), ([0.1, 0.9], 0.2), ([0.5, 0.9], 0.2), ([0.9, 0.5], 0.2)]
        return np.asarray(
            two_failures(x)
            + 3.0 * (1 - np.exp(-((x - 0.5) ** 2).sum(axis=1) / 0.08))
            - sum(d * np.exp(-((x - p) ** 2).sum(axis=1) / WELL) for p, d in high)
        )

    out = []
    for most in (8, 9):
        stages = {"stages__findings": {"at_most": most}, "stages__validate": {"evaluations": 30_000}}
        _, found, _ = found_by(searching({"method": "direct", "evaluations": 300}, **stages), wells, budget=30_000)
        out.append(found.left_out)
    assert out[1] == out[0]


def test_a_minimum_no_worse_than_nominal_is_left_out_unless_it_violates() -> None:
    def three(x: Floats) -> Floats:
        bump = 0.3 * np.exp(-((x - [0.8, 0.2]) ** 2).sum(axis=1) / WELL)
        return np.asarray(two_failures(x) + 0.6 - bump)

    campaign = searching({"method": "direct", "evaluations": 2000})
    _, found, _ = found_by(campaign, three)
    nominal = float(three(case1().nominal_point[None, :])[0])
    assert all(b.cost < nominal for b in found.basins)
    _, strict, _ = found_by(searching({"method": "direct", "evaluations": 2000}), lambda x: three(x) - 0.9)
    assert len(strict.basins) >= len(found.basins)


def test_where_nominal_is_the_worst_it_is_the_finding() -> None:
    _, found, _ = found_by(
        searching({"method": "direct", "evaluations": 200}), lambda x: 1.0 + ((x - 0.5) ** 2).sum(axis=1)
    )
    (only,) = found.basins
    assert np.abs(only.point - 0.5).max() < 1e-6


def test_neighbours_lower_a_rough_worst_case() -> None:
    def rough(x: Floats) -> Floats:
        grain = np.modf(np.abs(np.sin(x[:, 0] * 12345.678 + x[:, 1] * 54321.987)) * 1000.0)[0]
        return np.asarray(1.0 + ((x - 0.4) ** 2).sum(axis=1) + 1e-3 * grain)

    campaign = searching(
        {"method": "direct", "evaluations": 300}, stages__validate={"neighbours": 5000, "evaluations": 20_000}
    )
    _, found, _ = found_by(campaign, rough)
    flown = [found.of(basin).neighbours for basin in found.basins]
    assert any(n is not None and n.lower_by is not None and n.lower_by > 0.0 for n in flown)
    for neighbours, basin in zip(flown, found.basins, strict=True):
        assert neighbours is not None
        assert neighbours.flown == 5000
        assert basin.cost == rough(basin.point[None, :])[0]
        assert neighbours.lower_by == 0.0 or basin.cost == neighbours.lowest


def lowest_stored(made: Context) -> float:
    stored = [made.store.evaluations(at) for at in range(4)]
    return min(float(np.nanmin(c.costs[:, 0])) for c in stored if c is not None)


@pytest.mark.parametrize("seed", range(6))
def test_whatever_is_evaluated_and_lower_becomes_a_finding(seed: int) -> None:
    # Slits far narrower than any search resolves, on the axes through the worst case, where slices are evaluated.
    random = np.random.default_rng(seed)
    worst = np.round(random.uniform(0.1, 0.9, 2) * 40) / 40
    along = int(random.integers(2))
    place = worst.copy()
    place[along] = (worst[along] + random.choice([0.2, 0.3, 0.4])) % 1.0

    def slit(x: Floats) -> Floats:
        cost = 1.0 + ((x - worst) ** 2).sum(axis=1)
        inside = np.abs(x - place).max(axis=1) < 1e-4
        return np.asarray(np.where(inside, 0.1 + 1e3 * np.abs(x - place).max(axis=1), cost))

    campaign = searching({"method": "direct", "evaluations": 200}, {"method": "genetic", "evaluations": 200})
    made, found, driven = found_by(campaign, slit)
    assert driven.stop == "rule"
    assert found.basins[0].cost == lowest_stored(made)
    assert found.basins[0].cost <= 0.11, "a slice met the slit"


def test_a_budget_that_ends_at_once_leaves_the_lowest_evaluation_as_the_finding() -> None:
    for budget in (1, 7, 60, 400):
        made, found, _ = found_by(searching({"method": "direct", "evaluations": 100}), two_failures, budget)
        omitted = found.left_out
        findings.settle(made, 2, found, Left(made.campaign, False, 0))
        assert found.basins[0].cost == lowest_stored(made)
        assert len(found.basins) <= made.campaign.stages.findings.at_most
        assert found.left_out == omitted, "these are no worse than nominal"


def test_without_any_cost_there_is_no_finding() -> None:
    _, found, driven = found_by(searching({"method": "direct", "evaluations": 100}), lambda x: np.full(len(x), np.nan))
    assert found.basins == []
    assert driven.how.text == "no evaluation succeeded"


def test_a_spent_budget_retains_the_basins_found_and_is_reported() -> None:
    campaign = searching({"method": "direct", "evaluations": 500})
    made, found, driven = found_by(campaign, two_failures, budget=60)
    assert driven.stop == "budget"
    assert found.basins
    columns = made.store.evaluations(1)
    assert columns is not None
    assert found.basins[0].cost <= columns.costs[:, 0].min()


def test_it_repeats_bit_by_bit() -> None:
    campaign = searching({"method": "direct", "evaluations": 300}, {"method": "monte_carlo", "evaluations": 100})
    one, other = (found_by(campaign, two_failures)[0].store.evaluations(3) for _ in range(2))
    assert one is not None
    assert other is not None
    assert np.array_equal(one.points, other.points)


def test_findings_have_their_own_random_numbers() -> None:
    made = context(searching({"method": "direct", "evaluations": 1}), two_failures)
    drawn = [stream(made.campaign.seed, findings.FINDINGS_STREAM).random(4) for _ in range(2)]
    assert np.array_equal(*drawn)
    assert not np.array_equal(drawn[0], stream(made.campaign.seed, 0).random(4))
