"""lq-CMA-ES: CMA-ES in which a quadratic model of the cost replaces most evaluations.

Hansen, A global surrogate assisted CMA-ES (GECCO 2019), as pycma: a model that is linear at first, then diagonal, then
fully quadratic is fitted to the latest evaluations, the better ones with more weight. Of every generation, the points
that the model ranks best are evaluated, in growing parts, until the model and the evaluations agree on the order
(Kendall's tau at least 0.85); the model ranks the others. The minimum of the model joins the next generation. Restarts
with twice the population (Auger and Hansen, IPOP, CEC 2005) until the budget ends. A point without a value ranks last
and never enters the model; the next best point is evaluated in its place, and points whose nearest evaluated point
failed come after the others. For expensive evaluations: it takes
milliseconds of its own for each one. Global by its restarts.
"""

from __future__ import annotations

import warnings
from collections.abc import Generator
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from worker.search.base import Batch, Floats, Method, MethodLook, Search, Space
from worker.search.parts.lowest import Lowest
from worker.search.parts.one_thread import one_thread
from worker.search.parts.pycma import ending, last, strategy

Flags = NDArray[np.bool_]

TAU = 0.85
"""The model ranks the rest of a generation if its rank correlation with the evaluations reaches this (algorithm 1)."""
LEAST = 0.02
"""Fraction of a generation that is evaluated in any case (algorithm 1)."""


@dataclass(frozen=True)
class Options:
    """The deviation is a fraction of each parameter's range."""

    population: Annotated[int, Field(ge=0, le=10_000, description="First population; 0: 4 + 3 ln(n)")] = 0
    deviation: Annotated[float, Field(gt=0, le=1, description="Deviation of the first generation")] = 0.3
    growth: Annotated[float, Field(ge=1, le=10, description="Growth factor of the population at a restart")] = 2.0
    step: Annotated[
        float, Field(ge=1e-12, le=0.1, description="A descent ends when its deviations are below this fraction")
    ] = 1e-5
    at_once: Annotated[
        int, Field(ge=1, le=1000, description="Requests are multiples of this: the evaluations that run side by side")
    ] = 1


def search(space: Space, options: Options) -> Search:
    """One request is a part of a generation; it restarts until the budget ends."""
    population = max(options.population or 4 + int(3 * np.log(space.dimension)), 4)
    while True:
        yield from _descend(space, population, options)
        population = int(population * options.growth + 0.5)


def _descend(space: Space, population: int, options: Options) -> Generator[Floats, Batch, None]:
    """One run of the strategy from a random point, with a model of its own."""
    from cma.fitness_models import LQModel  # imported late, as the strategy is

    start = space.random.random(space.dimension)
    best = Lowest(start)
    tested = Tested(LQModel(max_absolute_size=population), space.dimension)
    text = "the search ended"
    try:
        running = strategy(start, options.deviation, population, space.random, options.step)
        while True:
            with _quiet():
                asked = running.ask()
            values = yield from _generation(np.clip(np.array(asked), 0.0, 1.0), tested, options.at_once, best)
            with _quiet():
                running.tell(asked, last(values).tolist())
                stopped = running.stop()
                if stopped:
                    text = ending(stopped)
                    return
                lowest = tested.lowest()
                if lowest is not None:
                    running.inject([lowest])
    finally:
        best.report(space, text)


class Tested:
    """The evaluated points of one run: the model of those with a value, and which have none."""

    def __init__(self, model: Any, dimension: int) -> None:
        self.model = model
        self.points, self.failed = np.empty((0, dimension)), np.empty(0, dtype=bool)

    def add(self, points: Floats, values: Floats) -> None:
        """Points (m, n) with their values (m,), infinite where failed."""
        failed = ~np.isfinite(values)
        for point, value in zip(points[~failed], values[~failed], strict=True):
            self.model.add_data_row(point, value)
        self.points, self.failed = np.concatenate([self.points, points]), np.concatenate([self.failed, failed])

    def doubtful(self, points: Floats) -> Flags:
        """The points (m, n) whose nearest evaluated point failed."""
        if not self.failed.any():
            return np.zeros(len(points), dtype=bool)
        distances = ((points[:, None, :] - self.points[None, :, :]) ** 2).sum(axis=2)
        return np.asarray(self.failed[distances.argmin(axis=1)])

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


class _quiet:  # noqa: N801  reads as a statement
    """The library's warnings are not for the user, and its results must not depend on the number of threads."""

    def __enter__(self) -> None:
        self.warnings, self.thread = warnings.catch_warnings(), one_thread()
        self.warnings.__enter__()
        warnings.simplefilter("ignore")
        self.thread.__enter__()

    def __exit__(self, *error: Any) -> None:
        self.thread.__exit__(*error)
        self.warnings.__exit__(*error)


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
    look=MethodLook(colour="lq", marker="left"),
)
