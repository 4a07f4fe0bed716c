"""Checks a stored region of attraction: its certificate exactly, its model by equations written again, its numbers.

Taken as given: how far the loop returns in simulation, the difference of model and loop, and the model of a component
that is not shipped.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from campaigns.certificates import exact, rays
from campaigns.certificates.coordinates import transformed
from campaigns.certificates.polynomials import degree
from campaigns.claims.stages import attraction as templates
from campaigns.results.attraction import Attraction, HeldReference, NoAttraction, Section, TrimState
from worker.evidence.audit.loops import MODELS, Model
from worker.evidence.audit.parts import OMIT, REST, changed, made
from worker.evidence.audit.recompute import Run

HOLDS = "holds"
MOST = 4
"""States."""
TOLERANCE = Fraction(1, 10**9)
"""Relative: how near a coefficient of the model is to that of the equations."""


def placed(run: Run, k: int) -> dict[str, tuple[object, object]]:
    """Whether the certificate holds, and how many rates of the model are those of the equations."""
    stated = Attraction.model_validate(run.claims["results"][k])
    own = _model(run)
    same = [True] * len(stated.flow) if own is None else _same(stated, own)
    return {f"model of stage {k}": (len(same), sum(same)), f"certificate of stage {k}": (_holds(stated), HOLDS)}


def _holds(stated: Attraction) -> str:
    """`HOLDS` if the region is proved, or none is stated; else what does not, in a few words."""
    if stated.proof is None:
        return HOLDS if stated.refused is not None else "it is absent"
    try:
        matrix, flow = stated.proof.matrix(), [p.polynomial() for p in stated.flow]
        if not len(matrix) == len(flow) == len(stated.states) <= MOST:
            return "it has other states"
        limits = {i: exact.coefficient(s.limit) for i, s in enumerate(stated.states) if s.limit is not None}
        return exact.wrong(stated.proof.certificate(), *transformed(flow, limits, matrix)) or HOLDS
    except (ValueError, StopIteration, ArithmeticError):  # no number, no triangle, or coordinates without an inverse
        return "it cannot be read"


def _model(run: Run) -> Model | None:
    """The model by the equations; None for a loop that is not shipped."""
    scenario = run.campaign.scenario
    made = None if scenario is None else MODELS.get((scenario.vehicle.component, scenario.controller.component))
    return None if made is None else made({path: nominal for path, (_, nominal) in run.known.items()})


def _same(stated: Attraction, own: Model) -> list[bool]:
    """Which rates are those of the equations."""
    return [
        terms.keys() == expected.keys()
        and all(abs(terms[m] - Fraction(c)) <= TOLERANCE * abs(Fraction(c)) for m, c in expected.items())
        for terms, expected in zip(
            (p.polynomial() for p in stated.flow), ({m: c for m, c in e.items() if c} for e in own.flow), strict=True
        )
    ]


def attracted(run: Run, k: int) -> Attraction:
    """What the result of the stage must state."""
    stated, own = Attraction.model_validate(run.claims["results"][k]), _model(run)
    found = made(Attraction, **REST)
    states: list[TrimState] = [made(TrimState, **REST) for _ in stated.states]
    if own is not None:
        states = [
            made(TrimState, name=name, symbol=symbol, unit=unit, trim=trim, limit=limit)
            for (name, symbol, unit), trim, limit in zip(own.states, own.trim, own.limits, strict=True)
        ]
        references = [made(HeldReference, text=text, value=value, unit=unit) for text, value, unit in own.references]
        found = changed(found, states=states, held=references)
    if stated.refused is not None:
        why = templates.REASONS[stated.refused.why]
        if not run.reworded:
            refused = made(NoAttraction, statement=why, **REST)
            found = changed(found, statement=templates.refused(why), refused=refused)
        return changed(found, fraction=None, proof=None, sections=[])
    if stated.proof is None or len(stated.states) > MOST:
        raise ValueError("a region without a proof, or of more states than any")
    if _holds(stated) != HOLDS:  # which is stated elsewhere: of another V nothing follows
        return found
    with np.errstate(all="ignore"):
        drawn = rays.drawn(stated.proof.v.polynomial(), stated.proof.matrix())
    ended = np.array([math.inf if r is None else r for r in stated.simulated])
    sections = [made(Section, states=list(at), proved=radii.tolist(), **REST) for at, radii in drawn.sections.items()]
    return changed(
        found, states=[changed(state, reach=reach) for state, reach in zip(states, drawn.reach, strict=True)],
        degree=degree(stated.proof.v.polynomial()), fraction=rays.fraction(drawn.certified, ended, len(stated.states)),
        contradicting=rays.contradicting(drawn.certified, ended), sections=sections,
        statement=OMIT if run.reworded else templates.proved(stated.facts()),
    )  # fmt: skip
