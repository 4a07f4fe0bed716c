"""What a verdict has to state of its distances: which point of the obstacles they end at.

Start reading at `clause`.
"""

from __future__ import annotations

from campaigns.checked import extents
from campaigns.checked.check import parameters
from campaigns.claims.say import listed, number, say, symbol
from campaigns.claims.spans import Said
from campaigns.symbols import labels
from worker.catalogue.installed import catalogue
from worker.systems.closed_loop.flights import Flights


def clause(flights: Flights) -> Said:
    """The condition on distances for the scope of a verdict, as a clause; empty for a criterion that reads none."""
    criterion = flights.parts.criterion
    if criterion.measured_to == "surface":
        return say("distances measured to the obstacles' surfaces", _less(flights))
    if criterion.measured_to != "centre":
        return ()
    inside = _inside(flights)
    more = say("; a vehicle inside ", listed(list(inside)), " may count as clear") if inside else ()
    return say("distances measured to the obstacles' centres, not their surfaces", more)


def overlooked(flights: Flights) -> Said:
    """Why such distances bar "cleared", as a sentence; empty where they do not.

    That is where the threshold is not within an obstacle, or the campaign states that a centre distance is meant. New
    campaigns of that kind are refused; one that was queued or run before they were is not.
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
        *(number(flights.threshold, "m", "threshold"), f" is within {path}, which reaches "),
        *(number(inside[path], "m", "reach"), " from its own: a vehicle inside it would count as clear"),
    )


def _inside(flights: Flights) -> dict[str, float]:
    described = catalogue()
    return extents.within(flights.campaign, described, parameters(flights.campaign, described))


def _less(flights: Flights) -> Said:
    """What is subtracted for the vehicle's own body; an uncertain radius stands with its bounds in the scope."""
    path = "criterion.body_radius"
    if path not in flights.paths:
        return ()
    body = float(flights.nominal[flights.paths[path]])
    if path in flights.campaign.uncertain:
        symbols = {f"{s.prefix}.{p.name}": p.symbol for s in flights.loop.sections for p in s.parameters}
        return say(", less ", symbol(path, labels(flights.campaign.uncertain, symbols)[path]))
    return say(", less the radius of the vehicle's body of ", number(body, "m")) if body > 0 else ()
