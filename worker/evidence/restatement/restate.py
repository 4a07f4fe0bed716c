"""Makes the verdict of a stored run again from its results, for its sentences: `restated`.

The rules and templates are those that every run uses, so that any other word in a record shows; whether the numbers are
right is judged by the audit, which shares no code with them. Nothing is evaluated, and nothing of the record executed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from pydantic import ValidationError

from campaigns.claims.spans import Spans
from campaigns.documents import JsonObject
from campaigns.results import Finding, Verdict
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.validate import ValidateResult
from campaigns.stages.found import stage_result
from campaigns.versions import Versions
from worker.engine.problem.problem import Problem
from worker.evidence.audit.record import MISSING, Missing, Record
from worker.evidence.audit.sentences import alike
from worker.evidence.scopes.recorded import systems
from worker.evidence.verdicts.conclude import conclude
from worker.evidence.verdicts.evidence import Evidence
from worker.evidence.verdicts.validation import worded

UNREADABLE = (ValidationError, ValueError, KeyError, TypeError, AttributeError, IndexError, AssertionError)
"""How a verdict cannot be made of results that are not those of a run."""


class Sentence(NamedTuple):
    """One sentence: as stored, which may be anything, and as it is made again."""

    stored: Any
    made: Spans


def restated(record: Record) -> dict[str, Sentence] | Missing:
    """Every sentence of the verdict and of the validation by its path in the record, or why there are none."""
    claims = record.claims
    try:
        versions = Versions.of(claims["versions"] if "versions" in claims else claims["provenance"])
        scope = "".join(str(span.get("text", "")) for span in claims["holds_for"])
        made = [_made(record, Problem(record.campaign, of), versions) for of in systems_of(record, versions, scope)]
    except UNREADABLE:
        return MISSING
    known = [sentences for sentences in made if sentences is not None]
    if not known:
        return Missing("it cannot be made again from what is stored")
    found = max(known, key=lambda sentences: sum(alike(one.stored, one.made) for one in sentences.values()))
    if record.campaign.simulator is not None and not alike(*found["holds_for"]):
        return Missing("the package of the simulator may have worded it")
    return found


def systems_of(record: Record, versions: Versions, scope: str) -> Any:
    """The systems that the record may be of."""
    return systems(record.campaign, record.claims["components"], versions, scope)


def _made(record: Record, problem: Problem, versions: Versions) -> dict[str, Sentence] | None:
    """None if the results are not those of a run."""
    try:
        findings = [Finding.model_validate(found) for found in record.claims["findings"]]
        results = [stage_result(result) for result in record.claims["results"]]
        evidence = Evidence(
            results=[worded(problem, result, findings) for result in results],
            finding=findings[0] if findings else None,
            others=findings[1:],
            **_counts(record),
        )
        verdict = conclude(problem, evidence, versions)
    except UNREADABLE:
        return None
    return _sentences(record.claims, verdict, evidence.validation)


def _counts(record: Record) -> JsonObject:
    status, ok = record.status, record.costs[record.status == OK, 0]
    return {
        "evaluations": len(status),
        "failed": int(np.count_nonzero((status != OK) & (status != EXCLUDED))),
        "excluded": int(np.count_nonzero(status == EXCLUDED)),
        "lowest": float(ok.min()) if len(ok) else None,
        "violating": int(np.count_nonzero(ok <= record.campaign.criterion.threshold)),
        "flaky": 0 if isinstance(record.flaky, Missing) else record.flaky,
    }


def _sentences(claims: JsonObject, verdict: Verdict, validation: ValidateResult) -> dict[str, Sentence]:
    stored = {check["name"]: check.get("statement") for check in claims["checks"]}
    last = claims["results"][-1]
    found = {name: Sentence(claims[name], getattr(verdict, name)) for name in ("statement", "holds_for")}
    found |= {f"checks.{c.name}": Sentence(stored.pop(c.name, None), c.statement) for c in verdict.checks}
    found |= {f"checks.{name}": Sentence(spans, ()) for name, spans in stored.items()}
    found["validation"] = Sentence(last.get("statement"), validation.statement)
    for name in ("violations", "spot_checks"):
        part = getattr(validation, name)
        found[f"validation.{name}"] = Sentence(last[name].get("statement"), part.statement)
    if verdict.statistics is not None:
        found["statistics"] = Sentence(claims["statistics"].get("statement"), verdict.statistics.statement)
    if verdict.regression is not None:
        changes = claims["regression"]
        found["regression"] = Sentence(changes.get("statement"), verdict.regression.statement)
        for k, (was, case) in enumerate(zip(changes["cases"], verdict.regression.cases, strict=False)):
            found[f"regression.cases.{k}"] = Sentence(was.get("statement"), case.statement)
    return found
