"""DIRECT's remaining gap: rectangles built again from stored evaluations, slopes along each side, the lowest corner."""

from __future__ import annotations

import numpy as np
import pytest

from campaigns.stored.records import Columns
from clearance.testing.searching import Function, batch, run
from tests.given.case_campaigns import case1
from tests.given.sampled_stages import asked, context, evaluate
from tests.given.stated_facts import facts
from worker.engine.search.base import Floats, Method
from worker.engine.search.methods import direct, direct_l, sqp
from worker.engine.stages import search
from worker.engine.stages.parts import gap


def stored(
    function: Function, budget: int, options: dict[str, float] | None = None, method: Method = direct.method
) -> Columns:
    found = run(method, function, 2, budget, options=options)
    points = found.points[:budget]
    answer = batch(function(points))
    return Columns(points, answer.costs, answer.status, np.zeros(len(points)), {})


def plane(x: Floats) -> Floats:
    return np.asarray(1.0 + 2.0 * x[:, 0] - 0.5 * x[:, 1])


@pytest.mark.parametrize("method", [direct.method, direct_l.method], ids=lambda m: m.name)
def test_of_a_plane_it_is_exact(method: Method) -> None:
    # Slopes 2 and 0.5 along the sides: the estimate is the true minimum, at the corner (0, 1).
    for budget in (5, 40, 700):
        found = gap.estimate(case1(), method, direct.Options(), stored(plane, budget, method=method))
        assert found is not None
        assert found.slopes == {"vehicle.m": pytest.approx(2.0 / 2), "vehicle.J": pytest.approx(0.5 / 0.02)}
        assert found.lower_bound == pytest.approx(0.5)


def test_of_a_bowl_it_is_below_the_minimum_and_approaches_it() -> None:
    def bowl(x: Floats) -> Floats:
        return np.asarray(((x - 0.3) ** 2).sum(axis=1))

    gaps = []
    for budget in (21, 201, 2001):
        found = gap.estimate(
            case1(), direct.method, direct.Options(epsilon=0.0), stored(bowl, budget, {"epsilon": 0.0})
        )
        assert found is not None
        assert found.lower_bound <= 0.0
        gaps.append(found.gap)
    assert gaps[0] > gaps[1] > gaps[2]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("method", [direct.method, direct_l.method], ids=lambda m: m.name)
@pytest.mark.parametrize(
    "failing",
    [pytest.param(False, id="every value", marks=pytest.mark.nightly), pytest.param(True, id="failing region")],
)
def test_it_is_never_above_what_the_search_has_evaluated(method: Method, failing: bool) -> None:
    """A deep hole that the last evaluations of many budgets meet, in an iteration that the budget ends."""

    def holed(x: Floats) -> Floats:
        hole = (np.abs(x[:, 0] - 0.3) < 0.02) & (np.abs(x[:, 1] - 0.77) < 0.03)
        values = (x[:, 0] - 0.31) ** 2 + (x[:, 1] - 0.77) ** 2 - 3.0 * hole
        return np.where(failing & (np.sin(40 * x[:, 0]) < -0.3) & ~hole, np.nan, values)

    whole, estimated = stored(holed, 200, method=method), 0
    for budget in range(9, 200, 2):
        columns = Columns(*(part[:budget] for part in whole[:4]), {})
        found = gap.estimate(case1(), method, direct.Options(), columns)
        best = float(np.nanmin(columns.costs))
        if found is None:
            assert failing
            continue
        estimated += 1
        assert found.lower_bound <= best
        assert found.gap == best - found.lower_bound
    assert estimated > 80


def test_the_rectangles_are_those_of_the_search() -> None:
    columns = stored(plane, 400)
    boxes, search = direct.divide(2, direct.Options())
    gap._replayed(search, columns)
    whole = boxes.count
    assert 350 < whole <= 400
    # The centres are the evaluated points, and their sides fill the unit square.
    assert sorted(map(tuple, boxes.centre[:whole])) == sorted(map(tuple, columns.points[:whole]))
    assert (3.0 ** -boxes.depth[:whole].astype(float)).prod(axis=1).sum() == pytest.approx(1.0)


def test_rectangles_without_a_value_are_ignored_and_reported() -> None:
    columns = stored(lambda x: np.where(x[:, 0] > 0.6, np.nan, plane(x)), 300)
    found = gap.estimate(case1(), direct.method, direct.Options(), columns)
    assert found is not None
    assert found.without_value > 0
    assert facts(found.statement)[-1] == found.without_value
    assert found.slopes["vehicle.m"] == pytest.approx(1.0)


def test_where_there_is_nothing_to_estimate() -> None:
    assert gap.estimate(case1(), sqp.method, direct.Options(), stored(plane, 50)) is None
    nothing = stored(lambda x: np.full(len(x), np.nan), 50)
    assert gap.estimate(case1(), direct.method, direct.Options(), nothing) is None
    one = gap.estimate(case1(), direct.method, direct.Options(), stored(plane, 1))
    assert one is not None
    assert one.gap == 0.0


def test_a_search_stage_reports_it_as_an_estimate() -> None:
    found = search.run(context(asked({"search": [{"method": "direct", "evaluations": 200}]}), evaluate()), 0).result.gap
    assert found is not None
    assert found.lower_bound == pytest.approx(0.3)
    assert [fact for fact in facts(found.statement) if isinstance(fact, str)] == ["d_min"]
    assert facts(found.statement)[1] == pytest.approx(0.3)
