"""The estimate of P(violation) by importance sampling over its modes: numbers, modes, alarms and its draws."""

from __future__ import annotations

from typing import Annotated, Literal

from campaigns.documented import UNLESS_NONE
from campaigns.results.base import Described, Result, Values
from campaigns.results.sample import Count

NoEstimateWhy = Literal["no_violation", "too_far", "budget", "parameters", "noise"]


class Rows(Result):
    """Consecutive evaluations of the stage."""

    first: Count
    count: Count


class Origin(Result):
    """A stored evaluation of an earlier stage."""

    position: Count
    """Of its stage."""
    index: Count


class ViolationMode(Result):
    """A connected region of violations, by its most likely point."""

    share: float
    """Of P(violation)."""
    parameters: Values
    """At its most likely point."""
    distance: float
    """Of that point from the origin of standard normal space."""
    origins: list[Origin]
    """The given violations that led to it; empty if no search had found it."""


class EstimateAlarm(Described):
    """Why there is no interval: a mode seems to be missing, or the estimate rests on too few evaluations."""

    why: Literal["sample", "weight", "few", "unexplained", "unsaturated"]
    value: float


class NoEstimate(Described):
    """Why nothing was estimated."""

    why: NoEstimateWhy
    limit: Count
    """The least number of evaluations, or the most parameters; else 0."""


class ImportanceDensity(Result):
    """The density of the draws, in standard normal space: with its share a normal distribution for each mode, one of
    unit covariance at each most likely point, and the nominal distribution."""

    designs: list[list[float]]
    """The most likely points."""
    centres: list[list[float]]
    covariances: list[list[list[float]]]
    shares: list[float]


class Estimation(Described):
    """P(violation) with its interval, both null if nothing was estimated; the interval also with an alarm."""

    probability: float | None = None
    """Failed evaluations count as violations."""
    low: float | None = None
    high: float | None = None
    """Includes the probability beyond the bounds, relative to what is not excluded."""
    variation: float | None = None
    """The coefficient of variation of the estimate."""
    confidence: float
    effective: float | None = None
    """The effective sample size of the violations."""
    draws: Count = 0
    """The evaluations of the estimate; others of the stage searched for its modes."""
    failed_draws: Count = 0
    outside: float = 0.0
    """The probability beyond the bounds, or an upper bound on it."""
    modes: list[ViolationMode] = []
    alarms: list[EstimateAlarm] = []
    refused: Annotated[NoEstimate | None, UNLESS_NONE] = None
    density: Annotated[ImportanceDensity | None, UNLESS_NONE] = None
    independent: Annotated[Rows | None, UNLESS_NONE] = None
    """An independent sample of the stated distributions, which the interval must not contradict."""
    final: Annotated[Rows | None, UNLESS_NONE] = None
    """The draws that were counted."""
    seed: int
    """Of the draws: that of the independent sample."""
    drawn_at_launch: bool


class NamedModes(Described):
    """Which findings the modes of an estimate are: those to which the straight line from the most likely point of the
    mode violates. A mode may be several findings, and several modes may be one."""

    position: Count
    """Of the stage that made the estimate."""
    findings: list[list[str]]
    """Of each mode the labels; empty if it is no finding."""
    compared: list[list[str]]
    """Of each mode the violating findings to which the line was evaluated before the allowance of validation ended."""
