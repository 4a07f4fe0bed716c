"""Sensitivity: each parameter over its bounds, the others nominal; Morris and Sobol indices if requested.

Srikanthakumar, chapter 3: d_min against each parameter. One at a time shows main effects near the nominal point and
no interactions; the indices (`worker.engine.stages.parts.indices`) cover the whole box.
"""

from __future__ import annotations

from collections.abc import Generator

from campaigns.asked.stages import Sensitivity
from campaigns.claims.stages import ends
from campaigns.stages.sensitivity import SensitivityResult
from worker.engine.search.base import Batch, Floats
from worker.engine.stages.parts import indices
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.stages.parts.slices import curves
from worker.engine.stages.parts.streams import stream


def run(context: Context, position: int) -> Outcome[SensitivityResult]:
    """The curves in one batch, each kind of index in another."""
    request = context.campaign.stages.sensitivity
    assert request is not None
    found: list[SensitivityResult] = []
    drive(context, position, _search(context, request, found), 2**62)
    return Outcome(found[0])


def _search(context: Context, request: Sensitivity, found: list[SensitivityResult]) -> Generator[Floats, Batch, str]:
    problem, seed, confidence = context.problem, context.campaign.seed, context.campaign.confidence
    through = yield from curves(problem, problem.nominal_point, request.points)
    morris = sobol = None
    if request.morris is not None:
        random = stream(seed, indices.MORRIS_STREAM)
        morris = yield from indices.morris(problem, request.morris, random, confidence)
    if request.sobol is not None:
        random = stream(seed, indices.SOBOL_STREAM)
        sobol = yield from indices.sobol(problem, request.sobol, random, confidence)
    found.append(SensitivityResult(points=request.points, curves=through, morris=morris, sobol=sobol))
    return ends.CURVES


stage = Stage("sensitivity", run)
