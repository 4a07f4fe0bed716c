"""The remedies of checks that do not hold: changes of the campaign with which a new run may settle them.

A remedy is derived from the code of the check, the campaign, and what the searches used; each one gives a valid
campaign. It promises nothing: the new run has a verdict of its own.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import JsonValue, ValidationError

from campaigns import rules
from campaigns.asked.allowance import validation
from campaigns.asked.proposal import ranked
from campaigns.asked.sample_bound import bound, needed
from campaigns.asked.spec import MAX_EVALUATIONS, Campaign
from campaigns.asked.stages import Certify, Search
from campaigns.catalogue import MethodEntry
from campaigns.claims.say import Part, count, listed, method, number, say
from campaigns.codes import CheckCode
from campaigns.limits import FINDINGS, STORED_WHOLE
from campaigns.results.base import Described, Result
from campaigns.results.search import SearchResult
from campaigns.results.stage import StageResult
from campaigns.results.verdict import Check, Statistics
from campaigns.rules import RemedyKind

MORE = 4
"""Factor on a budget that was used up."""
LONGER = 1.5
"""Factor on a horizon that ends before the encounter does."""


class Change(Result):
    """One value of the campaign's document; a location just behind the end of a list adds an entry."""

    at: list[str | int]
    """Its location: ["scenario", "step"]."""
    value: JsonValue


class Remedy(Described):
    """A change of the campaign; its sentence continues "Run again"."""

    kind: RemedyKind
    changes: list[Change]


@dataclass(frozen=True)
class Ran:
    """What a remedy is derived from: the campaign, the results of its stages in their order, the statement of its
    sample, and the methods that a new run may name."""

    campaign: Campaign
    results: Sequence[StageResult | None]
    statistics: Statistics | None = None
    methods: Sequence[MethodEntry] = ()

    @property
    def searches(self) -> list[SearchResult]:
        return [result for result in self.results if isinstance(result, SearchResult)]


def remedies(check: Check, ran: Ran) -> list[Remedy]:
    """The remedies of a check that does not hold, each with a valid campaign; none for a check without a remedy."""
    rule = rules.rule(check.code)
    if check.ok or rule is None or rule.remedy is None:
        return []
    kind = RemedyKind.FINDINGS if "left_out" in check.values else rule.remedy
    found = _OF[kind](check, ran)
    return [remedy for remedy in found if applied(ran.campaign, [remedy]) not in (None, ran.campaign)]


def applied(campaign: Campaign, wanted: Sequence[Remedy]) -> Campaign | None:
    """The campaign with these changes; None if it would not be valid."""
    document = copy.deepcopy(campaign.document())
    try:
        for change in (change for remedy in wanted for change in remedy.changes):
            _set(document, change)
        return Campaign.model_validate(document)
    except (ValidationError, LookupError, TypeError):
        return None


def _set(document: dict[str, object], change: Change) -> None:
    *parents, last = change.at
    place: Any = document
    for step in parents:
        place = place[step]
    if isinstance(place, list) and last == len(place):
        place.append(change.value)
    else:
        place[last] = change.value


def _remedy(kind: RemedyKind, statement: Sequence[Part], *changes: tuple[Sequence[str | int], JsonValue]) -> Remedy:
    return Remedy(
        kind=kind, statement=say(*statement), changes=[Change(at=list(at), value=value) for at, value in changes]
    )


def _smaller_step(check: Check, ran: Ran) -> Iterator[Remedy]:
    """Half the step of a closed loop, halved again until an obstacle does not turn too far within it."""
    scenario = ran.campaign.scenario
    if scenario is None:
        yield from _repeated_calls(check, ran)
        return
    step, largest = scenario.step / 2, check.values.get("largest", scenario.step)
    while step > largest > 0.0:
        step /= 2
    statement = ("with step ", number(1000 * step, "ms"))
    yield _remedy(RemedyKind.STEP, statement, (("scenario", "step"), step))


