"""The verdict of a run: what may be claimed, the checks behind it, and what a number is repeated from.

Start reading at `Verdict`.
"""

from __future__ import annotations

from typing import Literal

from campaigns.flown import Flown
from campaigns.results.base import Result, Values
from campaigns.results.sample import Noise, QuantileBound

VerdictWord = Literal["cleared", "violated", "inconclusive"]


class Check(Result):
    """One condition of "cleared": its name, whether it holds, and the sentence that says so."""

    name: str
    """`campaigns.results.verdicts` lists them with their titles."""
    ok: bool
    text: str


class Statistics(Result):
    """The statement of the independent sample."""

    samples: int
    violations: int
    failed: int | None = None
    """Counted among the violations."""
    excluded: int | None = None
    excluded_fraction: float | None = None
    confidence: float
    upper_bound: float
    noise: Noise | None = None
    quantile: QuantileBound | None = None
    source: Literal["search", "certify"] = "certify"
    text: str


class Worst(Result):
    """The worst finding."""

    cost: float
    margin: float
    parameters: Values
    method: str | None
    """With the lowest best."""
    finding: str


class NominalCost(Result):
    """The nominal case."""

    cost: float | None
    margin: float | None


class Counts(Result):
    """All stored evaluations of the run."""

    stored: int
    succeeded: int
    failed: int
    excluded: int
    violating: int = 0
    lowest: float | None = None


class Provenance(Flown):
    """What a number is repeated from: the campaign, the seed and what flew."""

    digest: str | None = None
    """Of the campaign."""
    seed: int | None = None


class Verdict(Result):
    """The conclusion of a run with everything that stands behind it."""

    verdict: VerdictWord
    sentence: str
    scope: str
    """What the sentence holds for."""
    checks: list[Check]
    statistics: Statistics | None = None
    nominal: NominalCost | None = None
    worst: Worst | None = None
    evaluations: Counts | None = None
    quantity: str = ""
    unit: str = ""
    provenance: Provenance = Provenance()

    @property
    def reason(self) -> str:
        """Sentence and scope."""
        return f"{self.sentence} {self.scope}".strip()
