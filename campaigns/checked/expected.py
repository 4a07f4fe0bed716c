"""How many evaluations a run of a campaign has: searches that end by their own rule, and validation, included.

How soon a search ends, how many worst cases there are and how long the descents to them take is known only afterwards:
every number is a range with a usual value. The figures are measured on the campaigns of the library, see
`tests/unit/campaigns/checked/test_expected.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from campaigns.asked.proposal import Cost, lasting
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Search
from campaigns.catalogue import Catalogue, MethodEntry
from campaigns.effort import Descents, Iterations
from campaigns.limits import SPOT_CHECKS
from campaigns.stages.found import declared
from campaigns.stages.plan import plan

FEWEST = 10
"""Evaluations per parameter, and as many more, after which a method may end by its own rule: 60, 200 and 219
evaluations of 4000 were observed on two parameters."""

STARTS = (17, 40, 60)
"""Points that validation descends from: the fewest, usually, the most."""
STEPS = (2, 15, 25)
"""Gradients of each of these descents; the most is their limit, which few parameters do not need (`_steps`)."""
POLISH, POLL = (1, 5, 60), (5, 15, 100)
"""Gradients that polish a worst case, and rounds of compass search after them."""

SLICE = 42
"""Evaluations along each parameter through a worst case."""

RAY, RAYS = 34, 2
"""Evaluations along one ray to the boundary of a violation; rays per parameter, and one more to the worst case."""


class Expected(NamedTuple):
    """The evaluations of all stages of one kind: usually, at least and at most."""

    kind: str
    title: str
    evaluations: int
    least: int
    most: int


class Total(NamedTuple):
    """The evaluations of a run: at least, usually, at most."""

    least: int
    usual: int
    most: int

    @property
    def near(self) -> bool:
        """Whether the usual number alone says enough: nothing in the range differs from it by more than a fifth."""
        return 0.8 * self.usual <= self.least and self.most <= 1.2 * self.usual

    @property
    def text(self) -> str:
        """About 12,600 to 22,300."""
        return f"About {self.usual:,}" if self.near else f"About {self.least:,} to {self.most:,}"


Range = tuple[int, int, int]
"""At least, usually, at most."""


def expected(campaign: Campaign, catalogue: Catalogue) -> list[Expected]:
    """The number of evaluations of every kind of stage, in the order of a run.

    A search whose method the catalogue lacks may end by its own rule.
    """
    totals: dict[str, Range] = {}
    searches = iter(campaign.stages.search)
    for stage in plan(campaign):
        found = (stage.planned, stage.planned, stage.planned)
        if stage.method is not None:
            found = _search(campaign, next(searches), catalogue)
        elif declared()[stage.kind].of_findings:
            found = _validate(campaign)
        least, usual, most = totals.get(stage.kind, (0, 0, 0))
        totals[stage.kind] = (least + found[0], usual + found[1], most + found[2])
    return [Expected(kind, declared()[kind].title, usual, least, most) for kind, (least, usual, most) in totals.items()]


def total(stages: list[Expected]) -> Total:
    """The evaluations of all stages; the ends of the range are rounded outwards."""
    least, most = sum(stage.least for stage in stages), sum(stage.most for stage in stages)
    return Total(_rounded(least, math.floor), sum(stage.evaluations for stage in stages), _rounded(most, math.ceil))


def latest(campaign: Campaign) -> int:
    """The evaluations after which validation ends, whatever it finds."""
    stages = campaign.stages
    each = stages.validate_.neighbours + SLICE * len(campaign.uncertain) + boundary(campaign)
    return stages.findings.evaluations + 2 * stages.findings.at_most * each


def _rounded(value: int, towards: Callable[[float], int]) -> int:
    """The number, rounded to three digits."""
    step: int = 10 ** max(0, len(str(value)) - 3)
    return towards(value / step) * step


def again(campaign: Campaign, catalogue: Catalogue, noisy: bool, halved: bool) -> int:
    """How many evaluations of a simulator are usually made again to confirm results, each in a fresh process; they are
    not counted as evaluations. Up to `campaigns.limits.VIOLATIONS` more are, if so many violate.

    noisy: its results do not repeat; halved: it has a step, which is halved too.
    """
    assert campaign.simulator is not None
    random = min(SPOT_CHECKS, sum(stage.evaluations for stage in expected(campaign, catalogue)))
    cases = 1 + round(_cases(campaign)[1])
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


def _search(campaign: Campaign, search: Search, catalogue: Catalogue) -> Range:
    entry = catalogue.method(search.method)
    limit, effort = search.evaluations, entry and entry.effort
    ends = (limit, limit, limit)
    if isinstance(effort, Iterations) and (stated := search.options.get(effort.option)):
        ends = _iterations(effort, stated, len(campaign.uncertain)) or ends
    elif isinstance(effort, Descents):
        ends = _descents(effort, _starts(search, effort.option, entry), len(campaign.uncertain))
    elif entry is None or not entry.whole_budget:
        least = FEWEST * (len(campaign.uncertain) + 1)
        ends = least, round(math.sqrt(min(least, limit) * limit)), limit
    least, usual, most = (max(1, min(limit, end)) for end in ends)
    return least, usual, most


def _iterations(effort: Iterations, stated: object, dimension: int) -> Range | None:
    """None if the option is not a number."""
    if not isinstance(stated, int | float) or stated <= 0:
        return None
    count = min(stated, 1e9)
    usual = round(effort.each * dimension * count * (count / 100) ** effort.growth)
    least, most = (round(usual * end) for end in effort.spread)
    return least, usual, most


def _starts(search: Search, option: str, entry: MethodEntry | None) -> int:
    """The points that the campaign gives, else their number, as stated or by default."""
    default = entry.options["properties"][option]["default"] if entry else 1
    stated = search.options.get(option, default)
    return len(search.starts) or (stated if isinstance(stated, int) else default)


def _descents(effort: Descents, starts: int, dimension: int) -> Range:
    gradient = (2 * dimension + 1) * starts
    most = math.ceil(max(effort.usual, effort.growth * dimension**2) * gradient)
    return effort.least * gradient, effort.usual * gradient, most


def _validate(campaign: Campaign) -> Range:
    """Descents from the candidates of all stages; then the polishing of each worst case, its neighbours, slices through
    it and, if it violates, the distances to the boundary."""
    stages, dimension = campaign.stages, len(campaign.uncertain)
    around = stages.validate_.neighbours + SLICE * dimension

    def within(end: int, cases: float, beyond: int) -> int:
        """end: 0 at least, 1 usually, 2 at most."""
        each = POLISH[end] * (2 * dimension + 1) + 2 * POLL[end] * dimension + around + beyond
        descents = STARTS[end] * _steps(dimension)[end] * (dimension + 1)
        return min(latest(campaign), round(descents + cases * each))

    least, usual, most = _cases(campaign)
    return within(0, least, 0), within(1, usual, 0), within(2, most, boundary(campaign))


def _steps(dimension: int) -> tuple[float, float, float]:
    """Gradients of a descent until it ends: a quadratic model needs some per parameter."""
    least, usual, most = STEPS
    return least, min(usual, 5 + 2 * dimension), min(most, 2 + 6 * dimension)


def _cases(campaign: Campaign) -> tuple[float, float, float]:
    """How many worst cases are stored: one, usually, as many as there are parameters."""
    dimension, limit = len(campaign.uncertain), float(campaign.stages.findings.at_most)
    return 1.0, min(limit, 1.0 + max(0.0, dimension - 4.0) / 2), min(limit, max(2.0, float(dimension)))
