"""Statements about the distances of a verdict: whether they are measured to centres or surfaces of obstacles."""

from __future__ import annotations

from campaigns import Campaign, Catalogue
from campaigns.checked import extents
from campaigns.checked.check import parameters
from campaigns.claims.say import limit, listed, number, say, symbol
from campaigns.claims.spans import Spans
from campaigns.symbols import labels


def clause(campaign: Campaign, catalogue: Catalogue) -> Spans:
    """The clause about distances for the scope of a verdict; empty for a criterion without distances to obstacles."""
    criterion = catalogue.component("criterion", campaign.criterion.component)
    measured_to = "" if criterion is None else criterion.measured_to
    if measured_to == "surface":
        return say("distances measured to the obstacles' surfaces", _less(campaign, catalogue))
    if measured_to != "centre":
        return ()
    inside = _inside(campaign, catalogue)
    more = say("; a vehicle inside ", listed(list(inside)), " may count as clear") if inside else ()
    return say("distances measured to the obstacles' centres, not their surfaces", more)


def overlooked(campaign: Campaign, catalogue: Catalogue) -> Spans:
    """The sentence why distances to centres rule out "cleared"; empty if they do not.

    They do if the threshold is inside an obstacle, unless the campaign states that a centre distance is intended. New
    campaigns of this kind are refused; campaigns queued or run before that rule still reach this check.
    """
    criterion = catalogue.component("criterion", campaign.criterion.component)
    if criterion is None or criterion.measured_to != "centre" or campaign.criterion.from_centre:
        return ()
    inside = _inside(campaign, catalogue)
    if not inside:
        return ()
    path = max(inside, key=lambda p: inside[p])
    return say(
        *(symbol(criterion.quantity), " is measured to the obstacles' centres, and the threshold of "),
        *(limit(campaign.criterion.threshold, "m", "threshold"), f" is inside {path}, whose surface extends to "),
        *(number(inside[path], "m", "reach"), " from its centre: a vehicle inside it would count as clear"),
    )


def _inside(campaign: Campaign, catalogue: Catalogue) -> dict[str, float]:
    return extents.within(campaign, catalogue, parameters(campaign, catalogue))


def _less(campaign: Campaign, catalogue: Catalogue) -> Spans:
    """The clause for the subtracted radius of the vehicle; an uncertain one by symbol: the scope states its bounds."""
    path, known = "criterion.body_radius", parameters(campaign, catalogue)
    if path not in known:
        return ()
    body = known[path][1]
    if path in campaign.uncertain:
        symbols = {p: entry.symbol for p, (entry, _) in known.items()}
        return say(", less ", symbol(path, labels(campaign.uncertain, symbols)[path]))
    return say(", less the radius of the vehicle's body of ", number(body, "m")) if body > 0 else ()
