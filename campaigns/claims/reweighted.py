"""Sentences on an estimate under moved distributions, and on why there is none."""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.claims.say import count, listed, number, percent, say, symbol
from campaigns.claims.spans import Spans


def estimate(
    probability: float, ends: tuple[float, float], confidence: float, effective: float, of: Spans, few: bool
) -> Spans:
    """The estimate with its interval. of: the draws that it rests on; few: whether too few violate to weight them."""
    wide = "; few of them violate, so the interval is as wide as it has to be wherever the violations are"
    return say(
        *("P(violation) is estimated as ", percent(probability, name="probability"), ", "),
        *(percent(ends[0], name="low"), " to ", percent(ends[1], name="high"), " with "),
        *(percent(confidence, 6, "confidence"), " confidence, by re-weighting ", of),
        *(" (effective sample size ", number(effective, name="effective", digits=4), f"){wide if few else ''}"),
        ": an estimate, not a bound",
    )


def population(samples: int, excluded: int, outside: float) -> Spans:
    """The draws of the sample, and what they leave out."""
    without = say(" that were not excluded") if excluded else ()
    beyond = say(", with ", percent(outside, name="outside"), " of draws outside the bounds in the interval")
    return say(count(samples, "samples"), " stored draws", without, beyond if outside else ())


def too_few(effective: float, samples: int, needed: int) -> Spans:
    """Too few of the stored draws are likely under the moved distributions."""
    return say(
        *("no estimate: the ", count(samples, "samples"), " stored draws are worth only "),
        *(number(effective, name="effective", digits=3), " under these distributions, and at least "),
        *(count(needed, "needed"), " are needed; move the distributions less, or draw a larger sample"),
    )


def beyond(paths: Sequence[str]) -> Spans:
    """Moved bounds are wider than those of the draws."""
    of = listed([symbol(path) for path in paths])
    return say(
        "no estimate: the moved bounds of ",
        of,
        " are wider than those of the draws, beyond which nothing was evaluated",
    )


def outside(fraction: float, most: float) -> Spans:
    """Too many draws would be where nothing was evaluated."""
    return say(
        *(
            "no estimate: ",
            percent(fraction, name="outside"),
            " of the draws would be outside the bounds, where nothing ",
        ),
        *("was evaluated, and at most ", percent(most, 6, "most"), " may be; move the distributions less"),
    )


def redrawn(fraction: float) -> Spans:
    """Of correlated normal distributions, what was outside was drawn again inside, by no density."""
    return say(
        *(
            "no estimate: up to ",
            percent(fraction, name="redrawn"),
            " of the correlated draws were outside the bounds ",
        ),
        "and drawn again within them, so their density is not known; widen the bounds",
    )
