"""MLSL: a local search from every low sample point without a lower one nearby, in a sample that keeps growing.

Rinnooy Kan and Timmer, Stochastic global optimization methods II: multi level methods (Math. Programming 39, 1987),
with Sobol points (Kucherenko and Sytsko 2005) and the constants of NLopt's G_MLSL_LDS. In the limit it finds every
local minimum, each from one start.

Ours: all local searches that the rule allows run side by side, every other one along gradients (Kraft 1988) whose
finite differences are one request, the others without; a twentieth of the evaluations extends the sample meanwhile. On
instances 1 and 2 of BBOB in 5 dimensions at 100, 200 and 1,000 evaluations per parameter it reaches 0.39, 0.42 and 0.53
of the targets; NLopt's program, which requests one point at a time (`as_published`), 0.35, 0.38 and 0.43.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import nlopt
import numpy as np
from pydantic import Field

from worker.engine.search.base import Batch, Floats, Method, MethodLook, Minimum, Parallel, Search, Several, Space
from worker.engine.search.parts.descent import End, Settings, descend
from worker.engine.search.parts.levels import Levels
from worker.engine.search.parts.nlopt_calls import local, optimised

LIBRARY = {
    "bobyqa": nlopt.LN_BOBYQA,
    "cobyla": nlopt.LN_COBYLA,
    "nelder_mead": nlopt.LN_NELDERMEAD,
    "subplex": nlopt.LN_SBPLX,
}
FINE = Settings("scipy", "forward", 1.5e-9, cost_tolerance=1e-10, iterations=1000, apart=True)
"""Differences near the square root of the rounding errors of a smooth cost."""
COARSE = replace(FINE, difference=1e-5)
"""Differences for costs with larger errors, from the first local search on that moved nowhere."""
STEP = 0.25
"""The first step of a local search without gradients: NLopt's, for all, in the middle of the box."""
LEAST = 4
"""Points of the sample per round, as in NLopt."""
WIDER, WIDEST = 5, 64
"""Evaluations per parameter for each further point of a request that the sample fills, and where that ends."""
SAMPLED = 0.05
"""Fraction of the evaluations that the sample may have while local searches run."""


@dataclass(frozen=True)
class Options:
    """The local search and the sample."""

    local: Annotated[
        Literal["both", "slsqp", "bobyqa", "cobyla", "nelder_mead", "subplex"],
        Field(description="The local search: along gradients (slsqp), without, or slsqp and bobyqa in turns"),
    ] = "both"
    sample: Annotated[int, Field(ge=0, le=100_000, description="Points per round; 0: NLopt's own 4")] = 0
    tolerance: Annotated[
        float,
        Field(gt=0, le=0.1, description="A search without gradients ends at this step, as a fraction of each range"),
    ] = 1e-5
    as_published: Annotated[
        bool, Field(description="NLopt's program: one local search after the other, one point at a time")
    ] = False


@dataclass
class Descent:
    """A running local search: its start, and the points that it requests."""

    start: Floats
    search: Generator[Floats, Batch, End]
    requested: Floats


def search(space: Space, options: Options) -> Parallel:
    """One request has the points of every running local search, and points of the sample; until the budget ends."""
    if options.as_published:
        return (yield from optimised(space, lambda: _published(space, options), random=False))
    multistart = Multistart(space, options)
    try:
        return (yield from (multistart.in_slots() if space.slots else multistart.in_batches()))
    finally:
        for descent in multistart.running.values():
            descent.search.close()


def _published(space: Space, options: Options) -> Any:
    whole = nlopt.opt(nlopt.G_MLSL_LDS, space.dimension)
    whole.set_local_optimizer(_optimiser(space, options))
    whole.set_population(options.sample)
    return whole


def _optimiser(space: Space, options: Options) -> Any:
    optimiser = nlopt.opt(LIBRARY.get(options.local, nlopt.LN_BOBYQA), space.dimension)
    optimiser.set_xtol_abs(options.tolerance)
    return optimiser


