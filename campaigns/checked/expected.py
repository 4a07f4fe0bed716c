"""How many evaluations a run of a campaign usually has: searches that end by their own rule, and validation, included.

An estimate: how soon a search ends, and how many worst cases there are, is known only afterwards. The figures are
measured on the library, see `tests/unit/test_expected.py`. Start reading at `expected`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from campaigns.asked.proposal import Cost, lasting
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Search
from campaigns.stages.found import declared
from campaigns.stages.plan import plan

DIRECT_ITERATION, DIRECT_GROWTH = 5.6, 0.25
"""Evaluations of an iteration of DIRECT per parameter, of 100 iterations, and how that grows with their number: 5.1 to
6.5 in the library's runs with 100 or 200 iterations, 8.3 with 500."""

DESCENT = 10
"""Gradients of one descent of SQP until it ends: 4 to 9 in most of the library's runs."""

SQP_STARTS = 8
"""Starts of SQP if the campaign gives none."""

SLICE = 42
"""Evaluations along each parameter through a worst case."""

SPOT_CHECKS, VIOLATIONS = 200, 200
"""Random evaluations, and violations at most, that are made again to confirm them; of a simulator in fresh
processes."""

RAY, RAYS = 34, 2
"""Evaluations along one ray to the boundary of a violation; rays per parameter, and one more to the worst case."""


class Expected(NamedTuple):
    """The evaluations of all stages of one kind."""

    kind: str
    title: str
    evaluations: int


def expected(campaign: Campaign) -> list[Expected]:
    """The usual number of evaluations of every kind of stage, in the order of a run."""
    totals: dict[str, int] = {}
    searches = iter(campaign.stages.search)
    for stage in plan(campaign):
        usual = stage.planned
        if stage.kind == "search":
            usual = _search(campaign, next(searches))
        elif stage.kind == "validate":
            usual = _validate(campaign)
        totals[stage.kind] = totals.get(stage.kind, 0) + usual
    return [Expected(kind, declared()[kind].title, evaluations) for kind, evaluations in totals.items()]


def again(campaign: Campaign, noisy: bool, halved: bool) -> int:
    """How many evaluations of a simulator are usually made again to confirm results, each in a fresh process; they are
    not counted as evaluations. Up to `VIOLATIONS` more are, if so many violate.

    noisy: its results do not repeat; halved: it has a step, which is halved too.
    """
    assert campaign.simulator is not None
    random = min(SPOT_CHECKS, sum(stage.evaluations for stage in expected(campaign)))
    cases = 1 + round(_cases(campaign))
    if not noisy and campaign.simulator.calls == 1:
        return random + cases * (1 + halved)
    called = (cases + len(campaign.stages.search)) * campaign.stages.validate_.repeats
    return random + math.ceil(called / campaign.simulator.calls)


def confirmation(cost: Cost, calls: int = 1) -> str:
    """What confirming the results of a simulator takes besides its searches, a sentence."""
    return (
        f"Up to {SPOT_CHECKS} random evaluations are made again{cost.fresh} to confirm results: about "
        f"{lasting(cost.again(SPOT_CHECKS, calls))} more."
    )


def boundary(campaign: Campaign) -> int:
    """What one worst case that violates adds, for the distance from the nominal case to the violation."""
    return 1 + RAY * (RAYS * len(campaign.uncertain) + 1)


def _search(campaign: Campaign, asked: Search) -> int:
    dimension, usual = len(campaign.uncertain), asked.evaluations
    if asked.method == "direct":
        iterations = asked.options.get("iterations")
        if isinstance(iterations, int | float) and iterations > 0:
            stated = min(iterations, 1e9)
            usual = round(DIRECT_ITERATION * dimension * stated * (stated / 100) ** DIRECT_GROWTH)
    elif asked.method == "sqp":
        given = asked.options.get("starts", SQP_STARTS)
        starts = len(asked.starts) or (given if isinstance(given, int) else SQP_STARTS)
        usual = DESCENT * (2 * dimension + 1) * starts
    return max(1, min(asked.evaluations, usual))


def _validate(campaign: Campaign) -> int:
    """Descents from the candidates of all stages, then the neighbours of each worst case and slices through it."""
    stages, dimension = campaign.stages, len(campaign.uncertain)
    descents = min(stages.findings.evaluations, 400 + 22 * dimension**3)
    return descents + round(_cases(campaign) * (stages.validate_.neighbours + SLICE * dimension))


def _cases(campaign: Campaign) -> float:
    """How many worst cases are usually kept."""
    return min(float(campaign.stages.findings.at_most), 1.0 + len(campaign.uncertain) / 4)
