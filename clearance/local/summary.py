"""The summary of a run in this process: what `--json` prints and result.json contains."""

from __future__ import annotations

from collections.abc import Mapping

from campaigns import Campaign
from campaigns.identity.identity import identity_of, simulator_of
from campaigns.results import Finding, SearchResult, ValidateResult, Verdict, verdicts
from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from campaigns.results.sample import Beside
from clearance.local.failures import failures, not_stored
from clearance.local.likelihood import Likelihoods, likelihoods
from worker.running.runs.store import MemoryStore

MOST_FAILURES = 200
"""Distinct reasons of failed evaluations in a result."""


def summary(
    campaign: Campaign, store: MemoryStore, verdict: Verdict, likely: Likelihoods | None = None
) -> dict[str, object]:
    """The content of `--json` and result.json; likely: computed already."""
    validated = confirmed(store)
    parts = verdict.model_dump(mode="json")
    likely = likely or likelihoods(campaign, store, verdict.unit)
    return {
        "verdict": verdict.verdict,
        "reason": verdict.reason,
        **{name: parts[name] for name in ("sentence", "scope", "statement", "holds_for", "values")},
        "nominal": parts["nominal"],
        "worst": None if verdict.worst is None else verdict.worst.model_dump(exclude={"finding"}),
        "stages": [_stage(store, position) for position in range(len(store.stages))],
        "comparison": [] if validated is None else [row.model_dump() for row in validated.comparison],
        "evaluations": parts["evaluations"],
        "checks": [check.model_dump() for check in verdicts.checks_of(verdict)],
        "statistics": parts["statistics"],
        **{name: parts[name] for name in ("regression", "sureness") if name in parts},
        "findings": [_finding(likely.stated(finding), campaign.criterion.threshold) for finding in store.findings],
        **({} if likely.violation is None else {"most_likely_violation": likely.violation.model_dump()}),
        **({"failures": [vars(one) for one in lost[:MOST_FAILURES]]} if (lost := failures(store)) else {}),
        **({"failures_not_stored": more} if (more := not_stored(store)) else {}),
        "digest": campaign.digest,
        "seed": campaign.seed,
        "identity": identity_of(verdict.provenance, simulator_of(campaign)).model_dump(mode="json"),
        "versions": {
            k: parts["provenance"][k] for k in ("clearance", "wording", "code", "python", "packages", "cpu", "loop")
        }
        | {k: parts["provenance"][k] for k in ("components", "simulator", "command") if k in parts["provenance"]},
    }


def confirmed(store: MemoryStore) -> ValidateResult | None:
    """What the run confirmed at its end; None if it did not come to that."""
    result = store.stages[-1].result
    return result if isinstance(result, ValidateResult) else None


def searched(store: MemoryStore, position: int) -> SearchResult | None:
    """What the method of a stage found; None for any other stage."""
    result = store.stages[position].result
    return result if isinstance(result, SearchResult) else None


def made(store: MemoryStore, position: int) -> tuple[int, int, int]:
    """The evaluations of a stage, stored or only counted, and how many of them failed and were excluded."""
    columns, result = store.evaluations(position), store.stages[position].result
    status = [] if columns is None else columns.status.tolist()
    beside = Beside() if result is None else result.beside
    failed = status.count(FAILED) + status.count(TIMEOUT) + beside.failed
    return len(status) + beside.evaluations, failed, status.count(EXCLUDED) + beside.excluded


def _finding(finding: Finding, threshold: float) -> Mapping[str, object]:
    margin = finding.margin if finding.granted == finding.cost else finding.granted - threshold
    return finding.model_dump() | {"granted": finding.granted, "margin": margin}


def _stage(store: MemoryStore, position: int) -> dict[str, object]:
    record, columns = store.stages[position], store.evaluations(position)
    result = record.result
    status = [] if columns is None else columns.status.tolist()
    best = None
    if columns is not None and status.count(OK):
        best = float(columns.costs[columns.status == OK, 0].min())
    stop, search = None if result is None else result.ended, searched(store, position)
    return {
        "kind": record.plan.kind,
        "method": record.plan.method,
        "best": best,
        **dict(zip(("evaluations", "failed", "excluded"), made(store, position), strict=True)),
        "seconds": record.seconds,
        "stop": None if stop is None else stop.text,
        "minima": [] if search is None else [minimum.model_dump() for minimum in search.minima],
    }
