"""Sentences on how likely a case is under the stated distributions: one wherever it is stated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from campaigns.claims.say import amount, count, finding, listed, number, percent, probability, say, signed, symbol
from campaigns.claims.spans import Spans, values

UNIFORM = say("all points of the box are equally likely")
AT_BOUND = say("no likelihood is stated: a correlated parameter is at its bound, where its distance is not defined")
"""Of versions that compared correlated parameters of all distributions in the standard normal space."""
IMPOSSIBLE = say("the density of the stated distributions is ", percent(0.0, name="density"), " here")
"""Of triangular and beta distributions at their bounds."""


def unbounded(paths: Sequence[str]) -> Spans:
    """Beta distributions with a shape below 1 have no highest density."""
    of = listed([symbol(path) for path in paths])
    return say("no likelihood is stated: the density of ", of, " is unbounded at a bound, so there is no highest one")


def skewed(paths: Sequence[str]) -> Spans:
    """Only correlated normal parameters have a joint density whose highest value is known in closed form."""
    of, verb = listed([symbol(path) for path in paths]), "is" if len(paths) == 1 else "are"
    return say(
        *("no likelihood is stated: ", of, f" {verb} correlated but not normal, "),
        "so the highest joint density is not known",
    )


def likelihood(density: float, distance: float, tail: float, parameters: int, of: int) -> Spans:
    """The distance, the density and the draws that are no more likely."""
    others = say(", without the ", count(of - parameters), " uniform") if of > parameters else ()
    return say(
        *(number(distance, name="distance", digits=3), " standard deviations from the most likely point", others),
        *("; density ", probability(density, name="density"), " of the highest; "),
        *(probability(tail, name="tail"), " of all draws are no more likely"),
    )


def most_likely(violations: int, name: str, margin: float, unit: str, of: Spans) -> Spans:
    """The most likely violation, and of what it is the most likely one."""
    return say(
        *("the most likely of the ", amount(violations, "stored violation", "violations"), ", not of all: "),
        *(f"evaluation {name}, margin ", signed(margin, unit, "margin"), ", not validated; ", of),
    )


def lines(findings: Mapping[str, Spans], violation: Spans) -> list[Spans]:
    """A clause for each finding, one for all where none of them has a number, and that of the most likely violation."""
    distinct = list(dict.fromkeys(findings.values()))
    alike = len(distinct) == 1 and not values(distinct[0])
    each = distinct if alike else [say(finding(label), ": ", of) for label, of in findings.items()]
    return [*each, *([violation] if violation else [])]


def no_case(violations: int, known: bool, uniform: bool) -> Spans:
    """Why there is no most likely violation."""
    if not violations:
        return say("no stored evaluation violates the criterion")
    if uniform:
        return UNIFORM
    return say("no violation has a likelihood" if known else "the bounds of a parameter are not known")
