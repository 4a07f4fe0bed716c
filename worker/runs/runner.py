"""Runs a campaign stage by stage into a store, and resumes what a store holds already.

Start reading at `execute`. The order of stages is `campaigns.asked.plan`; what each does is in `worker.stages`.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.asked.plan import plan
from worker.runs.provenance import begin, provenance
from worker.search.base import EXCLUDED, OK
from worker.stages import certify, nominal, search, sensitivity, validate
from worker.stages.parts.base import Cancelled, Context, ReplayMismatch, Tally, all_columns
from worker.stages.parts.store import Conclusion, Finding, StagePlan, StageRecord, Store, Trace
from worker.systems.evaluate import InProcess
from worker.systems.problem import CampaignUnusable, Problem
from worker.verdicts.conclude import conclude
from worker.verdicts.evidence import Evidence

__all__ = ["CampaignUnusable", "Cancelled", "ReplayMismatch", "Tally", "execute"]


def execute(
    campaign: Campaign,
    store: Store,
    cancelled: Callable[[], bool] = lambda: False,
    progress: Callable[[int, Tally], None] = lambda position, tally: None,
    threads: int | None = None,
) -> Conclusion:
    """Run or resume a campaign to its verdict.

    Raises `CampaignUnusable` when it cannot be run with these components, `Cancelled` when asked to stop,
    `OtherCode` when other code began it, `ReplayMismatch` when a resumed stage is not what it was.
    """
    problem = Problem(campaign)
    problem.loop.warm()
    records = store.plan([StagePlan(*planned) for planned in plan(campaign)])
    begin(store, problem)
    evaluate = InProcess(problem, threads)
    context = Context(campaign, problem, evaluate, store, cancelled, progress)
    try:
        searches = 0
        for position, record in enumerate(records):
            index = searches
            searches += record.plan.kind == "search"
            if record.state == "done":
                assert record.result is not None
                context.results[position] = record.result
            else:
                _stage(context, position, record, index)
        conclusion = conclude(problem, _evidence(context, records), provenance(problem))
        store.conclude(conclusion)
        return conclusion
    finally:
        evaluate.close()


def _stage(context: Context, position: int, record: StageRecord, index: int) -> None:
    kind, store = record.plan.kind, context.store
    store.begin(position)
    began = time.perf_counter()
    findings: list[Finding] = []
    traces: list[Trace] = []
    if kind == "nominal":
        result, traces = nominal.run(context, position)
    elif kind == "sensitivity":
        result = sensitivity.run(context, position)
    elif kind == "search":
        result = search.run(context, position, index)
    elif kind == "certify":
        result = certify.run(context, position)
    else:
        result, findings, traces = validate.run(context, position)
    context.results[position] = result
    seconds = record.seconds + time.perf_counter() - began
    store.finish(position, result, seconds, findings, traces)


def _evidence(context: Context, records: list[StageRecord]) -> Evidence:
    by_kind: dict[str, list[dict[str, Any]]] = {}
    for position, record in enumerate(records):
        by_kind.setdefault(record.plan.kind, []).append(context.results[position])
    findings = sorted(context.store.found(), key=lambda f: f.cost)
    columns = [c for _, c in all_columns(context, list(range(len(records))))]
    status = np.concatenate([c.status for c in columns])
    costs = np.concatenate([c.costs[:, 0] for c in columns])[status == OK]
    return Evidence(
        nominal=by_kind["nominal"][0],
        searches=by_kind["search"],
        certificate=next(iter(by_kind.get("certify", [])), None),
        validation=by_kind["validate"][0],
        finding=findings[0] if findings else None,
        others=findings[1:],
        evaluations=len(status),
        failed=int(np.count_nonzero((status != OK) & (status != EXCLUDED))),
        excluded=int(np.count_nonzero(status == EXCLUDED)),
        lowest=float(costs.min()) if len(costs) else None,
        violating=int(np.count_nonzero(costs <= context.problem.threshold)),
    )
