"""Every search method on every function of the table, with several criteria, and resumed with a larger budget."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import fields
from itertools import product
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from campaigns.results.base import EXCLUDED, FAILED, OK
from clearance.testing.searching import BUDGET, Answer, answering, at_most, batch, driven, rough
from tests.contract.searches import EACH
from tests.given.functions_with_minima import FUNCTIONS as TABLE
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Batch, Floats, Method, Minimum
from worker.running.catalogue.installed import methods


def some_by_day() -> list[Any]:
    """Every method on a sixth of the functions, another sixth for the next method; the others at night."""
    return [
        pytest.param(method, name, id=f"{name}-{method.name}", marks=() if day else pytest.mark.nightly)
        for (i, method), (j, name) in product(enumerate(methods().values()), enumerate(TABLE))
        for day in [(i + j) % 6 == 0 or name == "excluded region"]
    ]


@pytest.mark.by_day(20)
@pytest.mark.parametrize(("method", "name"), some_by_day())
def test_every_function_of_the_table(method: Method, name: str) -> None:
    """Optima off the centre; a third of the box fails in thin slices, and what the function excludes is excluded."""
    f, budget = on_unit_cube(name, 5), at_most(method, 250)
    asked: list[Floats] = []

    def statuses(points: Floats) -> NDArray[np.uint8]:
        excluded, failed = np.isnan(f(points)), np.sin(300 * points[:, 0]) > 0.5
        return np.where(excluded, EXCLUDED, np.where(failed, FAILED, OK)).astype(np.uint8)

    def evaluate(points: Floats) -> Answer:
        asked.append(points.copy())
        status = statuses(points)
        return Batch(np.where(status == OK, f(points), np.nan)[:, None], status), {}

    minima: list[Minimum] = []
    found = driven(method, evaluate, budget, f.dimension, minima)
    tally, columns = found.tally, found.columns
    assert columns is not None
    points, status = columns.points, columns.status
    assert sum(map(len, asked)) == len(points) == tally.evaluations <= budget
    assert found.stop == "rule" or tally.evaluations == budget
    assert np.array_equal(points, np.concatenate(asked))
    assert points.min() >= 0.0
    assert points.max() <= 1.0
    assert np.array_equal(status, statuses(points))
    assert (tally.failed, tally.excluded) == ((status == FAILED).sum(), (status == EXCLUDED).sum())
    assert np.isnan(columns.costs[status != OK]).all()
    assert tally.best is not None
    assert tally.best_point is not None
    assert statuses(tally.best_point[None, :])[0] == OK
    assert tally.best == columns.costs[status == OK].min() >= f.minimum - 1e-9 * max(abs(f.minimum), 1.0)
    flown = {p.tobytes() for p in points[status == OK]}
    for minimum in minima:
        assert minimum.point.tobytes() in flown
        assert minimum.cost == f(minimum.point[None, :])[0]


@pytest.mark.by_day(5)
@EACH
def test_further_criteria_are_left_to_methods_for_several(method: Method) -> None:
    """A single-objective method uses the first cost, for any further ones."""

    def asked(criteria: int) -> Floats:
        def evaluate(points: Floats) -> Answer:
            one = batch(rough(points))
            more = [points[:, k : k + 1] for k in range(criteria - 1)]
            return Batch(np.hstack([one.costs, *more]), one.status), {}

        columns = driven(method, evaluate, at_most(method, BUDGET)).columns
        assert columns is not None
        assert columns.costs.shape == (len(columns.points), criteria)
        return columns.points

    one, two = asked(1), asked(2)
    assert np.array_equal(one, two) or method.kind == "multi"


@pytest.mark.by_day(6)
@pytest.mark.parametrize("method", [m for m in methods().values() if m.extend is not None], ids=lambda m: m.name)
@pytest.mark.parametrize(
    ("name", "budget"),
    [
        *(("Branin", 150), ("excluded region", 150)),
        *(pytest.param(*at_night, marks=pytest.mark.nightly) for at_night in
          (("Branin", 1000), ("Hartman 6", 150), ("Hartman 6", 1000), ("excluded region", 1000))),
    ],
)  # fmt: skip
def test_one_that_can_be_extended_begins_with_the_same_points(method: Method, name: str, budget: int) -> None:
    f, more = on_unit_cube(name, 5), at_most(method, 700)
    budget = at_most(method, budget)
    assert method.extend is not None
    answer = answering(f, EXCLUDED)
    before = driven(method, answer, budget, f.dimension).columns
    assert before is not None
    longer = method.extend(method.options(), more)
    count = len(before.points)
    after = driven(method, answer, count + more, f.dimension, options=longer).columns
    assert after is not None
    assert len(after.points) == count + more
    assert np.array_equal(after.points[:count], before.points)


def stated(method: Method) -> Iterator[Any]:
    """Its options with each switch turned, and each whole number small."""
    known: TypeAdapter[Any] = TypeAdapter(method.options)
    for field in fields(method.options):
        usual = getattr(method.options(), field.name)
        for value in (not usual,) if isinstance(usual, bool) else (0, 1, 2) if isinstance(usual, int) else ():
            with suppress(ValidationError):
                yield known.validate_python({field.name: value})


LONG = ("genetic", "global_clustering", "nsga2", "mlsl", "portfolio")
"""Methods that solve the bowl many times below; by day the others, each of another family."""


@pytest.mark.parametrize(
    "method",
    [
        pytest.param(m, id=m.name, marks=pytest.mark.nightly if m.name in LONG else ())
        for m in methods().values()
        if m.extend is not None and not m.costly
    ],
)
def test_a_search_that_an_option_ended_takes_what_an_extension_adds(method: Method) -> None:
    """Of a bowl, which is soon solved; its first points are the same."""
    assert method.extend is not None
    answer, budget = answering(lambda x: ((x - 0.37) ** 2).sum(axis=1), EXCLUDED), 2500
    for options in stated(method):
        before = driven(method, answer, budget, options=options)
        count = before.tally.evaluations
        if before.stop != "rule":
            continue
        try:
            longer = method.extend(options, budget)
        except ValueError:  # it is refused, with the reason
            continue
        after = driven(method, answer, count + budget, options=longer)
        assert after.tally.evaluations == count + budget, options
        assert before.columns is not None
        assert after.columns is not None
        assert np.array_equal(after.columns.points[:count], before.columns.points)
