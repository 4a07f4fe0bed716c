"""Statements about the distances of a verdict: whether they are measured to centres or surfaces of obstacles.

Start reading at `clause`.
"""

from __future__ import annotations

from campaigns.checked import extents
from campaigns.checked.check import parameters
from campaigns.claims.say import listed, number, say, symbol
from campaigns.claims.spans import Spans
from campaigns.symbols import labels
from worker.engine.systems.closed_loop.flights import Flights


def clause(flights: Flights) -> Spans:
    """The clause about distances for the scope of a verdict; empty for a criterion without distances to obstacles."""
    criterion = flights.parts.criterion
    if criterion.measured_to == "surface":
        return say("distances measured to the obstacles' surfaces", _less(flights))
    if criterion.measured_to != "centre":
        return ()
    inside = _inside(flights)
    more = say("; a vehicle inside ", listed(list(inside)), " may count as clear") if inside else ()
    return say("distances measured to the obstacles' centres, not their surfaces", more)


def overlooked(flights: Flights) -> Spans:
    """The sentence why distances to centres rule out "cleared"; empty if they do not.

    They do if the threshold is inside an obstacle, unless the campaign states that a centre distance is intended. New
    campaigns of this kind are refused; campaigns queued or run before that rule still reach this check.
    """
    criterion = flights.parts.criterion
    if criterion.measured_to != "centre" or flights.campaign.criterion.from_centre:
        return ()
    inside = _inside(flights)
    if not inside:
        return ()
    path = max(inside, key=lambda p: inside[p])
    return say(
        *(symbol(criterion.quantity), " is measured to the obstacles' centres, and the threshold of "),
        *(number(flights.threshold, "m", "threshold"), f" is inside {path}, whose surface extends to "),
        *(number(inside[path], "m", "reach"), " from its centre: a vehicle inside it would count as clear"),
    )


def _inside(flights: Flights) -> dict[str, float]:
    described = flights.installed.catalogue
    return extents.within(flights.campaign, described, parameters(flights.campaign, described))


def _less(flights: Flights) -> Spans:
    """The clause for the subtracted radius of the vehicle; an uncertain one by symbol: the scope states its bounds."""
    path = "criterion.body_radius"
    if path not in flights.paths:
        return ()
    body = float(flights.nominal[flights.paths[path]])
    if path in flights.campaign.uncertain:
        symbols = {f"{s.prefix}.{p.name}": p.symbol for s in flights.loop.sections for p in s.parameters}
        return say(", less ", symbol(path, labels(flights.campaign.uncertain, symbols)[path]))
    return say(", less the radius of the vehicle's body of ", number(body, "m")) if body > 0 else ()
