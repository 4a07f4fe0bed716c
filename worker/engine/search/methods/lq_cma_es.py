"""lq-CMA-ES: CMA-ES in which a quadratic model of the cost replaces most evaluations.

Hansen, A global surrogate assisted CMA-ES (GECCO 2019), as pycma: a model that is linear at first, then diagonal, then
fully quadratic is fitted to the latest evaluations, the better ones with more weight. Of every generation, the points
that the model ranks best are evaluated, in growing parts, until the model and the evaluations agree on the order
(Kendall's tau at least 0.85); the model ranks the others. The minimum of the model joins the next generation. A point
without a value ranks last and never enters the model; the next best point is evaluated in its place, and points whose
nearest evaluated point failed come after the others.

Ours, for budgets of tens of evaluations per parameter: stars come first, points on the axes through the centre of the
box and through the lowest of them, each with the point that takes the better value on every axis. A descent begins at
the lowest point that is not near to a lower evaluation or to where another descent began or ended (as in MLSL: Rinnooy
Kan and Timmer 1987), with a model of what was evaluated around it. A descent that has become narrow ends when it no
longer improves, or when it would not come below the lowest cost if it went on improving as lately. A restart follows
another star, around the lowest point, and points of a space-filling sample, as many as stars and sample lack to two
fifths of the evaluations so far. It begins narrower; after every fourth descent the population doubles (Auger and
Hansen, IPOP, CEC 2005, after every one). With `initial: 0` and `deviation: 0.3` it is pycma's own loop from random
points. For expensive evaluations: it takes milliseconds of its own for each one. Global by its restarts.
"""

from __future__ import annotations

import warnings
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from worker.engine.search.base import Batch, Ended, Floats, Method, MethodLook, Search, Space
from worker.engine.search.parts.cma import Normal
from worker.engine.search.parts.explored import Explored
from worker.engine.search.parts.lowest import Lowest, Reported
from worker.engine.search.parts.one_thread import one_thread
from worker.engine.search.parts.progress import Progress
from worker.engine.search.parts.pycma import STOPS, distribution, ending, last, strategy

Flags = NDArray[np.bool_]

TAU = 0.85
"""The model ranks the rest of a generation if its rank correlation with the evaluations reaches this (algorithm 1)."""
LEAST = 0.02
"""Fraction of a generation that is evaluated in any case (algorithm 1)."""
LARGEST = 1000
"""No population grows beyond this: where the model ranks all but a few, it would double with every few evaluations."""

# Set on `tests.given.small_budget_valleys`.
EXPLORED = 0.4
"""Fraction of the evaluations so far to which the sample grows, with the stars, before a restart."""
AGAIN = 0.6
"""Deviation of the first generation of a restart, as a fraction of that of the first descent."""
ALIKE = 4
"""Descents with the same population."""

# Set on `tests.given.small_budget_tuning`.
NARROW = 0.05
"""A descent may end early once its deviations are below this fraction of every range."""
LATELY = 6
"""Evaluations per parameter over which the improvement of a descent is measured."""
SETTLED = 1e-5
"""An improvement by less than this fraction of the spread of the costs does not count."""
BEHIND = Ended("converged", "no improvement of the lowest cost was predicted")
AROUND = 2.0
"""Radius, in deviations of a first generation, within which earlier evaluations enter a new model."""


@dataclass(frozen=True)
class Options:
    """The deviation is a fraction of each parameter's range."""

    population: Annotated[int, Field(ge=0, le=10_000, description="First population; 0: 4 + 3 ln(n)")] = 0
    initial: Annotated[int, Field(ge=0, le=100, description="Points per parameter before a first descent; 0: none")] = 4
    deviation: Annotated[float, Field(gt=0, le=1, description="Deviation of the first generation")] = 0.25
    growth: Annotated[float, Field(ge=1, le=10, description="Growth factor of the population")] = 2.0
    step: Annotated[
        float, Field(ge=1e-12, le=0.1, description="A descent ends when its deviations are below this fraction")
    ] = 1e-5
    at_once: Annotated[
        int, Field(ge=1, le=1000, description="Requests are multiples of this: the evaluations that run side by side")
    ] = 1


