"""Nominal: the evaluation at the nominal values, to which all others are compared."""

from __future__ import annotations

from campaigns.results import NominalResult
from campaigns.results.base import STATUS
from worker.stages.parts.base import Context, drive, once
from worker.stages.parts.outcome import Outcome, Stage


def run(context: Context, position: int) -> Outcome[NominalResult]:
    """Evaluate the nominal case; its trace shows even an evaluation that failed."""
    problem = context.problem
    driven = drive(context, position, once(problem.nominal_point[None, :], "evaluated the nominal case"), 1)
    assert driven.columns is not None
    best = driven.tally.best
    result = NominalResult(
        cost=best,
        margin=None if best is None else best - problem.threshold,
        status=STATUS[int(driven.columns.status[0])],
        reason=driven.columns.reasons.get(0, ""),
        parameters={r.path: r.nominal for r in problem.ranges},
    )
    shown = problem.system.trace("nominal", {})
    return Outcome(result, traces=() if shown is None else (shown,))


stage = Stage("nominal", run)
