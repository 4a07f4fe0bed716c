"""How many evaluations a run of a campaign has: searches that end by their own rule, and validation, included.

How soon a search ends, how many worst cases there are and how long the descents to them take is known only afterwards:
every number is a range with a usual value. Its least and its usual one are measured on the campaigns of the library
(`tests/unit/campaigns/checked/test_expected.py`); its end is the bound of the run (`campaigns.stages.plan`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from campaigns.asked.allowance import SLICE, USUAL, validation
from campaigns.asked.proposal import RETRIED, Cost, lasting
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Search
from campaigns.catalogue import Catalogue, MethodEntry
from campaigns.checked.options import changed
from campaigns.effort import Descents, Iterations
from campaigns.limits import SPOT_CHECKS
from campaigns.results.stage import StageResult
from campaigns.stages.found import declared
from campaigns.stages.plan import bound, plan
from campaigns.stored.blocks import size

FEWEST = 8
"""Evaluations per parameter, and as many more, after which a method may end by its own rule: 60, 200 and 219
evaluations of 4000 were observed on two parameters, 100 on ten. Where nothing varies, some end sooner."""

FRESH = 10
"""Evaluations per parameter of the slices through a worst case, at least: others are known from the searches."""
DESCENTS, POLISH, POLL = 15, 3, 3
"""Gradients of all descents, usually, as most evaluations that they need are known; gradients that polish a worst case,
and rounds of compass search after them."""


class Expected(NamedTuple):
    """The evaluations of all stages of one kind: usually, at least and at most; the latter with those made again."""

    kind: str
    title: str
    evaluations: int
    least: int
    most: int


class Fewer(NamedTuple):
    """Of a kind of stage that may have fewer evaluations than its budget: how many at least, and when, a clause."""

    least: int
    when: str


class Total(NamedTuple):
    """The evaluations of a run: at least, usually, at most; the latter is the bound of the run."""

    least: int
    usual: int
    most: int


Range = tuple[int, int]
"""At least, usually."""


def expected(campaign: Campaign, catalogue: Catalogue) -> list[Expected]:
    """The number of evaluations of every kind of stage, in the order of a run.

    A search whose method the catalogue lacks may end by its own rule.
    """
    totals: dict[str, tuple[int, int, int]] = {}
    searches = iter(campaign.stages.search)
    for stage, limit in zip(plan(campaign), bound(campaign), strict=True):
        shorter = fewer(campaign, stage.kind)
        found = (stage.planned if shorter is None else min(shorter.least, stage.planned), stage.planned)
        if stage.method is not None:
            found = _search(campaign, next(searches), catalogue)
        elif declared()[stage.kind].of_findings:
            found = _validate(campaign)
        least, usual, most = totals.get(stage.kind, (0, 0, 0))
        totals[stage.kind] = (least + found[0], usual + found[1], most + limit.evaluations)
    return [Expected(kind, declared()[kind].title, usual, least, most) for kind, (least, usual, most) in totals.items()]


def fewer(campaign: Campaign, kind: str) -> Fewer | None:
    """When stages of this kind have fewer evaluations than their budget, by what their options and results may state;
    None if never, or by the rule of a search. Their usual number is the budget."""
    result, options = declared()[kind].result, getattr(campaign.stages, kind, None)
    if result.estimation is not StageResult.estimation:
        return Fewer(0, "none if no evaluation before it violates")
    if result.reevaluated is not StageResult.reevaluated:
        return Fewer(0, "fewer if this campaign cannot evaluate some of the findings")
    if options is not None and getattr(options, "until", None) == "target":
        return Fewer(size(options.samples), "fewer if so many samples violate that the target cannot be met")
    return None


def computing(campaign: Campaign) -> list[str]:
    """The kinds of stages that compute without evaluations: no number of them tells how long these take."""
    return [stage.kind for stage in bound(campaign) if stage.evaluations == 0]


def total(stages: list[Expected]) -> Total:
    """The evaluations of all stages."""
    return Total(*(sum(of) for of in zip(*((s.least, s.evaluations, s.most) for s in stages), strict=True)))


def again(campaign: Campaign, catalogue: Catalogue, noisy: bool, halved: bool) -> int:
    """How many evaluations of a simulator are usually made again to confirm results, each in a fresh process; they are
    not counted as evaluations. More are if some violate, within the allowance of validation.

    noisy: its results do not repeat; halved: it has a step, which is halved too.
    """
    assert campaign.simulator is not None
    random = min(SPOT_CHECKS, sum(stage.evaluations for stage in expected(campaign, catalogue)))
    allowance, cases = validation(campaign), 1 + round(_cases(campaign))
    most = allowance.total - _validate(campaign)[1]
    if not noisy and campaign.simulator.calls == 1:
        return min(most, random + cases * (1 + halved))
    called = (cases + len(campaign.stages.search)) * campaign.stages.validate_.repeats
    return min(most, random + math.ceil(called / campaign.simulator.calls))


def at_most(campaign: Campaign, evaluations: int) -> str:
    """The words for the number that bounds a run: At most 22,314 evaluations, 44,628 calls."""
    return f"At most {evaluations:,} evaluations{called(campaign, evaluations)}"


def called(campaign: Campaign, evaluations: int) -> str:
    """How many calls so many evaluations are at most, as a clause; empty if each is one."""
    if campaign.simulator is None:
        return ""
    calls, retries = campaign.simulator.calls, campaign.simulator.retries
    retried = f" {RETRIED}" if retries else ""
    return "" if calls * (1 + retries) == 1 else f", {calls * (1 + retries) * evaluations:,} calls{retried}"


def confirmation(cost: Cost, calls: int = 1) -> str:
    """What confirming the results of a simulator takes besides its searches, a sentence."""
    return (
        f"Up to {SPOT_CHECKS} random evaluations are made again{cost.fresh} to confirm results: about "
        f"{lasting(cost.again(SPOT_CHECKS, calls))} more."
    )


def _search(campaign: Campaign, search: Search, catalogue: Catalogue) -> Range:
    entry = catalogue.method(search.method)
    limit, effort = search.evaluations, entry and entry.effort
    ends = (limit, limit)
    if isinstance(effort, Iterations) and (stated := search.options.get(effort.option)):
        ends = _iterations(effort, stated, len(campaign.uncertain)) or ends
    elif isinstance(effort, Descents):
        dimension, starts = len(campaign.uncertain), _starts(search, effort.option, entry)
        ends = effort.least * (dimension + 1) * starts, effort.usual * (2 * dimension + 1) * starts
    elif entry is None or not entry.whole_budget or changed(search, entry, entry.own_rule.split()):
        least = FEWEST * (len(campaign.uncertain) + 1)
        ends = least, round(math.sqrt(min(least, limit) * limit))
    least, usual = (max(1, min(limit, end)) for end in ends)
    return least, usual


def _iterations(effort: Iterations, stated: object, dimension: int) -> Range | None:
    """The lowest and the usual number of evaluations of so many iterations; None if the option is not a number."""
    if not isinstance(stated, int | float) or stated <= 0:
        return None
    count = min(stated, 1e9)
    usual = round(effort.each * dimension * count * (count / 100) ** effort.growth)
    return round(usual * effort.spread[0]), usual


def _starts(search: Search, option: str, entry: MethodEntry | None) -> int:
    """The points that the campaign gives, else their number, as stated or by default."""
    default = entry.options["properties"][option]["default"] if entry else 1
    stated = search.options.get(option, default)
    return len(search.starts) or (stated if isinstance(stated, int) else default)


def _validate(campaign: Campaign) -> Range:
    """Descents from the candidates of all stages; then the polishing of each worst case, its neighbours and slices."""
    neighbours, dimension = campaign.stages.validate_.neighbours, len(campaign.uncertain)
    each = POLISH * (2 * dimension + 1) + 2 * POLL * dimension + neighbours + SLICE * dimension
    usual = round(DESCENTS * (dimension + 1) + _cases(campaign) * each)
    most = validation(campaign, noisy=False).stored
    if campaign.stages.findings.at_most > USUAL:  # what is left is spent in search of further ones
        usual = most
    return min(most, neighbours + FRESH * dimension), min(most, usual)


def _cases(campaign: Campaign) -> float:
    """How many worst cases are usually stored."""
    return min(float(campaign.stages.findings.at_most), 1.0 + max(0.0, len(campaign.uncertain) - 4.0) / 4)
