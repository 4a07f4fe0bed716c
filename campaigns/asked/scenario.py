"""The closed loop of a campaign: components, start, goal, obstacles, horizon and step."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from campaigns.asked.values import AS_NUMBER, AS_WHOLE, Identifier, Strict, Values
from campaigns.documented import UNSTATED

MAX_STEPS = 2_000_000
MAX_SEED = 2**20
MAX_REALISATION = 2**40
"""Noise seeds that a sample of any size draws; those that a campaign states are below `MAX_SEED`."""


class Part(Strict):
    """A component and the values of its parameters; omitted ones take the component's default."""

    component: Identifier
    parameters: Values = {}


class FaultPart(Part):
    """A fault; an actuator fault names the input of the vehicle that it affects."""

    on: Annotated[str, Field(max_length=60)] = ""


class Guidance(Strict):
    """How often the avoider is evaluated: continuously, or at its own period with a zero-order hold."""

    period: Annotated[float, Field(ge=0), AS_NUMBER] = 0.0
    """[s]; 0 is continuous."""


class Realisations(Strict):
    """Which realisations of noise and gusts every evaluation simulates, and how they are combined.

    The same fixed ones for every evaluation, so that the cost is a function of the parameters. `worst` is the lowest
    value of the criterion among them, `mean` their average.
    """

    seeds: Annotated[list[Annotated[int, Field(ge=0, lt=MAX_SEED), AS_WHOLE]], Field(min_length=1, max_length=64)] = [0]
    combine: Literal["worst", "mean"] = "worst"

    def unseen(self, other: Realisations) -> list[int]:
        """The seeds of these by which a finding may violate that an evaluation with the others does not show: those
        that are not simulated there, or, where the others are averaged, all."""
        averaged = other.combine == "mean" and (self.combine == "worst" or {*self.seeds} != {*other.seeds})
        return [seed for seed in self.seeds if averaged or seed not in other.seeds]

    @field_validator("seeds")
    @classmethod
    def _distinct(cls, seeds: list[int]) -> list[int]:
        if len(set(seeds)) < len(seeds):
            raise ValueError("the same seed is given twice; list each seed once")
        return seeds


class Repeats(Strict):
    """How many calls of the simulator make one evaluation, and how they are combined.

    `worst` is the lowest value of the criterion among them, `mean` their average, `quantile` the lowest value that at
    least this fraction of them does not exceed.
    """

    count: Annotated[int, Field(ge=1, le=1000), AS_WHOLE] = 5
    combine: Literal["worst", "mean", "quantile"] = "worst"
    quantile: Annotated[float | None, Field(gt=0, lt=1), AS_NUMBER, UNSTATED] = None

    @model_validator(mode="after")
    def _quantile_belongs(self) -> Repeats:
        if (self.quantile is None) == (self.combine == "quantile"):
            raise ValueError(
                "combine: quantile needs quantile, such as 0.1"
                if self.quantile is None
                else f"quantile {self.quantile:g} needs combine: quantile, not {self.combine}; remove one of them"
            )
        return self

    def shown_by(self, other: Repeats) -> bool:
        """Whether an evaluation by the others would show what one by these does: at least as many calls, of which the
        worst counts, or combined alike."""
        alike = (self.combine, self.quantile) == (other.combine, other.quantile)
        return other.count >= self.count and (alike or other.combine == "worst" or other.count == 1)


class Scenario(Strict):
    """The closed loop: vehicle, controller, avoider; start and goal; obstacles; horizon and step."""

    vehicle: Part
    controller: Part
    avoider: Part
    start: Values = {}
    goal: Values
    obstacles: Annotated[list[Part], Field(max_length=64)] = []
    environment: Annotated[list[Part], Field(max_length=16)] = []
    faults: Annotated[list[FaultPart], Field(max_length=32)] = []
    horizon: Annotated[float, Field(gt=0), AS_NUMBER]
    """[s]"""
    step: Annotated[float, Field(gt=0), AS_NUMBER]
    """[s]"""
    guidance: Guidance = Guidance()
    realisations: Realisations = Realisations()

    @model_validator(mode="after")
    def _sizes(self) -> Scenario:
        steps, period = self.horizon / self.step, self.guidance.period
        if steps < 1:
            raise ValueError(f"the step of {self.step:g} s is longer than the horizon of {self.horizon:g} s")
        if steps > MAX_STEPS:
            raise ValueError(
                f"horizon / step = {steps:.3g} steps, at most {MAX_STEPS:,} are allowed: "
                "lengthen the step or shorten the horizon"
            )
        if not _is_whole(steps):
            raise ValueError(f"the horizon of {self.horizon:g} s is not a whole number of steps of {self.step:g} s")
        if period > 0 and not _is_whole(period / self.step):
            raise ValueError(f"the guidance period of {period:g} s is not a whole number of steps of {self.step:g} s")
        return self


def _is_whole(ratio: float) -> bool:
    return ratio >= 0.5 and abs(ratio - round(ratio)) <= 1e-6 * ratio
