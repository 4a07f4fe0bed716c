"""The API schemas of coverage."""

from __future__ import annotations

from backend.http.schema import Schema
from campaigns.claims.spans import Spans


class EmptyBall(Schema):
    """The largest ball found around a point of the box that contains no evaluation; a larger one may exist."""

    radius: float
    """Distance from the centre to the nearest evaluation, each parameter's range being 1; rounded down."""
    diagonal: float
    """Of the box, in the same units: the square root of the number of parameters."""
    centre: dict[str, float]
    """{path: value} in the parameters' units."""


class PairCoverage(Schema):
    """How many of the equal bins of a pair of parameters have an evaluation."""

    first: str
    second: str
    touched: int


class PossibleVolume(Schema):
    """The volume in which a violation is possible if the cost changes nowhere faster than between evaluations."""

    slope: float
    """The steepest slope seen between near evaluations, in the criterion's unit for a whole range; not a bound."""
    fraction: float
    """Of the box, estimated from random points."""
    standard_error: float
    """0 if all random points agree, which does not show that all others do."""
    points: int
    """Number of random points."""


class Coverage(Schema):
    """How much of the box of the bounds a run's evaluations cover: no proof, and in no verdict."""

    total: int
    """Evaluations of all stages that are stored."""
    used: int
    """At most 20,000 of them, fewer from 13 parameters on, evenly spaced in their order."""
    without_value: int
    """Used ones that failed or were excluded: they count for balls and bins, and rule out no volume."""
    ball: EmptyBall | None
    """Null without evaluations."""
    bins: int
    """Of every pair of parameters."""
    pairs: list[PairCoverage]
    """The least covered first."""
    possible: PossibleVolume | None
    """Null if no two evaluations with a value are far enough apart for a slope."""
    statements: list[Spans]
    """The same as sentences; the last one states what the figures do not show."""
