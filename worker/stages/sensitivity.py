"""Sensitivity: each parameter over its bounds, the others nominal; Morris and Sobol indices where asked for.

Srikanthakumar, chapter 3: d_min against each parameter. One at a time shows main effects near the nominal point and
nothing of interactions; the indices (`worker.stages.parts.indices`) look at the whole box. Start reading at `run`.
"""

from __future__ import annotations

from typing import Any

from campaigns.asked.stages import Sensitivity
from worker.search.base import Search
from worker.stages.parts import indices
from worker.stages.parts.base import Context, drive
from worker.stages.parts.slices import curves
from worker.stages.search import stream


def run(context: Context, position: int) -> dict[str, Any]:
    """The curves in one batch, each kind of index in another."""
    asked = context.campaign.stages.sensitivity
    assert asked is not None
    told: dict[str, Any] = {"points": asked.points, "morris": None, "sobol": None}
    drive(context, position, _search(context, asked, told), 2**62)
    return told


def _search(context: Context, asked: Sensitivity, told: dict[str, Any]) -> Search:
    problem, seed, confidence = context.problem, context.campaign.seed, context.campaign.confidence
    told |= yield from curves(problem, problem.nominal_point, asked.points)
    if asked.morris is not None:
        random = stream(seed, indices.MORRIS_STREAM)
        told["morris"] = yield from indices.morris(problem, asked.morris, random, confidence)
    if asked.sobol is not None:
        random = stream(seed, indices.SOBOL_STREAM)
        told["sobol"] = yield from indices.sobol(problem, asked.sobol, random, confidence)
    return "flew every curve"
