"""A campaign as a problem: from a point of the unit cube to the values of its parameters, whatever evaluates them.

What is evaluated is a `System`; nothing of it is known here but its parameters and results. Start reading at `Problem`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Literal

import numpy as np

from campaigns import Campaign, cube
from campaigns.claims.say import Part, symbol
from campaigns.symbols import labels
from worker.problem.distributions import Distributions, Range
from worker.search.base import Batch
from worker.systems.base import Floats, Realised, Reasons, Result, Seeds, System, Words


class Problem:
    """One campaign with what evaluates it."""

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
        """All criteria in the order of a batch's columns, the one that decides first."""
        return self.system.results

    @property
    def quantity(self) -> str:
        """What the criterion that decides measures, such as d_min."""
        return self.results[0].quantity

    @property
    def unit(self) -> str:
        """Of that quantity."""
        return self.results[0].unit

    @property
    def realisations(self) -> Realised:
        """Of the system's noise: those that every evaluation simulates."""
        return self.system.realisations

    @property
    def words(self) -> Words:
        """How sentences speak of its evaluations."""
        return self.system.words

    @cached_property
    def nominal_point(self) -> Floats:
        """The nominal values on the unit cube (n,)."""
        return self.point({r.path: r.nominal for r in self.ranges})

    def point(self, values: Mapping[str, float]) -> Floats:
        """Parameter values by path as a point of the unit cube (n,); what is left out is nominal."""
        return cube.share(np.array([values.get(r.path, r.nominal) for r in self.ranges]), self.low, self.high)

    def values(self, points: Floats) -> Floats:
        """Points of the unit cube (m, n) in the parameters' units; 0 and 1 give the bounds exactly."""
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
        vector = self.system.nominal.copy()
        for path, value in values.items():
            vector[self.paths[path]] = value
        return vector

    @cached_property
    def paths(self) -> dict[str, int]:
        """Every parameter of the system: its index in a vector by path."""
        return self.system.names

    def fly(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        """Evaluate points (m, n) in this thread; the batch, and the reasons by row of those that are not ok.

        Under the campaign's realisations, or each point under the one realisation of its own: seeds (m,).
        """
        return self.system.evaluate(self.vectors(points), seeds)

    @cached_property
    def signs(self) -> dict[str, Part]:
        """The uncertain parameters in sentences: each by its path, with its symbol where no other one has it."""
        symbols = {p.path: p.symbol or p.path.rpartition(".")[2] for p in self.system.parameters}
        return {path: symbol(path, label) for path, label in labels(self.campaign.uncertain, symbols).items()}

    def quantile(self, uniform: Floats) -> Floats:
        """Numbers (m, n) uniform on [0, 1) as points drawn from the campaign's distributions."""
        return self.distributions.quantile(uniform)

    def at_bounds(self, point: Floats) -> dict[str, Literal["low", "high"]]:
        """Which parameters are at a bound."""
        near = 1e-9
        found: dict[str, Literal["low", "high"]] = {}
        for r, u in zip(self.ranges, point, strict=True):
            if u <= near or u >= 1 - near:
                found[r.path] = "low" if u <= near else "high"
        return found


def _ranges(campaign: Campaign, system: System) -> tuple[Range, ...]:
    ranges, at = [], system.names
    for path, uncertain in campaign.uncertain.items():
        nominal = float(system.nominal[at[path]])
        ranges.append(Range(path, at[path], *uncertain.interval(nominal), nominal, uncertain.distribution))
    return tuple(ranges)
