"""Sentences on a region of attraction: what is proved, of which model, and what is only measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from campaigns.claims.numbers import Format, rounded
from campaigns.claims.say import count, joined, listed, number, percent, say
from campaigns.claims.spans import Span, Spans

REASONS: dict[str, Spans] = {
    "solver": say("the solver Clarabel is not installed; install the package clarabel where the worker runs"),
    "unstable": say("the loop does not return to its trim by its linear part, so that it has no such region"),
    "no_region": say("no sum of squares was found; a lower or higher degree of V may help"),
    "rounding": say("the certificate that was found does not hold in exact arithmetic"),
}


class Facts(NamedTuple):
    """What the statement of a certified region says."""

    references: Sequence[tuple[str, float, str]]
    """References held at the trim: words, value, unit."""
    model: int
    """Degree of the polynomial model."""
    degree: int
    """Of V."""
    states: Sequence[tuple[str, float | None, str]]
    """Symbol, limit, unit."""
    rays: int
    contradicting: int
    fraction: float | None
    difference: float


def proved(of: Facts) -> Spans:
    """The statement of a certified region: what is proved, then what is measured."""
    about = joined(", ", [say(text, " ", number(value, unit)) for text, value, unit in of.references])
    what = say(
        *(
            "proved for the polynomial model of degree ",
            count(of.model, "model"),
            " about trim (",
            about,
            ") at the nominal parameters, not for ",
        ),
        *("the loop as flown: from every state with V < 1, V of degree ", count(of.degree, "degree"), " in "),
        listed([symbol for symbol, _, _ in of.states]),
    )
    limits = [
        say(symbol, " within ", _upward(limit, unit, 4)) for symbol, limit, unit in of.states if limit is not None
    ]
    within = say(" and keeps ", listed(limits), " of it") if limits else ()
    return say(what, ", the model returns to the trim", within, "; ", _measured(of))


def _upward(bound: float, unit: str, digits: int, name: str = "") -> Span:
    """An upper bound that is no probability: never below it."""
    return number(float(rounded(bound, Format.AT_MOST, digits)), unit, name, digits)


def _measured(of: Facts) -> Spans:
    """What is not proved: the volume, and how far the model is from the loop."""
    rays = say(count(of.rays, "rays"), " rays")
    if of.contradicting:
        volume = say(
            "on ", count(of.contradicting, "contradicting"), " of ", rays, " the simulated loop did not return"
        )
    elif of.fraction is None:
        volume = say("the region from which the loop returns in simulation has no end on some of ", rays)
    else:
        of_it = " of the volume from which the loop returns in simulation ("
        volume = say("the region has ", percent(of.fraction, 2, "fraction"), of_it, rays, ")")
    apart = say("the rates of model and loop differ by at most ", _upward(of.difference, "", 2, "difference"))
    where = ", and on each, at a point inside it and at its boundary, "
    return say("measured, not proved: ", volume, where, apart, " of the largest")


def refused(why: Spans) -> Spans:
    """The statement if no region is stated."""
    return say("no region of attraction is stated: ", why)