@dataclass
class Descent:
    """The strategy of the latest descent, for a search that goes on from it."""

    strategy: Any = None

    def distribution(self) -> Normal | None:
        """What its next generation would be drawn from; None before the first descent."""
        return None if self.strategy is None else distribution(self.strategy)


def search(space: Space, options: Options) -> Search:
    """One request is a star, points of the sample or a part of a generation; it restarts until the budget ends."""
    return (yield from continued(space, options, Explored(space, options.at_once), None, Descent()))


def continued(space: Space, options: Options, explored: Explored, start: Floats | None, latest: Descent) -> Search:
    """Search as `search` does, with what was explored before; the first descent begins at a point (n,) if one is
    given."""
    population = max(options.population or 4 + int(3 * np.log(space.dimension)), 4)
    deviation, descents = options.deviation, 0
    while True:
        if start is None:
            start = yield from _start(space, options, explored)
        yield from _descend(space, start, deviation, population, options, explored, latest)
        start, descents = None, descents + 1
        if options.initial:
            deviation = AGAIN * options.deviation
        if not options.initial or descents % ALIKE == 0:
            population = max(population, min(int(population * options.growth + 0.5), LARGEST))


def _start(space: Space, options: Options, explored: Explored) -> Generator[Floats, Batch, Floats]:
    """The point at which the next descent begins; the sample grows until there is one."""
    if options.initial == 0:
        return space.random.random(space.dimension)
    if len(explored.points) == 0:
        yield from explored.begin()
        for _ in range(1, -(-options.initial // 2)):
            yield from explored.star()
    else:
        yield from explored.star()
        missing = int(EXPLORED * len(explored.points)) - len(explored.sample)
        if missing > 0:
            yield from explored.grow(missing)
    while (start := explored.start()) is None:
        yield from explored.grow(space.dimension)
    return start


def _descend(
    space: Space,
    start: Floats,
    deviation: float,
    population: int,
    options: Options,
    explored: Explored,
    latest: Descent,
) -> Generator[Floats, Batch, None]:
    """One run of the strategy from a point, with a model of its own."""
    progress = Progress(LATELY * space.dimension)
    with Reported(space, start) as best:
        tested = _model(start, deviation, population, options, explored)
        descent = latest.strategy = strategy(start, deviation, population, space.random, options.step)
        while True:
            with _quiet():
                generation = descent.ask()
            known = len(tested.points)
            values = yield from _generation(np.clip(np.array(generation), 0.0, 1.0), tested, options.at_once, best)
            with _quiet():
                descent.tell(generation, last(values).tolist())
                stopped = descent.stop()
            explored.add(tested.points[known:], tested.values[known:])
            progress.add(best.evaluations, best.cost)
            narrow = options.initial > 0 and float(np.max(descent.stds)) < NARROW
            ended = ending(stopped) if stopped else _ended(progress, explored) if narrow else None
            if ended is not None:
                best.text = ended
                break
            with _quiet():
                lowest = tested.lowest()
                if lowest is not None:
                    descent.inject([lowest])
    explored.visit(start if best.point is None else best.point)


def _model(start: Floats, deviation: float, population: int, options: Options, explored: Explored) -> Tested:
    """A new model for a descent, of what was evaluated around its start."""
    from cma.fitness_models import LQModel  # imported late, as the strategy is

    tested = Tested(LQModel(max_absolute_size=population), len(start))
    if options.initial:
        explored.visit(start)
        with _quiet():
            tested.add(*explored.around(start, AROUND * deviation * float(np.sqrt(len(start)))))
    return tested


def _ended(progress: Progress, explored: Explored) -> Ended | None:
    """Why a narrow descent ends: it no longer improves, or too slowly to pass the lowest cost; None if neither."""
    if progress.cost - progress.gain > explored.lowest:
        return BEHIND
    return STOPS["tolfun"] if progress.gain <= SETTLED * explored.spread else None


class Tested:
    """The evaluated points of one run with their values, infinite where failed, and the model of the others."""

    def __init__(self, model: Any, dimension: int) -> None:
        self.model = model
        self.points, self.values = np.empty((0, dimension)), np.empty(0)

    def add(self, points: Floats, values: Floats) -> None:
        """Points (m, n) with their values (m,), infinite where failed."""
        valued = np.isfinite(values)
        for point, value in zip(points[valued], values[valued], strict=True):
            self.model.add_data_row(point, value)
        self.points, self.values = np.concatenate([self.points, points]), np.concatenate([self.values, values])

    def doubtful(self, points: Floats) -> Flags:
        """The points (m, n) whose nearest evaluated point failed."""
        failed = np.isinf(self.values)
        if not failed.any():
            return np.zeros(len(points), dtype=bool)
        distances = ((points[:, None, :] - self.points[None, :, :]) ** 2).sum(axis=2)
        return np.asarray(failed[distances.argmin(axis=1)])

    def modelled(self, points: Floats) -> Floats:
        """The model's values (m,); 0 before it has any data."""
        return np.array([float(self.model.eval(x)) for x in points])

    def lowest(self) -> Floats | None:
        """The minimum of the model, None where it has none or it is near to what failed."""
        if self.model.size == 0 or not np.isfinite(self.model.coefficients).all():
            return None
        lowest = np.asarray(self.model.xopt)
        return None if not np.isfinite(lowest).all() or self.doubtful(np.clip(lowest, 0, 1)[None])[0] else lowest


def _generation(points: Floats, tested: Tested, at_once: int, best: Lowest) -> Generator[Floats, Batch, Floats]:
    """The costs (m,) to rank a generation by, infinite where there is none.

    Algorithm 1 of the paper: evaluations in the model's order until the model is trusted.
    """
    size, model = len(points), tested.model
    values, evaluated = np.full(size, np.inf), np.zeros(size, dtype=bool)
    wanted, valued, tau = int(1 + max(size * LEAST, 3 / model.settings.truncation_ratio - model.size)), 0, 0.0
    while not evaluated.all():
        with _quiet():
            order = np.argsort(tested.modelled(points)) if model.size > 1 else np.arange(size)
            order = order[np.argsort(tested.doubtful(points[order]), kind="stable")]
        count = -(-(wanted - valued) // at_once) * at_once
        chosen = order[~evaluated[order]][:count]
        batch = yield points[chosen].copy()
        values[chosen], evaluated[chosen] = batch.ranked(), True
        best.see(points[chosen], values[chosen])
        valued = int(np.isfinite(values).sum())
        with _quiet():
            tested.add(points[chosen], values[chosen])
            model.sort(max(wanted, valued))
            tau = model.kendall(int(max(15, min(1.2 * valued, 0.75 * size))))
        if valued >= wanted:
            if tau >= TAU:
                break
            wanted = valued + (valued + 1) // 2
    with _quiet():
        model.sort(valued)
        model.adapt_max_relative_size(tau)
        return values if evaluated.all() else _ranked(points, values, evaluated, tested)


def _ranked(points: Floats, values: Floats, evaluated: Flags, tested: Tested) -> Floats:
    """The model's values, none below the lowest evaluated one; infinite where failed or near to what failed."""
    modelled = tested.modelled(points)
    modelled = modelled - modelled.min() + values.min()
    return np.where(np.where(evaluated, np.isinf(values), tested.doubtful(points)), np.inf, modelled)


@contextmanager
def _quiet() -> Iterator[None]:
    """The library's warnings are not for the user, and its results must not depend on the number of threads."""
    with warnings.catch_warnings(), one_thread():
        warnings.simplefilter("ignore")
        yield


method = Method(
    name="lq_cma_es",
    title="lq-CMA-ES",
    kind="global",
    how="Global by restarts. Models the cost, evaluates in part",
    source="Hansen 2019, as pycma",
    evaluations=500,
    options=Options,
    search=search,
    repeats=True,
    costly=True,
    extend=lambda options, more: options,
    family="normal distribution",
    whole_budget=True,
    parallel="as stated",
    at_once="at_once",
    suits="evaluations of 20 ms and more, smooth criteria",
    look=MethodLook(colour="#11523f", dark="#b4efdc", marker="left"),
)
