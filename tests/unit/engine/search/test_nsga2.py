"""NSGA-II on known Pareto fronts, with failures, one criterion, and starts given twice."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.evaluator import Evaluator
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.core.termination import NoTermination
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.problems.static import StaticProblem

from campaigns.results.base import EXCLUDED, FAILED, OK
from clearance.testing.searching import space
from worker.engine.search.base import Batch, Floats
from worker.engine.search.methods.nsga2 import Options, extend, search

Several = Callable[[Floats], Floats]


def zdt1(x: Floats) -> Floats:
    """Front: f2 = 1 - sqrt(f1), where all but the first are 0 (Zitzler, Deb, Thiele 2000)."""
    g = 1.0 + 9.0 * x[:, 1:].mean(axis=1)
    return np.stack([x[:, 0], g * (1.0 - np.sqrt(x[:, 0] / g))], axis=1)


def fonseca(x: Floats) -> Floats:
    """Front: all variables equal, within 1/sqrt(n) of 0 on [-4, 4] (Fonseca, Fleming 1995); concave."""
    z = 8.0 * x - 4.0
    shift = 1.0 / np.sqrt(x.shape[1])
    return np.stack([1.0 - np.exp(-((z - s) ** 2).sum(axis=1)) for s in (shift, -shift)], axis=1)


def front(costs: Floats) -> Floats:
    """Which of these rows of two costs no other one betters: none is as low everywhere and lower somewhere."""
    order = np.lexsort((costs[:, 1], costs[:, 0]))
    before = np.minimum.accumulate(np.append(np.inf, costs[order[:-1], 1]))
    found = np.zeros(len(costs), dtype=bool)
    found[order] = costs[order, 1] < before
    return found


def run(
    f: Several, dimension: int, budget: int, seed: int = 1, failing: Several | None = None, **options: float
) -> tuple[Floats, Floats, str]:
    """Points, costs and the closing sentence of a search; `failing` marks points without costs."""
    made = search(space(dimension, budget, seed=seed), Options(**options))  # type: ignore[arg-type]
    points, costs = [], []
    asked = next(made)
    try:
        while sum(map(len, points)) < budget:
            points.append(asked)
            lost = failing(asked).astype(bool) if failing else np.zeros(len(asked), dtype=bool)
            values = np.where(lost[:, None], np.nan, f(asked))
            costs.append(values)
            asked = made.send(Batch(values, np.where(lost, FAILED, OK).astype(np.uint8)))
    except StopIteration as stopped:
        return np.concatenate(points), np.concatenate(costs), stopped.value
    return np.concatenate(points), np.concatenate(costs), ""


def pymoo(f: Several, dimension: int, generations: int, failing: Several, options: Options) -> Floats:
    """The points that pymoo requests with the same seed."""
    given = space(dimension, 1)
    first = given.random.random((options.population, dimension))
    breeder: Any = NSGA2(
        pop_size=options.population,
        sampling=Population.new("X", first),
        crossover=SBX(prob=options.crossover, eta=options.crossover_index),
        mutation=PM(prob=1.0, prob_var=options.mutation or 1.0 / dimension, eta=options.mutation_index),
    )
    breeder.tournament_type = "comp_by_rank_and_crowding"
    problem = Problem(n_var=dimension, n_obj=f(first).shape[1], n_ieq_constr=1, xl=0.0, xu=1.0)
    breeder.setup(problem, termination=NoTermination(), seed=int(given.random.integers(2**31)))
    points = []
    for _ in range(generations):
        asked = breeder.ask()
        points.append(np.array(asked.get("X"), dtype=np.float64))
        lost = failing(points[-1])
        costs = np.where(lost[:, None], 0.0, f(points[-1]))
        Evaluator().eval(StaticProblem(problem, F=costs, G=np.where(lost, 1.0, -1.0)[:, None]), asked)
        breeder.tell(infills=asked)
    return np.concatenate(points)


@pytest.mark.by_day(2)
@pytest.mark.parametrize(
    ("f", "dimension", "options"),
    [
        (zdt1, 4, {}),
        (lambda x: np.round(np.stack([x[:, 0], x[:, 1] - x[:, 0], x[:, 2] ** 2], axis=1), 1), 3, {"population": 31}),
        (lambda x: np.round(x[:, :1], 1), 1, {"population": 20, "crossover": 0.3, "mutation": 0.7}),
        (zdt1, 2, {"population": 12, "crossover_index": 1.0, "mutation_index": 0.0}),
    ],
    ids=["two costs", "three costs, many equal", "one cost", "wide crossover and mutation"],
)
@pytest.mark.parametrize(
    "most", [pytest.param(2.0, id="all valued", marks=pytest.mark.nightly), pytest.param(0.6, id="some failed")]
)
def test_its_points_are_those_of_pymoo(f: Several, dimension: int, options: dict[str, Any], most: float) -> None:
    def failing(x: Floats) -> Floats:
        return np.asarray(x[:, -1] > most)

    points, _, _ = run(f, dimension, 10**6, failing=failing, generations=25, **options)
    assert points.tobytes() == pymoo(f, dimension, 25, failing, Options(**options)).tobytes()


def test_it_reaches_a_known_convex_front_and_spreads_over_it() -> None:
    _, costs, statement = run(zdt1, 8, 10**6, generations=120)
    last = costs[-300:]
    assert statement == "completed the 120 generations"
    assert np.abs(last[:, 1] - (1.0 - np.sqrt(last[:, 0])))[last[:, 0] <= 1.0].mean() < 0.05
    best = costs[costs[:, 1] < 1.0 - np.sqrt(costs[:, 0]) + 0.01]
    assert set(np.floor(10 * best[:, 0]).clip(0, 9)) == set(range(10))


def test_it_reaches_a_known_concave_front() -> None:
    # Along it the two exponents a and b, squared distances from the two ends, have sqrt(a) + sqrt(b) = 2.
    _, costs, _ = run(fonseca, 3, 10**6, generations=60)

    def above(values: Floats) -> Floats:
        return np.asarray(np.sqrt(-np.log1p(-values)).sum(axis=1) - 2.0)

    best, first = costs[front(costs)], costs[:100][front(costs[:100])]
    assert above(best).min() > -1e-12
    assert above(best).mean() < 0.1 * above(first).mean()
    assert len(best) > 100
    assert best.min(axis=0).max() < 0.03


def test_with_one_criterion_it_finds_the_minimum() -> None:
    points, costs, _ = run(lambda x: ((x - 0.3) ** 2).sum(axis=1, keepdims=True), 3, 6000)
    assert costs.min() < 1e-4
    assert points[costs[:, 0].argmin()] == pytest.approx([0.3] * 3, abs=0.01)


def test_failed_points_die_out_and_their_costs_are_never_read() -> None:
    forbidden: Several = lambda x: x[:, 0] > 0.4  # noqa: E731
    points, costs, _ = run(zdt1, 4, 5000, failing=forbidden)
    assert np.isnan(costs[:, 0]).sum() == (points[:, 0] > 0.4).sum()
    assert (points[:500, 0] > 0.4).mean() > 3 * (points[-500:, 0] > 0.4).mean()


def test_it_continues_where_every_evaluation_fails() -> None:
    points, costs, _ = run(zdt1, 4, 1000, failing=lambda x: np.ones(len(x)))
    assert np.isnan(costs).all()
    assert len(points) >= 1000


def test_excluded_is_treated_as_failed() -> None:
    def play(status: int) -> Floats:
        made, points = search(space(2, 500), Options(population=20)), []
        asked = next(made)
        while sum(map(len, points)) < 500:
            points.append(asked)
            lost = asked[:, 1] > 0.5
            values = np.where(lost[:, None], np.nan, zdt1(asked))
            asked = made.send(Batch(values, np.where(lost, status, OK).astype(np.uint8)))
        return np.concatenate(points)

    assert play(FAILED).tobytes() == play(EXCLUDED).tobytes()


def test_the_seed_decides_and_the_budget_does_not() -> None:
    first, again, other = run(zdt1, 3, 900)[0], run(zdt1, 3, 1500)[0], run(zdt1, 3, 900, seed=2)[0]
    assert again[: len(first)].tobytes() == first.tobytes()
    assert not np.array_equal(first, other)


def test_more_generations_begin_with_the_same_ones() -> None:
    few = Options(population=10, generations=5)
    more = extend(few, 100)
    assert more.generations >= 15
    points = run(zdt1, 3, 10**6, population=10, generations=5)[0]
    longer = run(zdt1, 3, 10**6, population=10, generations=more.generations)[0]
    assert longer[: len(points)].tobytes() == points.tobytes()
    assert len(longer) >= len(points) + 100


def test_starts_come_first_and_twice_the_same_is_one() -> None:
    starts = np.array([[0.25, 0.5], [0.25, 0.5], [0.75, 0.125]])
    made = search(space(2, 100, starts=starts), Options(population=10))
    asked = next(made)
    assert asked[:2].tolist() == [[0.25, 0.5], [0.75, 0.125]]
    assert len(asked) == 9
    following = made.send(Batch(zdt1(asked), np.zeros(len(asked), dtype=np.uint8)))
    assert following.shape[1] == 2
