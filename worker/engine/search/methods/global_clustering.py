"""GLOBAL: samples, selects the best points, clusters them, and starts a local search from every unclustered one.

Boender, Rinnooy Kan, Timmer, Stougie, A stochastic method for global optimization (Math. Programming 22, 1982);
Csendes, Nonlinear parameter estimation by global optimization (Acta Cybernetica 8, 1988), whose rules are used;
Csendes, Pal, Sendin, Banga, The GLOBAL optimization method revisited (Optimization Letters 2, 2008). Single linkage in
the maximum norm with critical distance b = (1 - alpha^(1/(N-1)))^(1/n), alpha = 0.01, N points sampled so far, on a box
of side 2. A cycle that finds no new minimum ends it: the probability that all are known grows, but is never 1. It then
begins again with a new sample until the budget ends; the published one stops (`as_published`).
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from worker.engine.search.base import (
    Batch,
    Ended,
    Floats,
    Method,
    MethodLook,
    Minimum,
    Parallel,
    Search,
    Several,
    Space,
    side_by_side,
)
from worker.engine.search.parts.descent import End, Settings, descend
from worker.engine.search.parts.unirandi import unirandi

ALPHA = 0.01
ALONE = -1
PUBLISHED_MINIMA = 50
IN_VAIN = 10
"""Consecutive cycles without a single value after which it stops."""


@dataclass(frozen=True)
class Options:
    """The six parameters as published; zero selects the published default, which depends on the dimension n."""

    samples: Annotated[int, Field(ge=0, le=100_000, description="Points drawn in a cycle (N100); 0: 10 n")] = 0
    selected: Annotated[
        int,
        Field(ge=0, le=1000, description="Best points a cycle adds to the clustered ones (NG0); 0: 2 n, at most 20"),
    ] = 0
    digits: Annotated[int, Field(ge=1, le=12, description="Accuracy of a local search, in digits (NSIG)")] = 6
    local_evaluations: Annotated[
        int, Field(ge=0, le=10_000_000, description="Maximum evaluations of a local search (MAXFN); 0: 100 n")
    ] = 0
    minima: Annotated[
        int, Field(ge=0, le=100_000, description="Stop at this number of local minima (MAXNLM); 0: 50, or no such stop")
    ] = 0
    local: Literal["unirandi", "bfgs"] = "unirandi"
    at_once: Annotated[
        bool, Field(description="Run a cycle's local searches side by side: more of them, in larger batches")
    ] = False
    as_published: Annotated[
        bool, Field(description="Stop at 50 minima and after a cycle without a new one, as published")
    ] = False

    @property
    def most(self) -> float:
        """The number of minima at which it stops."""
        return self.minima or (PUBLISHED_MINIMA if self.as_published else np.inf)


@dataclass
class Found:
    """A local minimum, and the points from which other searches ended at it: the seeds that points cluster to."""

    point: Floats
    cost: float
    seeds: list[tuple[Floats, float]] = field(default_factory=list)


@dataclass
class Sample:
    """The best points so far, lowest first: points (m, n), costs (m,), the cluster of each or ALONE (m,)."""

    points: Floats
    costs: Floats
    cluster: NDArray[np.int64]

    def add(self, points: Floats, costs: Floats) -> None:
        """Add the points that have a value."""
        costs = np.concatenate([self.costs, costs[np.isfinite(costs)]])
        points = np.concatenate([self.points, points])
        cluster = np.concatenate([self.cluster, np.full(len(costs) - len(self.cluster), ALONE)])
        order = np.argsort(costs, kind="stable")
        self.points, self.costs, self.cluster = points[order], costs[order], cluster[order]

    def at(self, i: int) -> tuple[Floats, float]:
        return self.points[i].copy(), float(self.costs[i])


@dataclass
class Clusters:
    """The state of a cycle: the sample, the number of clustered points, the minima, the critical distance."""

    sample: Sample
    reduced: int
    minima: list[Found]
    distance: float

    def grow(self, label: int, point: Floats, cost: float) -> None:
        """Single linkage: every lone point near a lower point of the cluster joins it, transitively."""
        sample, queue = self.sample, [(point, cost)]
        points, costs, cluster = (a[: self.reduced] for a in (sample.points, sample.costs, sample.cluster))
        while queue:
            point, cost = queue.pop(0)
            near = (cluster == ALONE) & (costs > cost)
            near[near] = np.abs(points[near] - point).max(axis=1) < self.distance
            cluster[near] = label
            queue += [(points[i], float(costs[i])) for i in np.flatnonzero(near)]

    def grow_all(self) -> None:
        """Grow all clusters: from minima and their members first, then from seeds."""
        sample = self.sample
        for label, found in enumerate(self.minima):
            members = np.flatnonzero(sample.cluster[: self.reduced] == label)
            self.grow(label, found.point, found.cost)
            for i in members:
                self.grow(label, *sample.at(int(i)))
        for label, found in enumerate(self.minima):
            for point, cost in found.seeds:
                self.grow(label, point, cost)

    def is_alone(self, i: int) -> bool:
        return bool(self.sample.cluster[i] == ALONE)

    def alone(self) -> list[int]:
        return [int(i) for i in np.flatnonzero(self.sample.cluster[: self.reduced] == ALONE)]


def search(space: Space, options: Options) -> Parallel:
    """Cycles of one request for the sample and then the local searches, one after another."""
    n = space.dimension
    samples, selected = options.samples or 10 * n, options.selected or min(2 * n, 20)
    sample = Sample(np.empty((0, n)), np.empty(0), np.empty(0, dtype=np.int64))
    minima: list[Found] = []
    vain = cycles = 0
    while True:
        cycles += 1
        points = space.random.random((samples, n))
        batch = yield points.copy()
        costs = batch.ranked()
        sample.add(points[np.isfinite(costs)], costs)
        if len(sample.costs) == 0:
            vain += 1
            if vain == IN_VAIN:
                return Ended("no value", "no point of {points} had a value", points=vain * samples)
            continue
        clusters = Clusters(
            sample, min(selected * cycles, len(sample.costs)), minima, critical_distance(samples * cycles, n)
        )
        clusters.grow_all()
        known = len(minima)
        yield from _search_locally(space, options, clusters)
        if len(minima) >= options.most:
            return Ended("found", "found the requested {minima} local minima", minima=len(minima))
        if len(minima) > known:
            continue
        if options.as_published:
            return Ended(
                "exhausted",
                "found no new local minimum in cycle {cycle}; {minima} are known",
                cycle=cycles,
                minima=known,
            )
        sample, cycles = Sample(np.empty((0, n)), np.empty(0), np.empty(0, dtype=np.int64)), 0


def critical_distance(sampled: int, dimension: int) -> float:
    """The distance in the unit cube within which points belong together: half of that on a box of side 2."""
    return 0.5 * float((1.0 - ALPHA ** (1.0 / max(sampled - 1, 1))) ** (1.0 / dimension))


def _search_locally(space: Space, options: Options, clusters: Clusters) -> Generator[Floats | Several, Batch, None]:
    """Search from the lone points, lowest first; a point that joins a cluster meanwhile is skipped or abandoned."""
    if options.at_once:
        searches = [_while_alone(space, options, clusters, i) for i in clusters.alone()]
        yield from side_by_side(searches, in_slots=bool(space.slots))
        return
    for i in clusters.alone():
        if clusters.is_alone(i) and len(clusters.minima) < options.most:
            end = yield from _local(space, options, *clusters.sample.at(i))
            _settle(space, options, clusters, i, end)


def _while_alone(space: Space, options: Options, clusters: Clusters, i: int) -> Search:
    local = _local(space, options, *clusters.sample.at(i))
    try:
        points = next(local)
        while clusters.is_alone(i):
            points = local.send((yield points))
    except StopIteration as ended:
        _settle(space, options, clusters, i, ended.value)
    finally:
        local.close()
    return ""


def _settle(space: Space, options: Options, clusters: Clusters, i: int, end: End) -> None:
    """Add the end of the search from point i if it is a new minimum, and cluster to it, otherwise to its start."""
    start, cost = clusters.sample.at(i)
    label = next((k for k, m in enumerate(clusters.minima) if _same(m.point, end.point, clusters.distance)), None)
    if label is None:
        label = len(clusters.minima)
        clusters.minima.append(Found(end.point, end.cost))
        lower = True
        seed = (end.point, end.cost)
    else:
        known = clusters.minima[label]
        lower = known.cost - end.cost > 10.0**-options.digits * max(abs(known.cost), cost - end.cost)
        if end.cost < known.cost:
            known.point, known.cost = end.point, end.cost
        known.seeds.append((start, cost))
        seed = (start, cost)
    if lower:
        space.report(Minimum(end.point.copy(), end.cost, start, end.evaluations, end.text))
    clusters.sample.cluster[i] = label
    clusters.grow(label, *seed)


def _same(one: Floats, other: Floats, distance: float) -> bool:
    """Ends nearer than a tenth of the critical distance are one minimum."""
    return bool(np.abs(one - other).max() < 0.1 * distance)


def _local(space: Space, options: Options, start: Floats, cost: float) -> Generator[Floats, Batch, End]:
    """A local search from a start of known cost; it never ends above it."""
    tolerance, most = 10.0**-options.digits, options.local_evaluations or 100 * len(start)
    if options.local == "unirandi":
        random = np.random.default_rng(space.random.integers(2**63))
        return (yield from unirandi(random, start, cost, tolerance, most))
    end = yield from descend(start, Settings(library="bfgs", cost_tolerance=tolerance, iterations=10_000, most=most))
    return end if end.cost < cost else End(start, cost, end.evaluations, end.text)


method = Method(
    name="global_clustering",
    title="GLOBAL",
    kind="global",
    how="Global, random. Clusters samples, searches from each cluster",
    source="Boender et al. 1982, Csendes et al. 2008",
    evaluations=5000,
    options=Options,
    search=search,
    repeats=True,
    family="multistart",
    whole_budget=True,
    own_rule="as_published minima",
    extend=lambda options, more: replace(options, minima=0, as_published=False),
    parallel="every local search on its own",
    suits="a list of all valleys",
    drawback="Of the targets of BBOB in 5 dimensions it reaches 0.32 at 1,000 n, CMA-ES 0.68",
    look=MethodLook(colour="#857c00", dark="#d8cd3c", marker="hexagon"),
)
