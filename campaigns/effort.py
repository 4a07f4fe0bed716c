"""What a search method states of its effort: how many evaluations it takes if its own rule ends it before its budget.

Plain dataclasses, which a method's file declares and the catalogue contains. `campaigns.checked.expected` reads them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Iterations:
    """The method ends after so many iterations as an option states, if the campaign states it.

    An iteration takes `each` evaluations per parameter where there are 100; per iteration, this grows with their number
    to the power `growth`. `spread`: the least and the largest multiple of the usual number.
    """

    option: str
    each: float
    growth: float
    spread: tuple[float, float]


@dataclass(frozen=True)
class Descents:
    """The method ends when the descents from all its starts have ended; an option states how many starts.

    In gradients per descent: usually by central differences, at least by forward ones, and at most per square of the
    number of parameters.
    """

    option: str
    usual: int
    least: int
    growth: float
