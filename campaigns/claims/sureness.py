"""The sentence on how sure a search is: one wherever it is stated."""

from __future__ import annotations

from campaigns.claims.say import amount, count, number, probability, say
from campaigns.claims.spans import Spans
from campaigns.rules import SAME_COST
from campaigns.rules import percent as fraction


def sureness(
    chance: float, lower: float, unit: str, landscapes: int, parameters: tuple[int, int] | None = None
) -> Spans:
    """The estimate, and what it is not; parameters: the fewest and the most of the landscapes, where they are known."""
    return say(
        "Estimated chance that another search of the same budget finds a case lower by more than ",
        *(number(lower, unit, "lower", 3), f" ({fraction(SAME_COST)} of nominal minus worst): about "),
        *(probability(chance, 2, "chance"), ". Estimated from ", count(landscapes, "landscapes")),
        *(" random landscapes", _of(parameters), ", "),
        "not a bound; it says nothing of a case that this kind of search cannot find, and no verdict rests on it",
    )


def _of(parameters: tuple[int, int] | None) -> Spans:
    if parameters is None:
        return ()
    fewest, most = parameters
    if fewest == most:
        return say(" of ", amount(most, "parameter"))
    return say(" of ", count(fewest), " to ", amount(most, "parameter"))
