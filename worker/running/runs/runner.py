"""Runs a campaign stage by stage into a store, or resumes a run from a store.

The order of stages is `campaigns.stages.plan`; what each does is in `worker.engine.stages`.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from typing import cast

import numpy as np

from campaigns import Campaign
from campaigns.results import Verdict
from campaigns.runs import StageState
from campaigns.stages.plan import plan
from campaigns.stored.records import StageRecord
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.stages.found import stages
from worker.engine.stages.parts.base import all_columns
from worker.engine.stages.parts.context import Cancelled, Context, ReplayMismatch, Tally
from worker.engine.stages.parts.noise import exclusions, flaky
from worker.engine.stages.parts.store import Store
from worker.engine.systems import optional
from worker.engine.systems.base import CampaignUnusable
from worker.evidence.verdicts.conclude import conclude
from worker.evidence.verdicts.evidence import Evidence
from worker.evidence.verdicts.sureness import Stored, sureness
from worker.evidence.verdicts.validation import worded
from worker.running.catalogue.installed import methods
from worker.running.opening import opened
from worker.running.runs import file_check, identity, pulse, reaches, repetition
from worker.running.runs.provenance import begin, versions

__all__ = ["CampaignUnusable", "Cancelled", "ReplayMismatch", "Tally", "execute"]


def execute(
    campaign: Campaign,
    store: Store,
    cancelled: Callable[[], bool] = lambda: False,
    progress: Callable[[int, Tally], None] = lambda position, tally: None,
    threads: int | None = None,
    problem: Problem | None = None,
) -> Verdict:
    """Run or resume a campaign to its verdict.

    problem: the campaign's problem, if its system is not one of this installation; its system is closed at the end.

    Raises `CampaignUnusable` when it cannot be run with these components, `FilesChanged` when the files of its
    simulator change, `Cancelled` when asked to stop, `OtherCode` when other code began it, `ReplayMismatch` when a
    resumed stage requests other points.
    """
    problem = problem or opened.problem(campaign)
    try:
        return _executed(
            campaign, cast(Store, file_check.Checked(store, problem)), cancelled, progress, threads, problem
        )
    except (CampaignUnusable, ReplayMismatch):  # it may follow from evaluations that failed since the files changed
        file_check.check_here(problem)
        raise


def _executed(
    campaign: Campaign,
    store: Store,
    cancelled: Callable[[], bool],
    progress: Callable[[int, Tally], None],
    threads: int | None,
    problem: Problem,
) -> Verdict:
    pulse.own.allow(pulse.longest(problem.system))
    optional.warm(problem.system)
    repetition.check(campaign, problem)
    reaches.check(campaign, problem)
    if wrong := [one for stage in stages().values() for one in stage.wrong(problem)]:
        raise CampaignUnusable(wrong)
    records = store.plan(plan(campaign))
    begin(store, problem.system, campaign, records)
    evaluate = InProcess(problem, threads)
    planned = [record.plan for record in records]
    context = Context(campaign, problem, evaluate, store, cancelled, progress, plan=planned, methods=methods())
    try:
        for position, record in enumerate(records):
            if record.result is not None:
                context.results[position] = record.result
            else:
                _carry_out(context, position, record)
        verdict = conclude(problem, _evidence(context), versions(campaign, problem.system))
        store.conclude(verdict)
        return verdict
    finally:
        evaluate.close()
        optional.close(problem.system)


def assist(campaign: Campaign, store: Store, cancelled: Callable[[], bool] = lambda: False) -> None:
    """Fly a share of the stage that another worker is carrying out, as far as it can be shared.

    Raises what `execute` does; whatever it is, the run goes on without this worker.
    """
    problem = opened.problem(campaign)
    evaluate = InProcess(problem)
    try:
        pulse.own.allow(pulse.longest(problem.system))
        optional.warm(problem.system)
        store = cast(Store, file_check.Checked(store, problem))
        records = store.plan(plan(campaign))
        store.record_versions(versions(campaign, problem.system), identity.code(campaign))
        planned = [record.plan for record in records]
        context = Context(campaign, problem, evaluate, store, cancelled, plan=planned, methods=methods())
        context.results |= {at: record.result for at, record in enumerate(records) if record.result is not None}
        for position, record in enumerate(records):
            share = stages()[record.plan.kind].assist
            if record.state == StageState.RUNNING and share is not None:
                pulse.own.enter(record.plan.kind)
                share(context, position)
    finally:
        evaluate.close()
        optional.close(problem.system)


def _carry_out(context: Context, position: int, record: StageRecord) -> None:
    pulse.own.enter(" ".join(filter(None, (record.plan.kind, record.plan.method))))
    context.store.begin(position)
    began = time.perf_counter()
    outcome = stages()[record.plan.kind].run(context, position)
    file_check.check(context.problem)
    result = worded(context.problem, outcome.result, outcome.findings)
    context.results[position] = result
    seconds = record.seconds + time.perf_counter() - began
    context.store.finish(position, result, seconds, outcome.findings, outcome.traces)


def _evidence(context: Context) -> Evidence:
    stored = dict(all_columns(context, list(range(len(context.plan)))))
    columns = list(stored.values())
    results = [context.results[at] for at in range(len(context.plan))]
    estimate = sureness(context.problem, results, {at: Stored(c.costs, c.status) for at, c in stored.items()})
    return Evidence.of(
        *(results, context.store.found(), context.problem.threshold, estimate),
        costs=np.concatenate([c.costs[:, 0] for c in columns]),
        status=np.concatenate([c.status for c in columns]),
        flaky=sum(map(flaky, columns)),
        exclusions=sum(map(exclusions, columns), Counter[str]()),
    )
