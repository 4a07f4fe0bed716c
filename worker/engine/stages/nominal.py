"""Nominal: the evaluation at the nominal values, to which all others are compared.

Of a simulator, this stage also measures whether results repeat (`worker.engine.stages.parts.noise`). Its first
evaluation is always the nominal one. A simulator that fails at every point, or excludes the nominal case, ends the
run here.
"""

from __future__ import annotations

from campaigns.asked.problem import Problem as Wrong
from campaigns.claims.stages import ends
from campaigns.claims.stages.calls import nominal_excluded, without_value
from campaigns.results.base import EXCLUDED, OK, STATUS
from campaigns.stages.nominal import NominalResult
from worker.engine.stages.parts import noise
from worker.engine.stages.parts.base import drive, once, traced
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.systems.base import CampaignUnusable


def run(context: Context, position: int) -> Outcome[NominalResult]:
    """Evaluate the nominal case; its trace shows even an evaluation that failed."""
    problem, simulator = context.problem, context.campaign.simulator
    if simulator is None:
        search = once(problem.nominal_point[None, :], ends.NOMINAL)
        columns, measured = drive(context, position, search, 1).columns, None
        assert columns is not None
    else:
        points = noise.points(problem)
        columns = drive(context, position, noise.measuring(problem, points), 2**62).columns
        assert columns is not None
        if not (columns.status == OK).any():
            reason = without_value(len(columns.status), len(points), noise.reasons(columns))
            raise CampaignUnusable([Wrong("simulator.name", "", f"{simulator.name!r}: {reason}")])
        if columns.status[0] == EXCLUDED:
            reason = nominal_excluded(columns.reasons.get(0, ""))
            raise CampaignUnusable([Wrong("simulator.name", "", f"{simulator.name!r}: {reason}")])
        measured = noise.measured(columns, len(points), problem)
    known = columns.status[0] == OK
    cost = float(columns.costs[0, 0]) if known else None
    result = NominalResult(
        cost=cost,
        margin=None if cost is None else cost - problem.threshold,
        status=STATUS[int(columns.status[0])],
        reason="" if known else columns.reasons.get(0, ""),
        parameters={r.path: r.nominal for r in problem.ranges},
        measured=measured,
    )
    if simulator is None:
        shown = problem.system.trace("nominal", {})
    else:
        exact = simulator.calls == 1 and measured is not None and measured.repeats
        shown, why = traced(problem.system, "nominal", {}, cost, exact)
        result = result.model_copy(update={"untraced": {"nominal": why} if why else {}})
    return Outcome(result, traces=() if shown is None else (shown,))


stage = Stage("nominal", run)
