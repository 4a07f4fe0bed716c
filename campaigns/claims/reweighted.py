"""Sentences on an estimate under moved distributions, and on why there is none."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from campaigns.claims.say import amount, at_least, at_most, count, listed, lowest, percent, say, sure, symbol
from campaigns.claims.say import probability as share
from campaigns.claims.spans import Spans

NO_SAMPLE = say("no estimate: the run has no independent sample; add a certify stage to its campaign and run it again")
"""Searches choose their points, and a random search may stop early."""
NOT_WHOLE = say("no estimate: the independent sample is not stored whole")
ENDED_EARLY = say("no estimate: the independent sample ended early, when too many violated; draw one of a stated size")
"""The size of such a sample follows from what came out, so its fraction of violations is too high."""
NO_BOUNDS = say("no estimate: the bounds of a parameter are not known in this installation")
"""The descriptions of the run's components are not here."""


class Draws(NamedTuple):
    """What an estimate rests on. outside, missed: probabilities in the interval, relative to what is not excluded."""

    samples: int
    failed: int
    excluded: int
    effective: float
    outside: float
    missed: float


def estimate(probability: float, ends: tuple[float, float], confidence: float, of: Draws) -> Spans:
    """The estimate with its interval, and what it is not."""
    return say(
        *("P(violation) is estimated as ", share(probability, name="probability"), ", "),
        *(at_least(ends[0], name="low"), " to ", at_most(ends[1], name="high"), " with "),
        *(sure(confidence), " confidence, by re-weighting ", count(of.samples, "samples")),
        *(" stored draws", " that were not excluded" if of.excluded else "", _failed(of)),
        *(" (effective sample size ", count(int(of.effective), "effective"), ")", _width(of)),
        ": an estimate, not a bound",
    )


def _failed(of: Draws) -> Spans:
    counts = (
        " of which failed and counts as a violation," if of.failed == 1 else " of which failed and count as violations,"
    )
    return say(", ", count(of.failed, "failed"), counts) if of.failed else ()


def _width(of: Draws) -> Spans:
    """Why the interval is as wide as it is."""
    relative = " relative to those not excluded" if of.excluded else ""
    beyond = say(at_most(of.outside, name="outside"), " of draws outside the bounds", relative)
    unseen = say(at_most(of.missed, name="missed"), " for regions that the draws may have missed")
    parts = [part for part, fraction in ((beyond, of.outside), (unseen, of.missed)) if fraction]
    return say("; the interval includes ", listed(parts)) if parts else ()


def too_few(effective: float, samples: int, needed: int) -> Spans:
    """Too few of the stored draws are likely under the moved distributions."""
    return say(
        *(
            "no estimate: the ",
            amount(samples, "stored draw", "samples"),
            f" {'is' if samples == 1 else 'are'} worth only ",
        ),
        *(lowest(effective, name="effective", digits=3), " under these distributions, and at least "),
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


def at_bound(paths: Sequence[str]) -> Spans:
    """Draws were rounded to a bound where the density is unbounded, so that there is no ratio of densities."""
    return say(
        *("no estimate: draws of ", listed([symbol(path) for path in paths]), " are rounded to a bound, where the "),
        "density of such a beta distribution is unbounded, so their weights are not known; state larger shapes",
    )


def outside(fraction: float, most: float) -> Spans:
    """Too many draws would be where nothing was evaluated."""
    return say(
        *(
            "no estimate: ",
            at_most(fraction, name="outside"),
            " of the draws would be outside the bounds, where nothing ",
        ),
        *("was evaluated, and at most ", percent(most, 6, "most"), " may be; move the distributions less"),
    )


def redrawn(fraction: float) -> Spans:
    """The reason that there is no estimate: correlated draws outside the bounds were drawn again inside, by no
    density."""
    return say(
        *(
            "no estimate: up to ",
            at_most(fraction, name="redrawn"),
            " of the correlated draws were outside the bounds ",
        ),
        "and drawn again within them, so their density is not known; widen the bounds",
    )