def _longer_horizon(check: Check, ran: Ran) -> Iterator[Remedy]:
    """A longer horizon, if the closest approach is at its end or later; a whole number of guidance periods."""
    scenario = ran.campaign.scenario
    if scenario is None or "horizon" not in check.values:
        return
    grain = max(scenario.step, scenario.guidance.period)
    wanted = LONGER * max(scenario.horizon, scenario.horizon + check.values.get("after", 0.0))
    horizon = float(f"{math.ceil(wanted / grain - 1e-9) * grain:.12g}")
    yield _remedy(RemedyKind.HORIZON, ("with horizon ", number(horizon, "s")), (("scenario", "horizon"), horizon))


def _agreeing(check: Check, ran: Ran) -> Iterator[Remedy]:
    """More evaluations for global methods that used theirs up or had too few, else a further global method."""
    planned = list(enumerate(ran.campaign.stages.search))
    result = dict(zip((i for i, _ in planned), ran.searches, strict=False))
    if len(ran.searches) != len(planned):
        return
    globally = [(i, search) for i, search in planned if rules.FAMILIES[result[i].kind].all_agree]
    more = [(i, search, wanted) for i, search in globally if (wanted := _budget(ran, search, result[i]))]
    if more:
        yield _more(more, [result[i].title for i, _, _ in more])
    if not more or len({search.method for _, search in globally}) < 2:
        yield from _further(ran, [search for _, search in globally])


def _budget(ran: Ran, search: Search, result: SearchResult) -> int | None:
    """The budget with which a search is repeated; None if it ended by its own rule after enough evaluations."""
    least = rules.GLOBAL_LEAST.value * len(ran.campaign.uncertain)
    if result.evaluations >= least and (result.stop is None or result.stop.kind != "budget"):
        return None
    wanted = min(max(MORE * search.evaluations, least, _confirms(ran, search.method)), MAX_EVALUATIONS)
    return wanted if wanted > search.evaluations else None


def _confirms(ran: Ran, name: str) -> int:
    """The evaluations from which each part of a method counts as a search; 0 if it has none."""
    entry = next((method for method in ran.methods if method.name == name), None)
    return 0 if entry is None else entry.confirms * len(ran.campaign.uncertain)


def _more(more: Sequence[tuple[int, Search, int]], titles: Sequence[str]) -> Remedy:
    wanted = {each for _, _, each in more}
    of = listed([method(search.method, title) for (_, search, _), title in zip(more, titles, strict=True)])
    each = "each of " if len(more) > 1 else ""
    factor = all(value == MORE * search.evaluations for _, search, value in more)
    statement: tuple[Part, ...] = (f"with {f'{MORE} times the' if factor else 'more'} evaluations of ", of)
    if len(wanted) == 1:
        statement = ("with ", count(wanted.pop()), f" evaluations for {each}", of)
    return _remedy(
        RemedyKind.EVALUATIONS, statement, *((("stages", "search", i, "evaluations"), value) for i, _, value in more)
    )


def _further(ran: Ran, globally: Sequence[Search]) -> Iterator[Remedy]:
    searches = ran.campaign.stages.search
    used = {search.method for search in searches}
    another = next((m for m in ranked(ran.methods) if m.name not in used), None)
    if another is None:
        return
    least = rules.GLOBAL_LEAST.value * len(ran.campaign.uncertain)
    budget = max([least, *(search.evaluations for search in globally or searches)])
    if not globally:  # then its parts must confirm each other
        budget = min(max(budget, _confirms(ran, another.name)), MAX_EVALUATIONS)
    value: JsonValue = {"method": another.name, "evaluations": budget}
    statement = ("with ", method(another.name, another.title), " as a further method")
    yield _remedy(RemedyKind.METHOD, statement, (("stages", "search", len(searches)), value))


