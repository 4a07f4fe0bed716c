"""Uncertain parameters: their bounds, distributions within the bounds, and correlations.

Distributions and correlations apply to random samples only; searches use only the bounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from campaigns.asked.values import AS_NUMBER, Number, Path, PlusMinus, Strict, Unit, around


class Uniform(Strict):
    """Every value within the bounds is equally likely."""

    kind: Literal["uniform"] = "uniform"


class Normal(Strict):
    """A normal distribution, unbounded: samples are drawn within the bounds, and the probability beyond them is added
    to every bound on P(violation)."""

    kind: Literal["normal"] = "normal"
    mean: Number
    deviation: Annotated[float, Field(gt=0), AS_NUMBER]


class TruncatedNormal(Strict):
    """A normal distribution cut off at the bounds."""

    kind: Literal["truncated_normal"] = "truncated_normal"
    mean: Number
    deviation: Annotated[float, Field(gt=0), AS_NUMBER]


class Triangular(Strict):
    """A triangle over the bounds with its peak at `mode`."""

    kind: Literal["triangular"] = "triangular"
    mode: Number


class Beta(Strict):
    """A beta distribution over the bounds with the shapes `alpha` (towards low) and `beta` (towards high).

    The density falls off to low as (x - low)^(alpha - 1) and to high as (high - x)^(beta - 1).
    """

    kind: Literal["beta"] = "beta"
    alpha: Annotated[float, Field(ge=0.01, le=1e6), AS_NUMBER]
    beta: Annotated[float, Field(ge=0.01, le=1e6), AS_NUMBER]


Distribution = Annotated[Uniform | Normal | TruncatedNormal | Triangular | Beta, Field(discriminator="kind")]


def _distribution(value: Any) -> Any:
    return {"kind": value} if isinstance(value, str) else value


class Uncertain(Strict):
    """The bounds of one uncertain parameter: `low` and `high`, or `plus_minus` around the nominal value.

    `plus_minus: 20%` is a fraction of the nominal value, `plus_minus: 0.5` is in the parameter's unit.
    """

    low: Number | None = None
    high: Number | None = None
    plus_minus: PlusMinus | None = None
    unit: Unit | None = None
    distribution: Annotated[Distribution, BeforeValidator(_distribution)] = Uniform()

    @model_validator(mode="after")
    def _one_form(self) -> Uncertain:
        if self.plus_minus is not None:
            if self.low is not None or self.high is not None:
                raise ValueError("give either low and high, or plus_minus, not both")
            return self
        if self.low is None or self.high is None:
            raise ValueError("give both low and high, or plus_minus")
        if not self.low < self.high:
            kind = "empty" if self.low == self.high else "reversed"
            raise ValueError(
                f"the interval from low = {self.low:g} to high = {self.high:g} is {kind}: low must be below high"
            )
        return self

    def interval(self, nominal: float) -> tuple[float, float]:
        """Low and high around the given nominal value, in its unit."""
        if self.low is not None and self.high is not None:
            return self.low, self.high
        assert self.plus_minus is not None
        return around(nominal, self.plus_minus)


class Correlation(Strict):
    """Two uncertain parameters are correlated: the Gaussian copula that joins them has this coefficient.

    Between two normal distributions it is Pearson's own; otherwise that of the underlying normal variables.
    """

    between: Annotated[list[Path], Field(min_length=2, max_length=2), AfterValidator(sorted)]
    value: Annotated[float, Field(gt=-1, lt=1), AS_NUMBER]


def matrix(correlations: Sequence[Correlation], paths: Sequence[str]) -> list[list[float]]:
    """The correlations as a matrix over these paths."""
    place = {path: k for k, path in enumerate(paths)}
    rows = [[float(i == k) for k in range(len(paths))] for i in range(len(paths))]
    for correlation in correlations:
        i, k = (place[path] for path in correlation.between)
        rows[i][k] = rows[k][i] = correlation.value
    return rows
