"""The verdict: what may be claimed from a run's stages, with the sentence that says why and the scope it holds for.

violated: a finding at or below the threshold that every integration confirms. cleared: every check holds. Anything else
is inconclusive, with the reasons. No verdict rests on one method or on the statistical bound alone, and none is
"cleared" with a stored evaluation at or below the threshold. Start reading at `conclude`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from worker.stages.parts.store import Conclusion
from worker.systems.problem import Problem
from worker.verdicts.checks import checks
from worker.verdicts.evidence import Check, Evidence, Verdict
from worker.verdicts.probability import statistics
from worker.verdicts.sentence import method_of, scope, sentence


def conclude(problem: Problem, evidence: Evidence, provenance: dict[str, Any]) -> Conclusion:
    """The verdict over the evidence, and everything that stands behind it."""
    campaign, finding = problem.campaign, evidence.finding
    found = checks(problem, evidence)
    verdict = _verdict(problem, found, evidence)
    said = statistics(evidence)
    text, holds = sentence(problem, evidence, verdict, found, said), scope(problem)
    method = method_of(evidence.searches)
    worst = None
    if finding is not None:
        worst = {
            "cost": finding.cost,
            "margin": finding.margin,
            "parameters": finding.parameters,
            "method": method,
            "finding": finding.label,
        }
    summary = {
        "verdict": verdict,
        "sentence": text,
        "scope": holds,
        "checks": [asdict(c) for c in found],
        "statistics": said,
        "nominal": {"cost": evidence.nominal["cost"], "margin": evidence.nominal["margin"]},
        "worst": worst,
        "evaluations": {
            "stored": evidence.evaluations,
            "succeeded": evidence.succeeded,
            "failed": evidence.failed,
            "excluded": evidence.excluded,
            "violating": evidence.violating,
            "lowest": evidence.lowest,
        },
        "quantity": problem.parts.criterion.quantity,
        "unit": problem.parts.criterion.unit,
        "provenance": provenance | {"digest": campaign.digest, "seed": campaign.seed},
    }
    return Conclusion(
        verdict=verdict,
        reason=f"{text} {holds}",
        nominal_cost=evidence.nominal["cost"],
        worst_cost=None if finding is None else finding.cost,
        worst_method=method,
        summary=summary,
    )


def _verdict(problem: Problem, found: Sequence[Check], evidence: Evidence) -> Verdict:
    if evidence.violation is not None:
        return "violated"
    cleared = all(c.ok for c in found)
    # The invariant, whatever the checks are made of.
    if cleared and (evidence.lowest is None or evidence.lowest <= problem.threshold or evidence.violating):
        raise AssertionError(
            f"every check holds although a stored evaluation has {evidence.lowest}, at or below {problem.threshold}"
        )
    return "cleared" if cleared else "inconclusive"
