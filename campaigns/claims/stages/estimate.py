"""Sentences on an estimate of P(violation) over its modes: interval, shares, and why there is none."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

from campaigns.claims.say import Part, at_least, at_most, count, joined, lowest, number, percent, say, sure
from campaigns.claims.say import probability as probable
from campaigns.claims.spans import Spans

OPEN = (
    "this is an estimate from the violations that are known, not a bound: a mode that neither the searches nor this "
    "stage found is not in it"
)
MODES_OF = {False: "violations", True: "violations and failed evaluations"}
"""What the modes of an estimate are of: failed evaluations count among them, if any failed."""
NO_FINDING, MAY_BE = "a mode that is no finding", "a mode that may be a finding"
SEED_STATED = "; their seed was stated, not drawn at the launch"
MISSING = "a mode seems to be missing: "


class Draws(NamedTuple):
    """Of an estimate: how many, their effective number, and how many failed; of the independent sample, how many draws
    were excluded, and its size with these; the probability beyond the bounds, relative to what is not excluded; whether
    the seed was stated."""

    drawn: int
    effective: float
    failed: int = 0
    excluded: int = 0
    sampled: int = 0
    outside: float = 0.0
    seed_stated: bool = False


def estimated(probability: float, ends: tuple[float, float], confidence: float, draws: Draws) -> Spans:
    """P(violation) and its interval, with what it is conditional on."""
    beyond = say(
        *(", of whose upper end ", at_most(draws.outside), " is the probability beyond the bounds"),
        " relative to what is not excluded" if draws.excluded else "",
    )
    failed = say(
        "; of them ",
        count(draws.failed, "failed"),
        " failed, which the lower end counts as no violations and all else as violations",
    )
    excluded = say(
        "; excluded cases, ",
        count(draws.excluded, "excluded"),
        " of ",
        count(draws.sampled, "sampled"),
        " independent draws, are not part of it",
    )
    return say(
        *("P(violation) is about ", probable(probability, 2, "probability"), " [", at_least(ends[0], 2, "low")),
        *(
            " to ",
            at_most(ends[1], 2, "high"),
            ", ",
            sure(confidence),
            " confidence], for the stated distributions, from ",
        ),
        *(count(draws.drawn, "draws"), " draws (effective ", count(round(draws.effective), "effective"), ")"),
        beyond if draws.outside else (),
        failed if draws.failed else (),
        excluded if draws.excluded else (),
        SEED_STATED if draws.seed_stated else (),
    )


def modes(shares: Sequence[float], hidden: int, carried: float, failed: bool = False) -> Spans:
    """The modes, and how much of P(violation) those carry that no search had found; failed: whether evaluations of the
    stage failed, here and in the other sentences."""
    one = say(f"its {MODES_OF[failed]} are of one mode")
    several = say(
        "its ", count(len(shares), "modes"), " modes carry ", _every([percent(s, 2) for s in shares]), " of it"
    )
    which = "; a mode that no search had found carries " if hidden == 1 else "; modes that no search had found carry "
    found = say(which, percent(carried, 2, "hidden"), " of it")
    return say(one if len(shares) == 1 else several, found if hidden else ())


def named(
    findings: Sequence[Sequence[str]],
    shares: Sequence[float] | None,
    unknown: Sequence[bool],
    unconfirmed: Collection[str],
) -> Spans:
    """Which findings the modes are, with their shares of P(violation) if there is an interval; unknown: whether a mode
    was not compared with all violating findings."""
    clauses = []
    for k, labels in enumerate(findings):
        finding_names = [f"{label} (not confirmed)" if label in unconfirmed else label for label in labels]
        name = " and ".join(finding_names) or (NO_FINDING, MAY_BE)[unknown[k]]
        part = say("mode ", count(k + 1), " is ") if shares is None else say(percent(shares[k], 2), " from ")
        clauses.append(say(part, name))
    return say("of P(violation) " if shares is not None else "", _every(clauses))


def _every(parts: Sequence[Part]) -> Spans:
    """A, B and C, equal ones too."""
    return say(joined(", ", parts[:-1]), " and " if len(parts) > 1 else "", parts[-1])


def whole(first: Spans, modal: Spans, failed: bool = False) -> Spans:
    """The statement of an estimate with its interval."""
    return say(first, "; ", modal, "; ", OPEN.replace("violations", MODES_OF[failed], 1))


def alarmed(alarms: Sequence[Spans]) -> Spans:
    """The statement of an estimate without an interval."""
    return say("P(violation) has no interval: ", joined("; ", alarms))


def refused(why: Spans) -> Spans:
    """The statement if nothing was estimated."""
    return say("P(violation) was not estimated: ", why)


def contradicted(violations: int, samples: int, probability: float, failed: bool = False) -> Spans:
    """An independent sample has other violations than the interval allows."""
    expected = samples * probability
    begun = MISSING if violations > expected else "the independent sample contradicts it: "
    of = say(
        count(violations, "violations"),
        " of ",
        count(samples, "samples"),
        f" independent evaluations violate{' or failed' if failed else ''}",
    )
    return say(begun, of, ", where the estimate expects ", number(expected, "", "expected", 2))


def single(part: float) -> Spans:
    """One evaluation carries too much."""
    return say("one evaluation carries ", percent(part, 3, "largest"), " of the estimate; give more evaluations")


def few(effective: float, needed: float) -> Spans:
    """The violations are too few, effectively."""
    rests = say("it rests on ", lowest(effective, "", "effective", 3), " effective evaluations")
    return say(rests, ", ", number(needed), " are needed; give more evaluations")


def unexplained(left: int, budget: int, failed: bool = False) -> Spans:
    """Violations were left of which the mode is not known."""
    what = ("violation", "violation or failed evaluation")[failed] if left == 1 else MODES_OF[failed]
    of = say(count(left, "unexplained"), f" {what} {'belongs' if left == 1 else 'belong'} to no known mode")
    return say(
        MISSING, of, ", and the budget of ", count(budget, "budget"), " did not suffice to examine them; give more"
    )


def unsaturated(modes_met: int) -> Spans:
    """Many modes were met only once."""
    return say(
        MISSING, count(modes_met, "single"), " modes were each met once, so others are likely; give more evaluations"
    )


NO_VIOLATION = say("no violation is known to begin with")
TOO_FAR = say(
    "the violations that are known are more than eight standard deviations in the tail of a distribution, where the "
    "numbers of this stage do not separate them from a bound"
)
NOISE = say(
    "the results of the simulator do not repeat, so P(violation) is also over its noise, of which the estimate would "
    "miss rare realisations without a sign"
)


def too_few(least: int, parameters: int, budget: int) -> Spans:
    """The budget is too small."""
    many = f" uncertain {'parameter' if parameters == 1 else 'parameters'} needs at least "
    return say(count(parameters), many, count(least, "least"), " evaluations here; ", count(budget), " were given")


def too_many(most: int, parameters: int) -> Spans:
    """Too many parameters."""
    return say("at most ", count(most, "most"), " uncertain parameters; the campaign has ", count(parameters))
