"""Simulates a campaign's closed loop: flat parameter vectors in, costs, status and reasons out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from campaigns import Campaign
from campaigns.catalogue import RateEntry
from campaigns.checked.check import simulation_problems
from campaigns.checked.rates import ends, fastest
from campaigns.limits import TURN
from campaigns.results.base import EXCLUDED, FAILED, OK
from worker.engine.kernels import loop as closed_loop
from worker.engine.search.base import Batch
from worker.engine.systems.base import CampaignUnusable, Floats, Reasons, Result, Seeds, with_values
from worker.engine.systems.closed_loop.assemble import LANES, shared
from worker.engine.systems.closed_loop.parts import Installed, nominal_of, parts_of, results_of
from worker.engine.systems.closed_loop.realisations import Realisations


class Flights:
    """The closed loop of one campaign, ready to simulate; in plain Python if `compiled` is False."""

    def __init__(self, campaign: Campaign, installed: Installed, compiled: bool = True, lanes: int = LANES) -> None:
        problems = simulation_problems(campaign, installed.catalogue)
        if problems:
            raise CampaignUnusable(problems)
        self.campaign, self.installed = campaign, installed
        self.parts = parts_of(campaign, installed.components)
        self.loop = shared(self.parts, lanes, compiled)
        self.realisations = Realisations.of(campaign.given_scenario.realisations, self.loop.sections)
        self.threshold = campaign.criterion.threshold
        self.nominal = nominal_of(campaign, self.parts, self.loop.sections)
        self.results: tuple[Result, ...] = results_of(self.parts)

    @property
    def step(self) -> float:
        """The time step [s]."""
        return self.campaign.given_scenario.step

    def vector(self, values: Mapping[str, float]) -> Floats:
        """One flat parameter vector (size,) from values of any parameters by path; KeyError for an unknown one."""
        return with_values(self.nominal, self.paths, values)

    @cached_property
    def paths(self) -> dict[str, int]:
        """The index in the flat vector of every parameter of the scenario, by path."""
        return {f"{s.prefix}.{p.name}": s.first + k for s in self.loop.sections for k, p in enumerate(s.parameters)}

    def under(self, seed: int | None) -> Self:
        """The closed loop under one realisation; itself, with the campaign's realisations, for None."""
        if seed is None:
            return self
        one = copy(self)
        one.realisations = self.realisations.only(seed)
        return one

    def simulate_vectors(
        self, vectors: Floats, step: float | None = None, seeds: Seeds | None = None
    ) -> tuple[Batch, Reasons]:
        """Simulate flat parameter vectors (m, size), by default at the campaign's step [s].

        By default under the realisations that the campaign states; with seeds (m,), each vector under its own.
        """
        if seeds is not None:
            step = self.step if step is None else step
            made = self.loop.simulate(self.realisations.flight(vectors, seeds), step, *self.counts(step))
            status, reasons = self.judge(made.status, made.when)
            return Batch(made.costs, status), {i: f"with seed {seeds[i]}: {why}" for i, why in reasons.items()}
        return self.simulate_realised(vectors, step)[:2]

    def simulate_realised(self, vectors: Floats, step: float | None = None) -> tuple[Batch, Reasons, list[int] | None]:
        """Simulate as `simulate_vectors` does; also returns the deciding realisation's seed by row; None if the mean of
        several counts."""
        step, realised = self.step if step is None else step, self.realisations
        made = self.loop.simulate(realised.flights(vectors), step, *self.counts(step))
        status, reasons = self.judge(made.status, made.when)
        seeds = realised.counting(made.costs, status) if realised.combine == "worst" or not realised.several else None
        return *realised.combined(made.costs, status, reasons), seeds

    def counts(self, step: float) -> tuple[int, int]:
        """The numbers of steps in the horizon and per guidance sample."""
        scenario = self.campaign.given_scenario
        return round(scenario.horizon / step), max(1, round(scenario.guidance.period / step))

    def look(self, p: Sequence[float]) -> float:
        """The longest interval between two looks that follow every obstacle [s], with these parameters."""
        highest = max((fastest(rate, values) for _, rate, values in self._rates(p)), default=0.0)
        return TURN / highest if highest > 0.0 else np.inf

    def turns(self, p: Sequence[float]) -> set[float]:
        """The instants at which obstacles on straight legs turn or stop [s], with these extended parameters."""
        found: set[float] = set()
        for i, rate, values in self._rates(p):
            declared = self.parts.obstacles[i].rate
            if declared is not None and declared.stops:
                at = self.loop.extended[f"obstacles.{i}"]
                found.add(getattr(at.fields(*p[at.first : at.last]), declared.stops))
            else:
                found.update(ends(rate, values))
        return found

    def _rates(self, p: Sequence[float]) -> Iterator[tuple[int, RateEntry, dict[str, tuple[float, float]]]]:
        """The number of each obstacle that declares a rate, its rate, and the values of its parameters as intervals."""
        for i, obstacle in enumerate(self.parts.obstacles):
            entry = self.installed.catalogue.component("obstacle", obstacle.name)
            if entry is not None and entry.rate is not None:
                values = {q.name: p[self.paths[f"obstacles.{i}.{q.name}"]] for q in entry.parameters}
                yield i, entry.rate, {name: (v, v) for name, v in values.items()}

    def judge(self, codes: Floats, when: Floats) -> tuple[NDArray[np.uint8], dict[int, str]]:
        """The loop's codes as evaluation status, with the reason of every failed or excluded one."""
        status = np.full(len(codes), FAILED, dtype=np.uint8)
        status[codes == closed_loop.OK] = OK
        status[codes == closed_loop.EXCLUDED] = EXCLUDED
        reasons = {int(i): self._reason(float(codes[i]), float(when[i])) for i in np.flatnonzero(status != OK)}
        return status, reasons

    @property
    def own_rule(self) -> bool:
        """Whether the criterion excludes flights at their start by another rule than its threshold."""
        entry = self.installed.catalogue.component("criterion", self.parts.criterion.name)
        return entry is not None and entry.own_rule

    def _reason(self, code: float, when: float) -> str:
        if code == closed_loop.EXCLUDED and self.own_rule:
            return f"excluded at the start by the criterion's own rule for {self.parts.criterion.quantity}"
        if code == closed_loop.EXCLUDED:
            return (
                f"{self.parts.criterion.quantity} starts at or below the threshold of "
                f"{repr(self.threshold).removesuffix('.0')} {self.parts.criterion.unit}, so avoidance cannot be tested"
            )
        if code == closed_loop.NOT_FINITE:
            return (
                f"the simulation diverged: the state was non-finite or above {closed_loop.LARGEST:.0e} "
                f"at t = {when:.6g} s"
            )
        limit = self.parts.vehicle.limits[int(code - closed_loop.OUTSIDE)]
        return f"the vehicle left the model's envelope at t = {when:.6g} s: {limit.text}"
