"""A campaign as a problem: from a point of the unit cube to a flight, its cost and its status.

Start reading at `Problem.fly`; the closed loop itself is `worker.kernels.loop`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from campaigns import Campaign, cube
from campaigns.asked.check import flyable
from campaigns.asked.load import Problem as Wrong
from campaigns.asked.spec import Part
from campaigns.catalogue import Role
from campaigns.results.base import EXCLUDED, FAILED, OK
from worker.catalogue.installed import catalogue, components
from worker.kernels import loop as closed_loop
from worker.kernels.component import Criterion, NoTrim
from worker.kernels.layout import Parts, Placed
from worker.search.base import Batch
from worker.systems.closed_loop.assemble import LANES, Loop
from worker.systems.closed_loop.realisations import Realisations, Seeds
from worker.systems.distributions import Distributions, Range

Floats = NDArray[np.float64]


class CampaignUnusable(ValueError):
    """The campaign cannot be run with the components of this installation; the message says why."""

    def __init__(self, problems: Sequence[Wrong]) -> None:
        self.problems = list(problems)
        super().__init__("the campaign cannot be run here: " + "; ".join(map(str, problems)))


class Problem:
    """One campaign, ready to fly; compiled flights unless `compiled` is False."""

    def __init__(self, campaign: Campaign, compiled: bool = True, lanes: int = LANES) -> None:
        problems = flyable(campaign, catalogue())
        if problems:
            raise CampaignUnusable(problems)
        self.campaign = campaign
        self.parts = _parts(campaign)
        self.loop = Loop(self.parts, lanes=lanes, compiled=compiled)
        self.realisations = Realisations.of(campaign.scenario.realisations, self.loop.sections)
        self.threshold = campaign.criterion.threshold
        self.nominal = self._nominal()
        self.ranges = self._ranges()
        self.low: Floats = np.array([r.low for r in self.ranges])
        self.high: Floats = np.array([r.high for r in self.ranges])
        self.distributions = Distributions(self.ranges, campaign.correlations)

    @property
    def dimension(self) -> int:
        return len(self.ranges)

    @property
    def step(self) -> float:
        """[s]"""
        return self.campaign.scenario.step

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
        """The flat parameter vectors (m, size) of points (m, n)."""
        vectors = np.repeat(self.nominal[None, :], len(points), axis=0)
        vectors[:, [r.index for r in self.ranges]] = self.values(points)
        return vectors

    def vector(self, values: Mapping[str, float]) -> Floats:
        """One flat parameter vector (size,) from values of any parameters by path; KeyError for an unknown one."""
        vector = self.nominal.copy()
        for path, value in values.items():
            vector[self.paths[path]] = value
        return vector

    @cached_property
    def paths(self) -> dict[str, int]:
        """Every parameter of the scenario: its place in the flat vector by path."""
        return {f"{s.prefix}.{p.name}": s.first + k for s in self.loop.sections for k, p in enumerate(s.parameters)}

    def fly(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, dict[int, str]]:
        """Fly points (m, n); the batch, and the reasons by row of those that are not ok.

        Under the campaign's realisations, or each point under the one realisation of its own: seeds (m,).
        """
        return self.fly_vectors(self.vectors(points), seeds=seeds)

    def under(self, seed: int | None) -> Problem:
        """The same problem under one realisation; itself for None, the realisations that the campaign states."""
        if seed is None:
            return self
        one = copy(self)
        one.realisations = self.realisations.only(seed)
        return one

    def fly_vectors(
        self, vectors: Floats, step: float | None = None, seeds: Seeds | None = None
    ) -> tuple[Batch, dict[int, str]]:
        """Fly flat parameter vectors (m, size), by default at the campaign's step [s]; seeds as in `fly`."""
        if seeds is not None:
            step = self.step if step is None else step
            flown = self.loop.fly(self.realisations.flight(vectors, seeds), step, *self.counts(step))
            status, reasons = self.judge(flown.status, flown.when)
            return Batch(flown.costs, status), {i: f"with seed {seeds[i]}: {why}" for i, why in reasons.items()}
        return self.fly_realised(vectors, step)[:2]

    def fly_realised(
        self, vectors: Floats, step: float | None = None
    ) -> tuple[Batch, dict[int, str], list[int] | None]:
        """As `fly_vectors`, and by row the seed of the realisation that counts; None where the mean of several does."""
        step, realised = self.step if step is None else step, self.realisations
        flown = self.loop.fly(realised.flights(vectors), step, *self.counts(step))
        status, reasons = self.judge(flown.status, flown.when)
        seeds = realised.counting(flown.costs, status) if realised.combine == "worst" or not realised.several else None
        return *realised.combined(flown.costs, status, reasons), seeds

    def counts(self, step: float) -> tuple[int, int]:
        """Steps in the horizon, and steps per guidance sample."""
        scenario = self.campaign.scenario
        return round(scenario.horizon / step), max(1, round(scenario.guidance.period / step))

    @property
    def criteria(self) -> tuple[Criterion, ...]:
        """All criteria in the order of a batch's columns, the one that decides first."""
        return tuple(self.parts.criteria.values())

    def judge(self, codes: Floats, when: Floats) -> tuple[NDArray[np.uint8], dict[int, str]]:
        """The loop's codes as evaluation status, with the reason of each that is not ok."""
        status = np.full(len(codes), FAILED, dtype=np.uint8)
        status[codes == closed_loop.OK] = OK
        status[codes == closed_loop.EXCLUDED] = EXCLUDED
        reasons = {int(i): self._reason(float(codes[i]), float(when[i])) for i in np.flatnonzero(status != OK)}
        return status, reasons

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

    def _reason(self, code: float, when: float) -> str:
        if code == closed_loop.EXCLUDED:
            return (
                f"the flight starts with {self.parts.criterion.quantity} at or below the threshold of "
                f"{self.threshold:g} {self.parts.criterion.unit}: nothing can be shown of it"
            )
        if code == closed_loop.NOT_FINITE:
            return (
                f"the flight diverged: its state was beyond {closed_loop.LARGEST:.0e} or no number at t = {when:.6g} s"
            )
        limit = self.parts.vehicle.limits[int(code - closed_loop.OUTSIDE)]
        return f"the flight left the model's envelope at t = {when:.6g} s: {limit.text}"

    def _nominal(self) -> Floats:
        scenario, given = self.campaign.scenario, {}
        given["vehicle"] = scenario.vehicle.parameters
        given["controller"] = scenario.controller.parameters
        given["avoider"] = scenario.avoider.parameters
        given["start"], given["goal"] = scenario.start, scenario.goal
        given["criterion"] = {**self.campaign.criterion.parameters, "threshold": self.threshold}
        # A further criterion has no threshold; where its component knows one, it is not looked at.
        for i, objective in enumerate(self.campaign.objectives):
            given[f"objectives.{i}"] = {"threshold": 0.0, **objective.parameters}
        for name in ("obstacles", "environment", "faults"):
            given |= {f"{name}.{i}": part.parameters for i, part in enumerate(getattr(scenario, name))}
        named = {f"{s.prefix}.{p.name}": _nominal(p, given[s.prefix]) for s in self.loop.sections for p in s.parameters}
        trim = self.parts.vehicle.trim
        try:
            return np.array([*named.values(), *(trim.solve(named) if trim else ())])
        except NoTrim as error:
            raise CampaignUnusable([Wrong("scenario.vehicle", self.parts.vehicle.name, str(error))]) from None

    def _ranges(self) -> tuple[Range, ...]:
        ranges = []
        for path, uncertain in self.campaign.uncertain.items():
            index = self.paths[path]
            nominal = float(self.nominal[index])
            ranges.append(Range(path, index, *uncertain.interval(nominal), nominal, uncertain.distribution))
        return tuple(ranges)


def _parts(campaign: Campaign) -> Parts:
    """The components that a checked campaign names."""
    scenario, known = campaign.scenario, components()
    vehicle: Any = known["vehicle", scenario.vehicle.component]
    inputs = [s.name for s in vehicle.inputs]

    def several(role: Role, parts: Sequence[Part]) -> tuple[Any, ...]:
        return tuple(known[role, part.component] for part in parts)

    return Parts(
        vehicle,
        several("controller", [scenario.controller])[0],
        several("avoider", [scenario.avoider])[0],
        several("obstacle", scenario.obstacles),
        known["criterion", campaign.criterion.component],  # type: ignore[arg-type]
        several("environment", scenario.environment),
        tuple(
            Placed(fault, inputs.index(part.on) if part.on else 0)
            for fault, part in zip(several("fault", scenario.faults), scenario.faults, strict=True)
        ),
        sampled=scenario.guidance.period > 0,
        objectives=several("criterion", campaign.objectives),
    )


def _nominal(parameter: Any, given: Mapping[str, float]) -> float:
    value = given.get(parameter.name, parameter.default)
    assert value is not None, f"{parameter.name} is required; check() says so"
    return float(value)


__all__ = ["CampaignUnusable", "Floats", "Problem", "Range"]
