"""Statements about obstacles that turn too fast for the step to follow them."""

from __future__ import annotations

import math

from campaigns import Campaign, Catalogue
from campaigns.checked import rates
from campaigns.checked.check import parameters
from campaigns.claims.say import number, say
from campaigns.claims.spans import Spans
from campaigns.limits import TURN


def unfollowed(campaign: Campaign, catalogue: Catalogue) -> Spans:
    """The sentence why the motion of an obstacle rules out "cleared"; empty if the step follows every one."""
    length = campaign.given_scenario.step
    found = list(rates.turning(campaign, catalogue, parameters(campaign, catalogue)))
    if unknown := [_named(each) for each in found if math.isnan(each.rate)]:
        return say(f"the rate of {unknown[0]} is unknown: declare it in its component, so that the step can be checked")
    fastest = max(found, key=lambda each: each.rate, default=None)
    if fastest is None or fastest.rate * length <= TURN:
        return ()
    named = _named(fastest)
    if not math.isfinite(fastest.rate):
        return say(f"{named} may turn arbitrarily fast within the bounds; narrow the bounds of its path")
    turned, step = number(fastest.rate * length, "rad", "turn", 4), number(length, "s", "step")
    return say(
        *(f"{named} turns at up to ", number(fastest.rate, "rad/s", "rate", 4), ", which is ", turned),
        *(" in a step of ", step, "; use a step of at most ", number(TURN / fastest.rate, "s", "largest", 4)),
    )


def _named(obstacle: rates.Turning) -> str:
    return f"obstacle {obstacle.number + 1} ({obstacle.title})"
