"""How the stages end, as templates; the rules of a search method are in its own file."""

from __future__ import annotations

from campaigns.claims.say import say
from campaigns.claims.spans import Spans

BUDGET = "used its budget of {budget} evaluations"
NOMINAL = "evaluated the nominal case"
MEASURED = "evaluated the nominal case, and whether results repeat"
BASELINE = "evaluated the findings of the baseline"
CURVES = "evaluated every curve"
SAMPLE = "drew {flights} samples"
GRID = "drew {flights} samples and evaluated a grid of {grid}"
NOTHING = "no evaluation succeeded"
FINDINGS = "polished every distinct worst case and evaluated its neighbours"


def gathered(ended: Spans, complete: bool) -> Spans:
    """How the findings were distinguished."""
    return ended if complete else say(ended, ": some findings may be duplicates, or not fully polished")