class Multistart:
    """The sample, and the local searches that run, by number from 1."""

    def __init__(self, space: Space, options: Options) -> None:
        from scipy.stats import qmc  # imported late: slow to load

        self.space, self.options = space, options
        self.levels = Levels(space.dimension)
        self.sobol = qmc.Sobol(space.dimension, scramble=False)
        self.sobol.fast_forward(1)  # the first point is a corner
        self.settings = FINE
        self.running: dict[int, Descent] = {}
        self.begun = self.used = 0

    @property
    def wide(self) -> int:
        """Points up to which the sample fills a request, and local searches that may run."""
        return min(1 + self.used // (WIDER * self.space.dimension), WIDEST)

    def begin(self) -> None:
        """Begin the local searches that the rule allows."""
        for row in self.levels.starts(max(self.wide - len(self.running), 0)):
            start = self.levels.points[row].copy()
            self.begun += 1
            search = self._local(self.begun, start, float(self.levels.values[row]))
            self.running[self.begun] = Descent(start, search, start[None])
            self.advance(self.begun, None)

    def _along_gradients(self, number: int) -> bool:
        return self.options.local == "slsqp" or (self.options.local == "both" and number % 2 == 1)

    def _local(self, number: int, start: Floats, cost: float) -> Generator[Floats, Batch, End]:
        if self._along_gradients(number):
            return descend(start, self.settings)
        optimiser = _optimiser(self.space, self.options)
        optimiser.set_initial_step(STEP)
        return local(start, cost, lambda: optimiser)

    def further(self) -> Floats:
        """Further points (m, n) of the sample, if its share allows or nothing else is requested."""
        if self.levels.sampled == 0:
            return np.concatenate([np.full((1, self.space.dimension), 0.5), self.sobol.random(self.least)])
        few = sum(len(descent.requested) for descent in self.running.values())
        count = min(self.wide - few, int(SAMPLED * self.used) - self.levels.sampled)
        return np.asarray(self.sobol.random(max(count, 0) if self.running else max(self.wide, self.least)))

    @property
    def least(self) -> int:
        """The points of a round of the sample."""
        return self.options.sample or LEAST

    def advance(self, number: int, batch: Batch | None) -> None:
        """Pass a local search its values; report where it ends."""
        descent = self.running[number]
        try:
            descent.requested = next(descent.search) if batch is None else descent.search.send(batch)
        except StopIteration as ended:
            end: End = ended.value
            still = np.abs(end.point - descent.start).max() <= self.settings.difference
            if still and self.settings is FINE and self._along_gradients(number):
                self.settings = COARSE
                descent.search = self._local(number, descent.start, end.cost)
                self.advance(number, None)
                return
            del self.running[number]
            self.levels.ended(end.point, end.cost)
            self.space.report(Minimum(end.point, end.cost, descent.start, end.evaluations, end.text))

    def in_batches(self) -> Search:
        """All that is requested is evaluated before any of it continues."""
        while True:
            self.begin()
            numbers, sample = list(self.running), self.further()
            groups = [self.running[number].requested for number in numbers] + [sample]
            batch = yield np.concatenate(groups)
            self.used += len(batch.status)
            *own, sampled = batch.split([len(group) for group in groups])
            self.levels.add(sample, sampled.ranked())
            for number, values in zip(numbers, own, strict=True):
                self.advance(number, values)

    def in_slots(self) -> Parallel:
        """A local search continues when its own points have ended, the sample, which has number 0, when its have."""
        pending: dict[int, Floats] = {}
        while True:
            self.begin()
            wanted = {number: descent.requested for number, descent in self.running.items() if number not in pending}
            if 0 not in pending and len(sample := self.further()):
                wanted[0] = sample
            pending |= wanted
            request = Several(list(wanted.items()))
            batch = yield request
            points = pending.pop(request.answered)
            self.used += len(points)
            if request.answered == 0:
                self.levels.add(points, batch.ranked())
            else:
                self.advance(request.answered, batch)


method = Method(
    name="mlsl",
    title="MLSL",
    kind="global",
    how="Global. Local searches from low points of a growing sample",
    source="Rinnooy Kan and Timmer 1987, as NLopt G_MLSL_LDS",
    evaluations=2000,
    options=Options,
    search=search,
    compiles=True,
    repeats=True,
    extend=lambda options, more: options,
    family="multistart",
    whole_budget=True,
    parallel="every local search on its own",
    suits="smooth criteria with several valleys",
    look=MethodLook(colour="#9a5a44", dark="#c98d78", marker="right"),
)
