"""The stages of a campaign with their settings: budgets, options, tolerances."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from campaigns import limits
from campaigns.asked.values import (
    AS_NUMBER,
    AS_WHOLE,
    MAX_COUNTED,
    MAX_EVALUATIONS,
    Identifier,
    Number,
    Option,
    Path,
    Strict,
)
from campaigns.documented import UNLESS_STATED, UNSTATED, no_default


class Morris(Strict):
    """Elementary effects (Morris 1991): trajectories over a grid of levels, one parameter stepped at a time."""

    trajectories: Annotated[int, Field(ge=2, le=10_000), AS_WHOLE] = 20
    levels: Annotated[int, Field(ge=4, le=64, multiple_of=2), AS_WHOLE] = 4


class SobolIndices(Strict):
    """Sobol indices (Saltelli 2010): fractions of the variance; `samples` times (dimension + 2) evaluations."""

    samples: Annotated[int, Field(ge=8, le=2**20), AS_WHOLE] = 256

    @field_validator("samples")
    @classmethod
    def _power(cls, samples: int) -> int:
        if samples & (samples - 1):
            lower = 2 ** (samples.bit_length() - 1)
            raise ValueError(f"Sobol points are balanced for powers of two only; give {lower} or {2 * lower}")
        return samples


class Sensitivity(Strict):
    """One parameter at a time over its bounds, the others nominal; Morris and Sobol indices if requested."""

    points: Annotated[int, Field(ge=2, le=2001), AS_WHOLE] = 21
    morris: Morris | None = None
    sobol: SobolIndices | None = None


class Search(Strict):
    """One search stage: a method, its budget of evaluations, its options and, if it uses them, its starts."""

    method: Identifier
    evaluations: Annotated[int, Field(ge=1, le=MAX_EVALUATIONS), AS_WHOLE]
    options: Annotated[dict[str, Option], Field(max_length=100)] = {}
    starts: Annotated[list[dict[Path, Number]], Field(max_length=10_000)] = []
    """Points to start from, by path in the parameters' units; omitted paths are nominal."""


class Grid(Strict):
    """A full grid: `points` values on every axis, including the bounds."""

    points: Annotated[int, Field(ge=2, le=2001), AS_WHOLE] = 21


Kept = Literal["all", "lowest"]
Until = Literal["samples", "target"]


class Certify(Strict):
    """An independent sample from the distributions, declared before the run: the basis of claims on probability.

    `samples` evaluations that are not excluded; `quantile` of the criterion's value that is bounded from below.
    """

    samples: Annotated[int, Field(ge=1, le=MAX_COUNTED), AS_WHOLE] = 3000
    quantile: Annotated[float, Field(ge=1 / MAX_COUNTED, lt=1), AS_NUMBER] = 0.05
    """No sample that may be drawn bounds a smaller one."""
    grid: Grid | None = None
    keep: Annotated[Kept, Field(exclude_if=lambda keep: keep == "all", json_schema_extra=no_default)] = "all"
    """The evaluations that are stored: all, at most 10,000,000; or of a sample of any size the lowest 1,000, the first
    1,024 and counts of all, each of which can be flown again by its index. Omitted from the canonical form if all."""
    until: Annotated[Until, Field(exclude_if=lambda end: end == "samples", json_schema_extra=no_default)] = "samples"
    """When it ends: with its samples, or earlier, when more of them violate than the campaign's target probability
    allows. Omitted from the canonical form if samples."""

    @property
    def shared(self) -> bool:
        """Whether several workers may fly it: of one that ends early each block decides on the next."""
        return self.keep == "lowest" and self.until == "samples"

    @model_validator(mode="after")
    def _stored(self) -> Certify:
        if self.keep == "all" and self.samples > MAX_EVALUATIONS:
            raise ValueError(f"at most {MAX_EVALUATIONS:,} samples are stored whole; give keep: lowest for more")
        if self.keep == "lowest" and self.grid is not None:
            raise ValueError("a grid is stored whole; give keep: all, or leave the grid out")
        if self.until == "target" and self.keep == "all":
            raise ValueError("a sample that ends by its target is counted in blocks; give keep: lowest")
        return self


