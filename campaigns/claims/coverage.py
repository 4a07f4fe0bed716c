"""Sentences on how much of the box of the bounds the evaluations cover: none of them is a proof, no verdict has one."""

from __future__ import annotations

from campaigns.claims.say import Part, count, number, percent, probability, say
from campaigns.claims.spans import Spans

NO_EVALUATION = say("No evaluation is stored: nothing of the box is covered.")
NO_PROOF = say(
    "Coverage is no proof: a violation may be smaller than the gaps between evaluations and steeper than every slope "
    "seen. No verdict uses these figures."
)
NO_SLOPE = say("No two evaluations with a value are far enough apart for a slope: no volume is ruled out.")


def used(chosen: int, total: int) -> Spans:
    """How many of the evaluations the figures are computed from."""
    if chosen == total:
        return say("All stored evaluations are used: ", count(total), ".")
    of = say(count(chosen), " of ", count(total), " stored evaluations are used, evenly spaced in their order.")
    return say(of, " With all of them, empty balls are no larger and no fewer bins are touched.")


def without_value(lost: int) -> Spans:
    """What evaluations without a value count for."""
    counts, rule = ("counts", "rules") if lost == 1 else ("count", "rule")
    return say(
        count(lost), f" without a value (failed or excluded) {counts} for balls and bins, and {rule} out no volume."
    )


def ball(radius: float, diagonal: float) -> Spans:
    """The largest ball that was found: larger ones may exist."""
    empty = say("A ball with radius ", number(radius, digits=3), " contains none of them")
    box = say("; each range is 1, and the diagonal of the box ", number(diagonal, digits=3))
    return say(empty, box, ". Larger ones may exist.")


def bins(first: Part, second: Part, touched: int, of: int) -> Spans:
    """The pair of parameters with the fewest bins that have an evaluation."""
    if touched == of:
        return say("Of every pair of parameters all ", count(of), " equal bins have an evaluation.")
    least = say("The least covered pair of parameters is ", first, " and ", second)
    return say(least, ": ", count(touched), " of ", count(of), " equal bins have an evaluation.")


def volume(slope: float, unit: str, apart: float, possible: float, drawn: int, error: float) -> Spans:
    """possible: the fraction of the drawn points at which this slope leaves a violation possible."""
    between = say(
        "The steepest slope seen between near evaluations, at least ", percent(apart), " of a range apart, is "
    )
    steepest = say(between, number(slope, unit, digits=3), " for a whole range")
    seen = say(steepest, ". If nothing is steeper, a violation is possible")
    points = say(count(drawn), " random points of the box")
    if error == 0.0:
        return say(seen, " at ", "none" if possible == 0.0 else "all", " of ", points, ".")
    of = say(probability(possible), " of the box, with a standard error of ", probability(error, digits=2))
    return say(seen, " in ", of, " (", points, ").")
