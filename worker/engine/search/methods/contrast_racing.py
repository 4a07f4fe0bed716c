"""Contrast racing: local searches from points that are low for their neighbourhood, raced against each other.

The project's own method, for worst cases in basins a thousandth of a range wide. The start of a local search
matters more than its kind: starts are ranked by their value less the median of the nearest sample points, not by the
value alone, which is misled by wide decoys. The searches race by successive halving (Li et al. 2020): each gets a few
evaluations, the best third of those finished so far three times as many, and so on. A quarter of the starts are hops:
recombined and mutated incumbents. The last fifth of the budget merges incumbents without a barrier between them into
valleys and polishes the best. No guarantee. Its points depend on its budget, so it cannot be extended.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from worker.engine.search.base import Batch, Floats, Method, MethodLook, Search, Space
from worker.engine.search.racing import finish as racing_finish
from worker.engine.search.racing.pool import Pool, Rung
from worker.engine.search.racing.samples import Samples
from worker.engine.search.racing.state import CMA, COMPASS, NELDER_MEAD

KINDS = ((COMPASS, 0.1, 0.03), (COMPASS, 0.1, 0.03), (NELDER_MEAD, 0.1, 0.03), (CMA, 0.2, 0.2))
"""Machine, its first step, and the deviation of the CMA-ES that follows it; drawn at random."""
ETA = 3
HOPPING = 10
"""The number of best incumbents that hops combine."""

Steps = Generator[Floats, Batch, None]


@dataclass(frozen=True)
class Options:
    """Counts are per parameter; distances are fractions of each parameter's range (largest difference)."""

    first: Annotated[int, Field(ge=1, le=1000, description="Evaluations of a search before its first comparison")] = 10
    sample: Annotated[int, Field(ge=1, le=100_000, description="First sample, at most a tenth of the budget")] = 100
    fresh: Annotated[int, Field(ge=1, le=1000, description="Further sample points per start")] = 5
    neighbours: Annotated[int, Field(ge=1, le=50, description="Neighbours for the contrast")] = 2
    apart: Annotated[float, Field(gt=0, le=0.5, description="Least distance of a start from earlier ones")] = 0.05
    hops: Annotated[float, Field(ge=0, le=1, description="Fraction of starts that are hops")] = 0.25
    reserve: Annotated[float, Field(ge=0, le=0.9, description="Fraction of the budget reserved for the finish")] = 0.35
    hill: Annotated[
        float, Field(ge=0, le=1, description="Height of a barrier, relative to the sample's median less the best")
    ] = 0.05
    polished: Annotated[int, Field(ge=1, le=100, description="Valleys polished at the end")] = 3
    abreast: Annotated[int, Field(ge=1, le=1024, description="Searches advanced side by side")] = 8


