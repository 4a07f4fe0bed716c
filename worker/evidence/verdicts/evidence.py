"""The evidence that a verdict is based on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from campaigns import rules
from campaigns.claims.say import Part, say
from campaigns.codes import CheckCode
from campaigns.results import Finding, SearchResult, StageResult, ValidateResult
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.nominal import NominalCase
from campaigns.results.sample import Certificate, Sample
from campaigns.results.sureness import Sureness
from campaigns.results.validate import Encounter, Gathered, SpotChecks, Violations
from campaigns.results.verdict import Check

P = TypeVar("P")
R = TypeVar("R", bound=StageResult)


@dataclass(frozen=True)
class Evidence:
    """The results of the stages in the order of the run, the worst finding, the counts of all evaluations, stored or
    only counted."""

    results: Sequence[StageResult]
    finding: Finding | None
    evaluations: int
    failed: int
    excluded: int
    """By the criterion's precondition, or by a simulator."""
    lowest: float | None = None
    """The lowest cost of all evaluations of any stage."""
    violating: int = 0
    """How many evaluations violate the criterion."""
    counted: int = 0
    """How many of them are counted and not stored."""
    flaky: int = 0
    """How many evaluations succeeded only when a failed call was tried again."""
    exclusions: Mapping[str, int] = field(default_factory=dict)
    """How many evaluations were excluded for each reason."""
    others: Sequence[Finding] = ()
    """The findings that are not the worst."""
    sureness: Sureness | None = None
    """The estimate from the stored evaluations of the search, whether or not they repeat; no check rests on it."""

    @staticmethod
    def of(
        results: Sequence[StageResult],
        findings: Sequence[Finding],
        threshold: float,
        sureness: Sureness | None,
        *,
        costs: NDArray[np.float64],
        status: NDArray[np.uint8],
        flaky: int,
        exclusions: Mapping[str, int],
    ) -> Evidence:
        """What the stored evaluations and the results show: first costs and status (m,), how many are flaky, how many
        were excluded for each reason; of a counted sample the lowest flight is always stored."""
        beside = [result.beside for result in results]
        ok = costs[status == OK]
        excluded = int(np.count_nonzero(status == EXCLUDED))
        counted = sum(one.evaluations for one in beside)
        return Evidence(
            results=results,
            finding=findings[0] if findings else None,
            others=findings[1:],
            evaluations=len(status) + counted,
            failed=len(status) - len(ok) - excluded + sum(one.failed for one in beside),
            excluded=excluded + sum(one.excluded for one in beside),
            lowest=float(ok.min()) if len(ok) else None,
            violating=int(np.count_nonzero(ok <= threshold)) + sum(one.violating for one in beside),
            counted=counted,
            flaky=flaky + sum(one.flaky for one in beside),
            exclusions=sum((Counter(one.exclusions) for one in beside), Counter(exclusions)),
            sureness=sureness,
        )

    @cached_property
    def nominal(self) -> NominalCase:
        """The nominal case, with which every run begins."""
        (found,) = (r.at_nominal for r in self.results if r.at_nominal is not None)
        return found

    @cached_property
    def searches(self) -> list[SearchResult]:
        """What the methods found, in the order of the campaign."""
        return self._of(SearchResult)

    @cached_property
    def certificate(self) -> Certificate | None:
        """The independent sample, if the campaign requests one."""
        return next((r.certificate for r in self.results if r.certificate is not None), None)

    @cached_property
    def validation(self) -> ValidateResult:
        """What was confirmed by independent means, with which every run ends."""
        return self._of(ValidateResult)[0]

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
        """The worst finding that violates and was confirmed, by what every integration of it grants.

        None if every stored violation was evaluated again and none violates there: then what confirms it contradicts
        itself. Of a simulator that does not repeat, another call may well give another value.
        """
        found = [f for f in self.findings if f.violates]
        counts = self.validation.violations
        again = counts is None or not counts.checked or counts.confirmed > 0
        called = any(f.validation is not None and f.validation.repeats is not None for f in found)
        return min(found, key=lambda f: f.granted, default=None) if again or called else None

    @property
    def encounter(self) -> Encounter:
        """The evidence that the encounter took place."""
        return _stored(self.validation.encounter)

    @property
    def violations(self) -> Violations:
        """The counts of stored violations."""
        return _stored(self.validation.violations)

    @property
    def spot_checks(self) -> SpotChecks:
        """Random evaluations with the reference integrator."""
        return _stored(self.validation.spot_checks)

    @property
    def gathered(self) -> Gathered:
        """How the findings of the run were distinguished."""
        return _stored(self.validation.findings)

    @property
    def sample(self) -> Sample | None:
        """The independent sample that supports a claim on probability: that of the certify stage; without one, that of
        the first random search whose points are independent. Both are declared in the campaign."""
        searched = [s.sample for s in self.searches if rules.FAMILIES[s.kind].samples and s.sample is not None]
        samples = [self.certificate.sample] if self.certificate is not None else searched
        return next((s for s in samples if s.upper_bound is not None), None)

    def _of(self, kind: type[R]) -> list[R]:
        return [result for result in self.results if isinstance(result, kind)]


def check(code: CheckCode | str, ok: bool, *statement: Part) -> Check:
    """One check with its sentence."""
    return Check(code=code, ok=ok, statement=say(*statement))


def _stored(part: P | None) -> P:
    """A part of the validate stage's result; only runs of earlier versions lack one, and these get no new verdict."""
    if part is None:
        raise ValueError("the validate stage was carried out by an earlier version: run the campaign again")
    return part
