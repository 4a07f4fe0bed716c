"""The verdict: what may be claimed from a run's stages, with the sentence that explains it and its scope.

violated: a finding at or below the threshold that every integration confirms. cleared: every check holds. Anything else
is inconclusive, with the reasons. No verdict is based on one method or on the statistical bound alone, and none is
"cleared" with a stored evaluation at or below the threshold.
"""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.codes import CheckCode
from campaigns.results import Verdict
from campaigns.results.verdict import Check, Counts, NominalCost, Provenance, VerdictWord, Worst
from campaigns.versions import Versions
from worker.engine.problem.problem import Problem
from worker.evidence.verdicts.checks import checks
from worker.evidence.verdicts.evidence import Evidence
from worker.evidence.verdicts.probability import statistics
from worker.evidence.verdicts.regression import regression
from worker.evidence.verdicts.sentence import method_of, scope, sentence


def conclude(problem: Problem, evidence: Evidence, versions: Versions) -> Verdict:
    """The verdict on the evidence, with everything that supports it."""
    campaign = problem.campaign
    found, stated = checks(problem, evidence), statistics(evidence)
    verdict = _verdict(problem, found, evidence)
    return Verdict(
        verdict=verdict,
        statement=sentence(problem, evidence, verdict, found, stated),
        holds_for=scope(problem, evidence.encounter.mismeasured is None),
        checks=found,
        statistics=stated,
        nominal=NominalCost(cost=evidence.nominal.cost, margin=evidence.nominal.margin),
        worst=_worst(evidence, problem.threshold),
        evaluations=Counts(
            stored=evidence.evaluations - evidence.counted,
            succeeded=evidence.succeeded,
            failed=evidence.failed,
            excluded=evidence.excluded,
            violating=evidence.violating,
            lowest=evidence.lowest,
            flaky=evidence.flaky,
            counted=evidence.counted,
        ),
        quantity=problem.quantity,
        unit=problem.unit,
        provenance=Provenance(**versions.model_dump(), digest=campaign.digest, seed=campaign.seed),
        regression=regression(problem, evidence, found),
        # Of results that do not repeat another search says nothing.
        sureness=evidence.sureness if all(c.ok for c in found if c.code == CheckCode.CALLS) else None,
    )


def _worst(evidence: Evidence, threshold: float) -> Worst | None:
    finding = evidence.violation or evidence.finding
    if finding is None:
        return None
    return Worst(
        cost=finding.granted,
        margin=finding.granted - threshold,
        evaluated=finding.cost,
        parameters=finding.parameters,
        method=method_of(finding, evidence),
        finding=finding.label,
    )


def _verdict(problem: Problem, found: Sequence[Check], evidence: Evidence) -> VerdictWord:
    if evidence.violation is not None:
        if (value := evidence.violation.granted) > problem.threshold:
            raise AssertionError(f"the value to state for a violation is {value}, above {problem.threshold}")
        return VerdictWord.VIOLATED
    cleared = all(c.ok for c in found)
    # The invariant, independent of the checks.
    if cleared and (evidence.lowest is None or evidence.lowest <= problem.threshold or evidence.violating):
        raise AssertionError(
            f"every check holds although a stored evaluation has {evidence.lowest}, at or below {problem.threshold}"
        )
    cases = [v for v in (evidence.validation.nominal, *(f.validation for f in evidence.findings)) if v is not None]
    cases += [*(best.validation for best in evidence.validation.incumbents), *evidence.validation.passing]
    if cleared and any(v.repeats is not None and (v.repeats.violating or v.repeats.failed) for v in cases):
        raise AssertionError("every check holds although an independent call of the simulator violates or fails")
    return VerdictWord.CLEARED if cleared else VerdictWord.INCONCLUSIVE
