"""Statements about the distances of a verdict: whether they are measured to centres or surfaces of obstacles."""

from __future__ import annotations

from campaigns import Campaign, Catalogue
from campaigns.catalogue import ComponentEntry
from campaigns.checked import extents
from campaigns.checked.check import parameters
from campaigns.claims.say import limit, listed, number, say, symbol
from campaigns.claims.spans import Spans
from campaigns.results.validate import Mismeasured
from campaigns.symbols import labels

WHAT_TO_DO = (
    "correct its component so that its value is this distance in m (to surfaces, less its body_radius), or declare "
    "what it measures: centre, surface, or none if it measures no distance"
)
"""What a criterion must do that declares another distance than it computes."""

GAP = (
    "correct its component, so that the gap changes by no more than a place moves: the distance to the surface, or "
    "less where that is easier to compute"
)
"""What an obstacle must do whose gap is larger than the distance."""


def clause(campaign: Campaign, catalogue: Catalogue) -> Spans:
    """The clause about distances for the scope of a verdict; empty for a criterion without distances to obstacles."""
    criterion = catalogue.component("criterion", campaign.criterion.component)
    measured_to = "" if criterion is None or not extents.in_metres(criterion) else criterion.measured_to
    if measured_to == "surface":
        return say("distances measured to the obstacles' surfaces", _less(campaign, catalogue))
    if measured_to != "centre":
        return ()
    unknown = [f"obstacles.{i}" for i, _ in extents.unknown(campaign, catalogue)]
    inside = sorted([*_inside(campaign, catalogue), *unknown], key=lambda path: int(path.partition(".")[2]))
    more = say("; a vehicle inside ", listed(inside), " may count as clear") if inside else ()
    return say("distances measured to the obstacles' centres, not their surfaces", more)


def overlooked(campaign: Campaign, catalogue: Catalogue) -> Spans:
    """The sentence why distances rule out "cleared"; empty if they do not.

    They do if the criterion does not state to which point of the obstacles it measures, and for distances to centres if
    the threshold is inside an obstacle or the extent of one is unknown, unless the campaign states that a centre
    distance is intended. New campaigns with a threshold inside one are refused; campaigns queued or run before that
    rule still reach this check.
    """
    criterion = catalogue.component("criterion", campaign.criterion.component)
    if criterion is None or (criterion.measured_to in ("", "none") and not _unstated(criterion)):
        return ()
    if _unstated(criterion):
        return say(
            f"it is unknown to which point of the obstacles {criterion.title} measures: declare measured_to in its "
            "component (centre, surface, or none if it measures no distance)"
        )
    if not extents.in_metres(criterion):
        return _of_another_unit(criterion)
    if campaign.criterion.from_centre or criterion.measured_to != "centre":
        return ()
    inside = _inside(campaign, catalogue)
    if not inside:
        return say(*(_undeclared(*each) for each in extents.unknown(campaign, catalogue)[:1]))
    path = max(inside, key=lambda p: inside[p])
    return say(
        *(symbol(criterion.quantity), " is measured to the obstacles' centres, and the threshold of "),
        *(limit(campaign.criterion.threshold, "m", "threshold"), f" is inside {path}, whose surface extends to "),
        *(number(inside[path], "m", "reach"), " from its centre: a vehicle inside it would count as clear"),
    )


def declaration(campaign: Campaign, catalogue: Catalogue) -> str:
    """The clause that states what the criterion declares to measure; empty if that is no distance to obstacles."""
    criterion = catalogue.component("criterion", campaign.criterion.component)
    measures = criterion is not None and criterion.measured_to in ("centre", "surface")
    return _declared(criterion) if criterion is not None and measures else ""


def mismeasured(declared: str, found: Mismeasured, unit: str) -> Spans:
    """The sentence that the criterion does not compute the distance that it declares; unit: that of its value."""
    if found.overstated:
        return say(
            *(f"the gap of obstacle {found.obstacle + 1} is no distance to its surface: it counts as "),
            *(
                number(found.value or 0.0, unit, "value", 6),
                " away at a place where, by its gap nearby, it is at most ",
            ),
            *(number(found.distance, "m", "distance", 6), f" away; {GAP}"),
        )
    value = say("no value") if found.value is None else say("the value ", number(found.value, unit, "value", 4))
    return say(
        *(declared, f", but at a place near obstacle {found.obstacle + 1}, where that distance is "),
        *(number(found.distance, "m", "distance", 4), ", it has ", value, f"; {WHAT_TO_DO}"),
    )


def _declared(criterion: ComponentEntry) -> str:
    return f"{criterion.title} declares distances to the obstacles' {criterion.measured_to}s (measured_to)"


def _of_another_unit(criterion: ComponentEntry) -> Spans:
    unit = f"in {criterion.unit}" if criterion.unit else "without a unit"
    return say(f"{_declared(criterion)}, but its value is {unit}, not in m; {WHAT_TO_DO}")


def followed(campaign: Campaign, catalogue: Catalogue) -> bool:
    """Whether the criterion measures distances, which are known beyond what is simulated; a catalogue of an earlier
    version does not state it."""
    criterion = catalogue.component("criterion", campaign.criterion.component)
    return criterion is None or (criterion.measured_to != "none" and not _unstated(criterion))


def _unstated(criterion: ComponentEntry) -> bool:
    stated = criterion.measured_to != "" or "measured_to" not in criterion.model_fields_set
    return criterion.of == "obstacles" and not stated


def _undeclared(number: int, title: str) -> str:
    return (
        f"the extent of obstacle {number + 1} ({title}) is unknown: declare its reach in its component, measure to the "
        "surface, or state from_centre: true if distances to the centre are meant"
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
