"""How the stages end, as templates; the rules of a search method are in its own file."""

from __future__ import annotations

from campaigns.claims.say import amount, count, say
from campaigns.claims.spans import Spans

BUDGET = "used its budget of {budget} evaluations"
NOMINAL = "evaluated the nominal case"
MEASURED = "evaluated the nominal case, and whether results repeat"
BASELINE = "evaluated the findings of the baseline"
CURVES = "evaluated every curve"
SAMPLE = "drew {flights} samples"
TARGET = "drew {flights} samples, of which more count as violations than the target allows"
GRID = "drew {flights} samples and evaluated a grid of {grid}"
NOTHING = "no evaluation succeeded"
FINDINGS = "polished every distinct worst case and evaluated its neighbours"


def confirmed(kept: int, at_most: int) -> Spans:
    """Fewer worst cases than were distinguished are stored, because confirming all takes too many evaluations."""
    cases = "worst case" if kept == 1 else "worst cases"
    only = say("only ", count(kept, "kept"), f" {cases} could be confirmed")
    return say(only, ", because validation is limited to ", count(at_most, "at_most"), " evaluations")


def skipped(points: int, at_most: int) -> Spans:
    """Descents that were left out."""
    of = say("no local search began at ", amount(points, "low point", "points"))
    return say(of, ", because validation is limited to ", count(at_most, "at_most"), " evaluations")


def by_validation(ended: Spans) -> Spans:
    """How the search for distinct worst cases ended, as a clause with its subject."""
    return say("validation ", ended)


def gathered(ended: Spans, complete: bool) -> Spans:
    """How the findings were distinguished."""
    return ended if complete else say("some findings may be duplicates, or not fully polished: ", ended)
