"""Attraction: a region from which the closed loop returns to its trim, proved for its polynomial model.

It evaluates no case of the campaign; `worker.engine.attraction` finds, checks and measures the region. What the solver
cannot do is part of the result.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from campaigns.asked.problem import Problem as Wrong
from campaigns.certificates import rays
from campaigns.certificates.polynomials import degree
from campaigns.claims.stages import attraction as sentences
from campaigns.results.attraction import (
    HeldReference,
    NoAttraction,
    NoAttractionWhy,
    Section,
    StoredCertificate,
    StoredPolynomial,
    TrimState,
)
from campaigns.stages.attraction import AttractionResult
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.context import Cancelled, Context
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.systems import optional
from worker.engine.systems.base import CampaignUnusable, Floats, PolynomialLoop

if TYPE_CHECKING:
    from worker.engine.attraction.region import Region

NO_MODEL = "the system declares no polynomial model about trim; leave attraction out"


def run(context: Context, position: int) -> Outcome[AttractionResult]:
    """Find the region, check it, measure it, and state what follows."""
    loop, request = optional.about_trim(context.problem.system), context.campaign.stages.attraction
    assert loop is not None
    assert request is not None
    states = zip(loop.states, loop.trim, loop.limits, strict=True)
    empty = AttractionResult(
        states=[TrimState(name=a, symbol=b, unit=c, trim=trim, limit=limit) for (a, b, c), trim, limit in states],
        held=[HeldReference(text=text, value=value, unit=unit) for text, value, unit in loop.references],
        flow=[StoredPolynomial.of(p) for p in loop.flow],
    )
    if find_spec("clarabel") is None:
        return Outcome(_refused(empty, "solver"))
    from worker.engine.attraction import region  # imported late: a campaign's process must start fast

    limits = {k: limit for k, limit in enumerate(loop.limits) if limit is not None}
    wanted = request.degree or region.DEGREES[len(loop.flow)]

    def ended() -> bool:
        context.store.beat()  # minutes pass without a result
        return context.cancelled()

    found = region.found(list(loop.flow), limits, wanted, ended)
    if ended():
        raise Cancelled
    return Outcome(_refused(empty, found) if isinstance(found, str) else _stated(empty, loop, found))


def _refused(empty: AttractionResult, why: NoAttractionWhy) -> AttractionResult:
    statement = sentences.REASONS[why]
    none = NoAttraction(why=why, statement=statement)
    return empty.model_copy(update={"refused": none, "statement": sentences.refused(statement)})


def _stated(empty: AttractionResult, loop: PolynomialLoop, found: Region) -> AttractionResult:
    """The region with what is measured of it."""
    from worker.engine.attraction.simulated import Simulation, difference, measured

    flow, drawn = list(loop.flow), rays.drawn(found.certificate.v, found.matrix)
    made = measured(found, Simulation(flow, loop.returns))
    states = zip(empty.states, drawn.reach, strict=True)
    result = empty.model_copy(
        update={
            "states": [state.model_copy(update={"reach": reach}) for state, reach in states],
            "degree": degree(found.certificate.v),
            "proof": StoredCertificate.of(found.matrix, found.certificate),
            "simulated": _ends(made.simulated),
            "fraction": rays.fraction(drawn.certified, made.simulated, len(flow)),
            "contradicting": rays.contradicting(drawn.certified, made.simulated),
            "difference": difference(flow, made.points, loop.rates(made.points)),
            "sections": [
                Section(states=list(pair), proved=proved.tolist(), simulated=_ends(made.sections[pair]))
                for pair, proved in drawn.sections.items()
            ],
        }
    )
    return result.model_copy(update={"statement": sentences.proved(result.facts())})


def _ends(radii: Floats) -> list[float | None]:
    return [float(r) if np.isfinite(r) else None for r in radii]


def wrong(problem: Problem) -> Sequence[Wrong]:
    """A campaign whose loop has no polynomial model or no trim."""
    if problem.campaign.stages.attraction is None:
        return ()
    try:
        loop = optional.about_trim(problem.system)
    except CampaignUnusable as error:
        return error.problems
    return () if loop is not None else [Wrong("stages.attraction", "no polynomial model", NO_MODEL)]


stage = Stage("attraction", run, wrong=wrong)
