"""Sentences on the calls of a simulator: whether results repeat, what independent calls show, why one has no value."""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.claims.say import at_least, at_most, count, number, say
from campaigns.claims.spans import Spans

FAILED = "the evaluation failed"
CALL_FAILED = "the call failed"
USED_PROCESS = "an evaluation in a used process"
"""The name of a comparison."""


def measured(
    points: int, evaluations: int, failed: int, identical: bool, declared: bool, spread: float | None, unit: str
) -> Spans:
    """Whether evaluations of the same points repeat."""
    of = say(count(points, "points"), " points, ", count(evaluations, "evaluations"), " evaluations")
    lost = say(", of which ", count(failed, "failed"), " failed") if failed else ()
    if identical:
        but = () if declared else "; the simulator declares that its results do not repeat"
        return say("repeats bit by bit: ", of, lost, but)
    if not spread:
        return say("does not repeat: evaluations of the same point fail only sometimes: ", of, lost)
    return say(
        "differs by up to ", number(spread, unit, "spread"), " between evaluations of the same point: ", of, lost
    )


def independent(violating: int, failed: int, calls: int, low: float, high: float) -> Spans:
    """How many of the independent calls of a case violate, and the interval of the probability."""
    lost = say(", ", count(failed, "failed"), " failed") if failed else ()
    of = say(count(violating, "repeats_violating"), " of ", count(calls, "repeats"), lost)
    return say("violates in ", of, " [", at_least(low, 2, "low"), " to ", at_most(high, 2, "high"), "]")


def without_value(evaluations: int, points: int, reasons: Sequence[str]) -> str:
    """Why a run ends whose first evaluations have no value."""
    more = f" (and {len(reasons) - 1} other reasons)" if len(reasons) > 1 else ""
    return (
        f"none of its first {evaluations} evaluations, of {points} points within the bounds, has a value: "
        f"{reasons[0] if reasons else 'no reason was given'}{more}"
    )


def nominal_excluded(reason: str) -> str:
    """Why a run ends whose simulator excludes the nominal case."""
    return (
        f"it excludes the nominal case ({reason}), to which all others are compared: choose nominal values that it "
        "evaluates"
    )


def other_trace(shown: float | None, stored: float) -> str:
    """Why the trace of a case is not stored."""
    return (
        f"the trace belongs to an evaluation with the cost {shown!r}, but the stored cost is {stored!r}. Check that "
        "the program computes the same with and without a trace"
    )