def search(space: Space, options: Options) -> Search:
    """Race, then finish; if called beyond its budget, repeat with twice the budget."""
    race = Race(space, options)
    finish = racing_finish.Finish(race.pool)
    total = space.budget
    try:
        yield from race.sample(min(options.sample * space.dimension, total // 10))
        while True:
            yield from race.run(int((1.0 - options.reserve) * total))
            race.used += yield from finish.run(race.used, total, race.samples, options)
            total *= 2
    finally:
        finish.report(space)


class Race:
    """The samples, the searchers, their rungs, and the evaluations used so far."""

    def __init__(self, space: Space, options: Options) -> None:
        n = space.dimension
        self.dimension, self.options, self.random = n, options, space.random
        self.samples = Samples(n, options.neighbours * n, options.apart, space.random)
        self.pool = Pool(n, space.random)
        self.rungs: list[Rung] = [Rung()]
        self.used = self.hops = self.picks = 0
        self.running: list[int] = []
        self.openings: list[Opening] = []

    def sample(self, count: int) -> Steps:
        """Draw the first sample: `count` points with a value, at least 10 per parameter."""
        count = max(count, 10 * self.dimension)
        while self.samples.count < count:
            points = self.samples.draw(count - self.samples.count)
            batch = yield points.copy()
            self.used += len(points)
            self.samples.add(points, batch.ranked())

    def run(self, until: int) -> Steps:
        """Race until `until` evaluations are used in total."""
        while self.used < until:
            self._fill()
            rows = np.array(self.running, dtype=np.int64)
            blocks = [opening.points for opening in self.openings]
            points = np.concatenate([*blocks, self.pool.requested(rows)])
            batch = yield points.copy()
            values = batch.ranked()
            self.used += len(points)
            opened = sum(map(len, blocks))
            self.pool.tell(rows, values[opened:])
            self.running = [t for t in self.running if not self._arrived(t)]
            self._open(values)

    def _fill(self) -> None:
        """Promote searchers, top rung first, or start new ones, up to the number of concurrent searches.

        That number is small at first: the more searches are running, the fewer results the next start can use.
        """
        while len(self.running) + len(self.openings) < min(self.options.abreast, 2 + self.pool.count // 8):
            promoted = self._promoted()
            if promoted is not None:
                self.running.append(promoted)
            else:
                self.openings.append(self._opening())

    def _promoted(self) -> int | None:
        for k in reversed(range(len(self.rungs))):
            t = self.rungs[k].next(ETA, self.pool)
            if t is not None:
                self.pool.rung[t] = k + 1
                return t
        return None

    def _arrived(self, t: int) -> bool:
        """Whether searcher t has used the evaluations of its rung; it then waits there."""
        k = int(self.pool.rung[t])
        if self.pool.state.evaluations[t] < self.options.first * self.dimension * ETA**k:
            return False
        while len(self.rungs) <= k:
            self.rungs.append(Rung())
        self.rungs[k].add(t, float(self.pool.cost[t]))
        return True

    def _opening(self) -> Opening:
        starts = self.pool.count + len(self.openings)
        if len(self.rungs) > 1 and len(self.rungs[1].costs) >= 2 and self.hops < self.options.hops * starts:
            self.hops += 1
            return Opening(hops(self.pool, 2 * self.dimension, self.random), hop=True)
        return Opening(self.samples.draw(self.options.fresh * self.dimension), hop=False)

    def _open(self, values: Floats) -> None:
        """Start a search from each opening, given their values at the beginning of `values`."""
        openings, self.openings = self.openings, []
        at = 0
        for opening in openings:
            came = values[at : at + len(opening.points)]
            at += len(opening.points)
            if opening.hop:
                low = int(np.argmin(came))
                start = (opening.points[low], float(came[low])) if np.isfinite(came[low]) else None
            else:
                self.samples.add(opening.points, came)
                start = self.samples.start(by_contrast=self.picks % 3 < 2)
                self.picks += 1
            if start is not None:
                kind, first, after = KINDS[self.random.integers(len(KINDS))]
                self.running.append(self.pool.begin(*start, start[0], kind, first, after, rung=0))


@dataclass(frozen=True)
class Opening:
    """Points whose values decide where the next search starts: candidates of a hop, or further sample points."""

    points: Floats
    hop: bool


def hops(pool: Pool, count: int, random: np.random.Generator) -> Floats:
    """Candidates (count, n) from the best incumbents: differences of two added to another, or a mutation of one."""
    elite = pool.best[pool.apart(HOPPING)]
    n = elite.shape[1]
    made = np.empty((count, n))
    for row in made:
        if len(elite) > 1 and random.random() < 0.5:
            base = elite[random.integers(min(3, len(elite)))]
            a, b, c = elite[random.integers(len(elite), size=3)]
            moved = a + random.uniform(0.3, 1.0) * (b - c)
            bound = np.where(moved < 0.0, 0.0, 1.0)
            moved = np.where((moved < 0.0) | (moved > 1.0), 0.5 * (base + bound), moved)
            row[:] = np.where(_some(n, random.choice([0.2, 0.5, 0.9]), random), moved, base)
        else:
            base = elite[min(int(random.geometric(0.4)), len(elite)) - 1]
            size = np.exp(random.uniform(np.log(0.01), np.log(0.3)))
            some = _some(n, random.choice([1.0 / n, 0.5, 1.0]), random)
            row[:] = np.clip(base + some * random.standard_normal(n) * size, 0.0, 1.0)
    return made


def _some(n: int, fraction: float, random: np.random.Generator) -> np.ndarray:
    """A random subset of the parameters, never empty."""
    chosen = random.random(n) < fraction
    chosen[random.integers(n)] |= not chosen.any()
    return chosen


method = Method(
    name="contrast_racing",
    title="Contrast racing",
    kind="global",
    how="Global. Races local searches from well-chosen starts",
    source="Clearance 2026",
    evaluations=5000,
    options=Options,
    search=search,
    compiles=True,
    family="racing of descents",
    whole_budget=True,
    parallel="a round of the race",
    suits="several valleys, cheap evaluations",
    look=MethodLook(colour="#5a2fe0", dark="#a07cff", marker="star", short="Racing"),
)
