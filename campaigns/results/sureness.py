"""How sure a search is: the estimated chance that another one of the same budget finds a lower case."""

from __future__ import annotations

from campaigns.results.base import Described


class Sureness(Described):
    """An estimate from searches on random landscapes, never a bound; it enters no verdict.

    It says nothing of a case that this kind of search cannot find.
    """

    chance: float
    """Of another search, with another seed and the same budget, to find a case lower by more than `lower`."""
    lower: float
    """A hundredth of nominal minus worst, in the criterion's unit."""
    landscapes: int
    """Random landscapes on which it was set; the statement has how many parameters they have."""
