"""The sentence on a value at or below the threshold that a run without a verdict has found."""

from __future__ import annotations

from campaigns.claims.say import limit, on_side, say
from campaigns.claims.spans import Spans
from campaigns.runs import RunState

WITHOUT_VERDICT = (RunState.CANCELLED, RunState.FAILED)
"""How a run ends that has no verdict."""


def unconfirmed(state: str, lowest: float | None, threshold: float | None, unit: str) -> Spans:
    """The lowest value that a cancelled or failed run found, where it is at or below the threshold; empty otherwise.

    Such a value speaks against a requirement all the same, so every place that states the run states it."""
    if state not in WITHOUT_VERDICT or lowest is None or threshold is None or not lowest <= threshold:
        return ()
    return say(
        *("The lowest value found is ", on_side(lowest, threshold, unit)),
        *(", at or below the threshold of ", limit(threshold, unit), "; no verdict confirms it."),
    )
