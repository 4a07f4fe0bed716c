"""A campaign as a problem: maps points of the unit cube to parameter values and evaluates them.

The evaluated `System` is used only through its parameters and results.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Literal

import numpy as np

from campaigns import Campaign, cube
from campaigns.claims.say import Part, symbol
from campaigns.symbols import labels
from worker.engine.problem.distributions import Distributions, Range
from worker.engine.search.base import Batch
from worker.engine.systems import optional
from worker.engine.systems.base import Floats, Realised, Reasons, Result, Seeds, System, indices, with_values


class Problem:
    """One campaign and the system that evaluates it."""

    def __init__(self, campaign: Campaign, system: System) -> None:
        self.campaign = campaign
        self.system = system
        self.threshold = campaign.criterion.threshold
        self.ranges = _ranges(campaign, system)
        self.low: Floats = np.array([r.low for r in self.ranges])
        self.high: Floats = np.array([r.high for r in self.ranges])
        self.distributions = Distributions(self.ranges, campaign.correlations)

    @property
    def dimension(self) -> int:
        return len(self.ranges)

    @property
    def results(self) -> tuple[Result, ...]:
        """All criteria in the order of a batch's columns, the deciding one first."""
        return self.system.results

    @property
    def quantity(self) -> str:
        """The quantity of the deciding criterion, such as d_min."""
        return self.results[0].quantity

    @property
    def unit(self) -> str:
        """The unit of that quantity."""
        return self.results[0].unit

    @property
    def realisations(self) -> Realised:
        """The realisations of the system's noise that every evaluation simulates."""
        return optional.realisations(self.system)

    @cached_property
    def nominal_point(self) -> Floats:
        """The nominal values as a point of the unit cube (n,)."""
        return self.point({r.path: r.nominal for r in self.ranges})

    def point(self, values: Mapping[str, float]) -> Floats:
        """Parameter values by path as a point of the unit cube (n,); missing parameters are nominal."""
        return cube.share(np.array([values.get(r.path, r.nominal) for r in self.ranges]), self.low, self.high)

    def values(self, points: Floats) -> Floats:
        """Points of the unit cube (m, n) in the parameters' units; 0 and 1 map exactly to the bounds."""
        return cube.natural(points, [r.nominal for r in self.ranges], self.low, self.high)

    def named(self, point: Floats) -> dict[str, float]:
        """One point (n,) as values by path."""
        return {r.path: float(v) for r, v in zip(self.ranges, self.values(point[None, :])[0], strict=True)}

    def vectors(self, points: Floats) -> Floats:
        """The system's vectors (m, size) of points (m, n)."""
        vectors = np.repeat(self.system.nominal[None, :], len(points), axis=0)
        vectors[:, [r.index for r in self.ranges]] = self.values(points)
        return vectors

    def vector(self, values: Mapping[str, float]) -> Floats:
        """One vector (size,) from values of any parameters by path; KeyError for an unknown one."""
        return with_values(self.system.nominal, self.paths, values)

    @cached_property
    def paths(self) -> dict[str, int]:
        """The index in a vector of every parameter of the system, by path."""
        return indices(self.system.parameters)

    def evaluate(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        """Evaluate points (m, n) in this thread; the batch, and the reasons by row of failed or excluded evaluations.

        By default under the campaign's realisations; with seeds (m,), each point under its own realisation.
        """
        return self.system.evaluate(self.vectors(points), seeds)

    @cached_property
    def symbols(self) -> dict[str, Part]:
        """The uncertain parameters for use in sentences, by path; shown by symbol if that is unique."""
        plain = {p.path: p.symbol for p in self.system.parameters}
        return {path: symbol(path, label) for path, label in labels(self.campaign.uncertain, plain).items()}

    def quantile(self, uniform: Floats) -> Floats:
        """Uniform samples (m, n) as points drawn from the campaign's distributions."""
        return self.distributions.quantile(uniform)

    def at_bounds(self, point: Floats) -> dict[str, Literal["low", "high"]]:
        """The parameters of a point that are at a bound, by path."""
        near = 1e-9
        found: dict[str, Literal["low", "high"]] = {}
        for r, u in zip(self.ranges, point, strict=True):
            if u <= near or u >= 1 - near:
                found[r.path] = "low" if u <= near else "high"
        return found


def _ranges(campaign: Campaign, system: System) -> tuple[Range, ...]:
    ranges, at = [], indices(system.parameters)
    for path, uncertain in campaign.uncertain.items():
        nominal = float(system.nominal[at[path]])
        ranges.append(Range(path, at[path], *uncertain.interval(nominal), nominal, uncertain.distribution))
    return tuple(ranges)
