"""Makes the verdict of a stored run again from its results, for its sentences: `restated`.

The rules and templates are those that every run uses, so that any other word in a record shows; whether the numbers are
right is judged by the audit, which shares no code with them. Nothing is evaluated, and nothing of the record executed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from pydantic import ValidationError

from campaigns.claims.say import say
from campaigns.claims.spans import Spans
from campaigns.claims.wording import reworded
from campaigns.results import Finding, Verdict
from campaigns.results.verdict import Check
from campaigns.results.verdicts import described
from campaigns.stages.found import stage_result
from campaigns.versions import Versions
from worker.engine.problem.problem import Problem
from worker.evidence.audit.record import MISSING, Missing, Record
from worker.evidence.audit.sentences import alike
from worker.evidence.scopes import stored_system
from worker.evidence.verdicts.conclude import conclude
from worker.evidence.verdicts.evidence import Evidence
from worker.evidence.verdicts.sureness import Stored, sureness
from worker.evidence.verdicts.validation import worded

UNREADABLE = (ValidationError, ValueError, KeyError, TypeError, AttributeError, IndexError, AssertionError)
"""How a verdict cannot be made of results that are not those of a run."""


SHOWN = {"code", "name", "title", "standing", "limit", "but", "remedies"}
OF_PACKAGE = ("holds_for", "checks.repetition", "validation", "validation.violations", "validation.spot_checks")
"""Sentences for which a package may state terms of its own simulator; and that of a cleared verdict."""


class Sentence(NamedTuple):
    """One sentence: as stored, which may be anything, and as it is made again; or why it is not."""

    stored: Any
    made: Spans | Missing


def restated(record: Record) -> dict[str, Sentence] | Missing:
    """Every sentence of the verdict and of the validation by its path in the record."""
    claims = record.claims
    if "components" not in claims or "holds_for" not in claims:
        return Missing(MISSING)
    try:
        versions = Versions.of(claims["versions"] if "versions" in claims else claims["provenance"])
        if by := reworded(versions):
            return Missing(f"{by} worded it")
        scope = "".join(str(span.get("text", "")) for span in claims["holds_for"])
        systems = stored_system.systems(record.campaign, claims["components"], versions, scope)
        made = [_made(record, Problem(record.campaign, system), versions) for system in systems]
        found = max(made, key=lambda sentences: sum(alike(*one) for one in sentences.values()))
    except UNREADABLE as error:
        why = say(f"no verdict follows from what is stored: {type(error).__name__}")
        return {"statement": Sentence(claims.get("statement"), why)}
    if record.campaign.simulator is None or alike(*found["holds_for"]):
        return found
    of_package = {*OF_PACKAGE, *(["statement"] if claims["verdict"] == "cleared" else [])}
    worded = Missing("the package of the simulator may have worded it")
    return {
        path: one if path not in of_package or alike(*one) else one._replace(made=worded) for path, one in found.items()
    }


def titles(record: Record) -> dict[str, tuple[Any, Any]]:
    """How the checks of a folder are shown, besides their sentences: as stored, and as it follows from them."""
    found: dict[str, tuple[Any, Any]] = {}
    failed = (record.claims.get("evaluations") or {}).get("failed", 0)
    for stored in record.claims["checks"] if "versions" in record.claims else ():
        try:
            (made,) = described([Check.model_validate(stored)], failed)
        except UNREADABLE:
            continue
        shown = made.model_dump(mode="json", include=SHOWN)
        found[str(made.code)] = ({key: stored.get(key) for key in shown}, shown)
    return found


def _made(record: Record, problem: Problem, versions: Versions) -> dict[str, Sentence]:
    findings = [Finding.model_validate(found) for found in record.claims["findings"]]
    results = [stage_result(result) for result in record.claims["results"]]
    rows = {k: record.stage == k for k in range(len(results))}
    stored = {k: Stored(record.costs[here], record.status[here]) for k, here in rows.items()}
    again = 0 if isinstance(record.flaky, Missing) else record.flaky
    worded_results = [worded(problem, result, findings) for result in results]
    threshold = record.campaign.criterion.threshold
    sure = sureness(problem, results, stored, (record.claims.get("sureness") or {}).get("landscapes"))
    evidence = Evidence.of(
        *(worded_results, findings, threshold, sure),
        costs=record.costs[:, 0], status=record.status, flaky=again, exclusions=record.exclusions,
    )  # fmt: skip
    verdict = conclude(problem, evidence, versions)
    return _sentences(record, verdict, evidence)


def _sentences(record: Record, verdict: Verdict, evidence: Evidence) -> dict[str, Sentence]:
    claims, validation = record.claims, evidence.validation
    stored = {check["name"]: check.get("statement") for check in claims["checks"]}
    last = claims["results"][-1]
    found = {name: Sentence(claims[name], getattr(verdict, name)) for name in ("statement", "holds_for")}
    found |= {f"checks.{c.name}": Sentence(stored.pop(c.name, None), c.statement) for c in verdict.checks}
    found |= {f"checks.{name}": Sentence(spans, ()) for name, spans in stored.items()}
    parts: dict[str, tuple[Any, Any]] = {"validation": (last, validation)}
    parts |= {f"validation.{name}": (last[name], getattr(validation, name)) for name in ("violations", "spot_checks")}
    if verdict.sureness is not None:
        parts["sureness"] = claims.get("sureness") or {}, verdict.sureness
    if verdict.statistics is not None:
        parts["statistics"] = claims["statistics"], verdict.statistics
        if verdict.statistics.quantile is not None:
            parts["statistics.quantile"] = claims["statistics"]["quantile"], verdict.statistics.quantile
    if verdict.regression is not None:
        pairs = zip(claims["regression"]["cases"], verdict.regression.cases, strict=False)
        parts["regression"] = claims["regression"], verdict.regression
        parts |= {f"regression.cases.{k}": pair for k, pair in enumerate(pairs)}
    return found | {path: Sentence(stored.get("statement"), made.statement) for path, (stored, made) in parts.items()}
