"""What is left of validation's allowance once the worst cases are distinguished: every confirmation takes from it.

What must be confirmed whatever is left (`campaigns.asked.allowance.least`) is part of the allowance; all other cases
are confirmed as far as it goes, and what is left out is counted for the result.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from campaigns import Campaign
from campaigns.asked import allowance
from campaigns.limits import SPOT_CHECKS
from campaigns.results.validate import LeftOut, Spent


@dataclass
class Left:
    """The rest of the allowance: evaluations that may still be made, besides the least that is reserved."""

    campaign: Campaign
    noisy: bool
    stored: int
    made: int = 0
    out: dict[str, int] = field(default_factory=dict)

    @property
    def room(self) -> int:
        """Evaluations beyond the reserved ones."""
        total = allowance.validation(self.campaign, self.noisy).total
        reserved = allowance.least(self.campaign, self.noisy)
        return max(0, total - self.stored - reserved - self.made)

    def findings(self, count: int) -> int:
        """How many of so many findings are confirmed; the first one is reserved."""
        return min(
            count, 1 + self._taken("findings", count - 1, allowance.finding(self.campaign, self.noisy), self.room)
        )

    def cases(self, count: int) -> int:
        """How many of so many cases of the baseline that do not violate here are confirmed."""
        return self._taken("cases", count, allowance.case(self.campaign, self.noisy), self.room)

    def violations(self, count: int, each: int) -> int:
        """How many of so many violations are simulated again; half of what is left goes to random evaluations."""
        return self._taken("violations", count, each, max(self.room - SPOT_CHECKS, self.room // 2))

    def called_again(self, count: int) -> int:
        """How many violations of a simulator that does not repeat are called as often as a finding."""
        return self._taken("calls", count, allowance.case(self.campaign, self.noisy), self.room)

    def spot_checks(self, count: int) -> int:
        """How many of so many random evaluations are compared."""
        return self._taken("spot_checks", count, 1, self.room)

    def spent(self) -> Spent:
        """The allowance and what was left out of it."""
        total = allowance.validation(self.campaign, self.noisy).total
        return Spent(at_most=total, stored=self.stored, left_out=LeftOut(**self.out))

    def _taken(self, what: str, count: int, each: int, room: int) -> int:
        taken = max(0, min(count, room // each))
        self.made += taken * each
        if taken < count:
            self.out[what] = self.out.get(what, 0) + count - taken
        return taken