def _distinguished(check: Check, ran: Ran) -> Iterator[Remedy]:
    """More evaluations to distinguish and polish the worst cases."""
    if not ran.searches or all(search.best is None for search in ran.searches):
        return
    stages = ran.campaign.stages
    stated, stage = stages.findings.evaluations, "findings"
    if stated in (FINDINGS, FINDINGS // MORE) or stages.validate_.evaluations is not None:  # the usual number asks none
        stated, stage = validation(ran.campaign).total, "validate"
    wanted = min(MORE * max(stated, 1000), MAX_EVALUATIONS)
    statement = ("with ", count(wanted), " evaluations to distinguish the worst cases")
    yield _remedy(RemedyKind.FINDINGS, statement, (("stages", stage, "evaluations"), wanted))


def _larger_sample(check: Check, ran: Ran) -> Iterator[Remedy]:
    """An independent sample that is large enough for the bound, if few of its flights violate."""
    stated, goal = ran.statistics, rules.required(ran.campaign.target_probability)
    if stated is None or ran.campaign.stages.certify is None:
        wanted = needed(0, 0, goal, ran.campaign.confidence)
    else:
        beyond = max(0.0, stated.upper_bound - bound(stated.violations, stated.samples, stated.confidence))
        # A bound that the distributions' tails add to the sample's: see `worker.engine.stages.parts.sample`.
        goal -= beyond if beyond > 1e-9 else 0.0
        wanted = needed(stated.violations, stated.samples, goal, stated.confidence)
    if wanted is None:
        return
    certify = ran.campaign.stages.certify
    if certify is None:
        statement: tuple[Part, ...] = ("with an independent sample of ", count(wanted))
        value: dict[str, JsonValue] = {"samples": wanted}
        yield _remedy(RemedyKind.SAMPLE, statement, (("stages", "certify"), value | _keeping(wanted)))
    elif wanted > certify.samples and (certify.grid is None or wanted <= MAX_EVALUATIONS):
        statement = ("with ", count(wanted), " samples")
        keeping = {} if certify.grid is not None else _keeping(wanted)
        changes = [(("stages", "certify", name), new) for name, new in ({"samples": wanted} | keeping).items()]
        yield _remedy(RemedyKind.SAMPLE, statement, *changes)


def _keeping(samples: int) -> dict[str, JsonValue]:
    """What a sample of this size keeps: of a large one the lowest flights."""
    return {"keep": "lowest"} if samples > STORED_WHOLE else {}


def _drawn_noise(check: Check, ran: Ran) -> Iterator[Remedy]:
    """The worst of the realisations, or a sample that draws one for every flight."""
    scenario = ran.campaign.scenario
    if scenario is not None and len(scenario.realisations.seeds) > 1 and scenario.realisations.combine == "mean":
        statement = ("with the worst of the noise realisations instead of their mean",)
        yield _remedy(RemedyKind.REALISATIONS, statement, (("scenario", "realisations", "combine"), "worst"))
    elif ran.campaign.stages.certify is None:
        yield _certified()


def _repeated_calls(check: Check, ran: Ran) -> Iterator[Remedy]:
    """Several calls of a simulator that does not repeat, of which the worst counts."""
    simulator = ran.campaign.simulator
    if simulator is None or (check.code == CheckCode.CALLS and simulator.calls == 1 and "repeats" not in check.values):
        return  # what fails only sometimes would only fail more often
    if check.code == CheckCode.REPETITION and any(result is not None and result.halved for result in ran.results):
        return  # if its calls differ, another check says so; several would not be made at half the step
    at = ("simulator", "repeats")
    if simulator.calls == 1:
        calls = int(check.values.get("repeats", rules.CALLS_UNMEASURED))
        statement: tuple[Part, ...] = ("with the worst of ", count(calls), " calls for each evaluation")
        yield _remedy(RemedyKind.CALLS, statement, (at, {"count": calls, "combine": "worst"}))
    elif simulator.combine != "worst":
        statement = ("with the worst of the ", count(simulator.calls), f" calls instead of their {simulator.combine}")
        yield _remedy(RemedyKind.CALLS, statement, (at, {"count": simulator.calls, "combine": "worst"}))
    elif ran.campaign.stages.certify is None:
        yield _certified()


def _certified() -> Remedy:
    samples = Certify().samples
    statement = ("with an independent sample of ", count(samples))
    return _remedy(RemedyKind.SAMPLE, statement, (("stages", "certify"), {"samples": samples}))


_OF: dict[RemedyKind, Callable[[Check, Ran], Iterator[Remedy]]] = {
    RemedyKind.EVALUATIONS: _agreeing,
    RemedyKind.FINDINGS: _distinguished,
    RemedyKind.STEP: _smaller_step,
    RemedyKind.CALLS: _repeated_calls,
    RemedyKind.HORIZON: _longer_horizon,
    RemedyKind.REALISATIONS: _drawn_noise,
    RemedyKind.SAMPLE: _larger_sample,
}
"""By the remedy that the rule of a check names."""