class Estimate(Strict):
    """P(violation) by importance sampling over the violations that the stages before found: an estimate, not a bound.

    Without a violation it states that there is none to begin with, and takes no evaluations.
    """

    evaluations: Annotated[int, Field(ge=1000, le=MAX_EVALUATIONS), AS_WHOLE] = 5000


class Attraction(Strict):
    """A region from which the closed loop returns to its trim, proved for its polynomial model by sums of squares.

    It takes no evaluations and enters no verdict.
    """

    degree: Annotated[Literal[2, 4, 6] | None, UNSTATED] = None
    """Of the Lyapunov function; omitted: 6 for two states, 4 for three, 2 for four. Degree 4 with four states takes
    minutes."""


def _usual(repeats: int) -> bool:
    return repeats == limits.REPEATS


class Validate(Strict):
    """How the findings are validated: tolerance of the reference integrator and step-halving check, and neighbours."""

    tolerance: Annotated[float, Field(gt=0, le=1), AS_NUMBER] = limits.TOLERANCE
    """Fraction of the criterion's value; a tenth of the margin also applies."""
    neighbours: Annotated[int, Field(ge=0, le=100_000), AS_WHOLE] = 300
    reach: Annotated[float, Field(gt=0, le=0.5), AS_NUMBER] = 1e-3
    """Fraction of each range that contains the neighbours."""
    evaluations: Annotated[int | None, Field(ge=0, le=MAX_EVALUATIONS), AS_WHOLE, UNLESS_STATED] = None
    """Of validation in all, those made again to confirm results included; omitted: as many as the searches, or as
    `findings.evaluations` states. Never less than confirming the nominal case and one finding takes."""
    repeats: Annotated[
        int, Field(ge=limits.REPEATS, le=10_000, exclude_if=_usual, json_schema_extra=no_default), AS_WHOLE
    ] = limits.REPEATS
    """Independent calls of a simulator that does not repeat, for every finding and the best of every search; omitted
    from the canonical form if usual, so campaigns without it keep their digests."""


class Findings(Strict):
    """When two worst cases count as one, how many are stored, and how many evaluations distinguishing them may take."""

    at_most: Annotated[int, Field(ge=1, le=250), AS_WHOLE] = 8
    evaluations: Annotated[int, Field(ge=0, le=MAX_EVALUATIONS), AS_WHOLE] = limits.FINDINGS
    """To distinguish them; neighbours, slices and boundaries come in addition. Validation as a whole takes at most as
    many evaluations as the searches, or as this states if it is more; the usual number counts as not stated (canonical
    campaigns have it written out): `validate.evaluations` states any number."""
    distance: Annotated[float, Field(gt=0, le=0.5), AS_NUMBER] = limits.DISTANCE
    """Two minima closer than this fraction of every range count as one; with a baseline, this is at most 0.05."""
    barrier: Annotated[float, Field(ge=0, le=1), AS_NUMBER] = limits.BARRIER
    """Two minima count as one if no barrier between them is above this fraction of nominal minus worst."""


class Stages(Strict):
    """The stages of a run, in this order; nominal always comes first."""

    sensitivity: Sensitivity | None = Sensitivity()
    search: Annotated[list[Search], Field(min_length=1, max_length=32, json_schema_extra=no_default)] = [
        Search(method=limits.SEARCH, evaluations=limits.SEARCHED)
    ]
    """If omitted, Auto with 5000 evaluations or 1000 for each parameter, whichever is more."""
    certify: Certify | None = None
    """If omitted, 300 samples of a closed loop and 59 of a simulator; null draws none, and then nothing is cleared."""
    estimate: Annotated[Estimate | None, UNSTATED] = None
    """If omitted, P(violation) is not estimated. Omitted from the canonical form if null."""
    attraction: Annotated[Attraction | None, UNSTATED] = None
    """If omitted, no region of attraction is sought. Omitted from the canonical form if null."""
    findings: Findings = Findings()
    validate_: Validate = Field(default=Validate(), alias="validate")
