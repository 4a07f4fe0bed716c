"""What a verdict is drawn from, and what a check is.

Start reading at `Evidence`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from worker.stages.parts.store import Finding

Verdict = Literal["cleared", "violated", "inconclusive"]


@dataclass(frozen=True)
class Check:
    """One condition of "cleared": its name, whether it holds, and the sentence that says so."""

    name: str
    ok: bool
    text: str


@dataclass(frozen=True)
class Evidence:
    """What the stages found: results by kind, the worst finding, and the counts of all stored evaluations."""

    nominal: dict[str, Any]
    searches: list[dict[str, Any]]
    validation: dict[str, Any]
    finding: Finding | None
    evaluations: int
    failed: int
    excluded: int
    lowest: float | None = None
    """The lowest cost of all stored evaluations, whichever stage asked for it."""
    violating: int = 0
    """How many stored evaluations violate the criterion."""
    complete: bool = True
    certificate: dict[str, Any] | None = None
    others: Sequence[Finding] = ()
    """The findings that are not the worst."""

    @property
    def succeeded(self) -> int:
        """The evaluations that have a cost."""
        return self.evaluations - self.failed - self.excluded

    @property
    def findings(self) -> list[Finding]:
        """All findings, the worst first."""
        return [] if self.finding is None else [self.finding, *self.others]

    @property
    def violation(self) -> Finding | None:
        """The worst finding that violates and was confirmed: every integration of it violates."""
        known = [f for f in self.findings if f.margin <= 0 and f.validation["violates"]]
        return min(known, key=lambda f: f.cost) if known else None

    @property
    def sample(self) -> dict[str, Any] | None:
        """The independent sample that a probability is claimed from: that of the certify stage; without one, that of
        the first random search whose points are independent. Either was declared with the campaign."""
        searched = [s["sample"] for s in self.searches if s["kind"] == "random" and s["sample"]]
        samples = [self.certificate["sample"]] if self.certificate is not None else searched
        found = next((s for s in samples if s["upper_bound"] is not None), None)
        # A stage that an earlier version carried out reports neither: it simulated the stated realisations.
        return None if found is None else {"noise": "stated", "excluded_fraction": 0.0} | found
