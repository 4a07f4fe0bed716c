"""The digest of the question that a campaign asks: what it evaluates, within which bounds, by which criterion.

What is written differently and evaluates the same is the same question: a violation must not be lifted by a unit that
is stated, or by `plus_minus: 20%` in place of the bounds that it means.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pydantic import BaseModel

from campaigns.asked.scenario import Scenario
from campaigns.asked.spec import Campaign
from campaigns.asked.values import PlusMinus
from campaigns.catalogue import Catalogue
from campaigns.checked.check import parameters, parts, seeded
from campaigns.checked.simulated import PREFIX
from campaigns.documents import canonical, digest_of

_PARTS = ("vehicle", "controller", "avoider", "start", "goal", "obstacles", "environment", "faults")
_UNASKED = {
    "scenario": ("realisations",),
    "simulator": ("repeats", "retries"),
    "criterion": ("requirements", "threshold", "from_centre"),
}
"""What removes no case: what an evaluation draws, calls and combines, and what is stated of its value."""
_UNORDERED = ("obstacles", "environment")
"""Parts of which an index is only a name, or selects the noise; faults act in their order."""

Bounds = tuple[float, float] | PlusMinus
"""Equal for a fixed value; as stated, if they are around a nominal value that is not known."""


def question(campaign: Campaign, described: Catalogue | None) -> str:
    """SHA-256 of what a campaign asks: system, bounds and criterion, without all that removes no violation.

    Without the threshold as well: a value that violates a threshold violates every higher one. Seed, methods, budgets,
    distributions and correlations decide whether a violation is found and how often, not whether it is there;
    objectives decide nothing; nor do the nominal values of uncertain parameters, apart from the bounds around them.

    described: the components at the launch. A value that equals its default is omitted: a component with another
    default, or with one more parameter, is another model and not another question. None: values are as stated.
    """
    bounds = _bounds(campaign, described)
    texts: dict[str, list[str]] = {}
    for prefix, part, left_out in _parts(campaign):
        fields = {} if part is None else part.model_dump(exclude={"parameters", *left_out})
        if isinstance(part, Scenario):
            fields |= _steps(part)
        group = prefix.partition(".")[0]
        whole = canonical({"fields": fields, "values": _below(prefix, bounds)})
        texts.setdefault(group if group in _UNORDERED else prefix, []).append(whole)
    return digest_of({name: sorted(each) for name, each in texts.items()})


def _parts(campaign: Campaign) -> Iterator[tuple[str, BaseModel | None, Sequence[str]]]:
    """All that is asked: prefix of the paths of its values, part, and which of its fields do not count."""
    scenario, simulator = campaign.scenario, campaign.simulator
    if scenario is not None:
        yield "scenario", scenario, (*_PARTS, *_UNASKED["scenario"])
        yield "start", None, ()
        yield "goal", None, ()
    if simulator is not None:
        yield PREFIX, simulator, _UNASKED["simulator"]
    yield from ((prefix, part, ()) for prefix, _, role, part in parts(campaign) if role != "criterion")
    yield "criterion", campaign.criterion, _UNASKED["criterion"]


def _bounds(campaign: Campaign, described: Catalogue | None) -> dict[str, Bounds]:
    """The bounds of every value that is stated or uncertain, by path, without fixed ones that equal their default, and
    without seeds, which select a realisation as `realisations` does."""
    known = {} if described is None else parameters(campaign, described)
    defaults = {path: entry.default for path, (entry, _) in known.items() if entry.default is not None}
    stated = defaults | dict(_stated(campaign))
    found: dict[str, Bounds] = {}
    seeds = () if described is None else seeded(campaign, described)
    for path in (stated.keys() | campaign.uncertain.keys()).difference(seeds):
        uncertain, value = campaign.uncertain.get(path), stated.get(path)
        if uncertain is None and defaults.get(path) == value:
            continue
        if uncertain is not None and uncertain.plus_minus is not None and value is None:
            found[path] = uncertain.plus_minus
        else:
            found[path] = campaign.interval(path, 0.0 if value is None else value)
    return found


def _stated(campaign: Campaign) -> Iterator[tuple[str, float]]:
    """The values that a campaign states, by path."""
    scenario, simulator = campaign.scenario, campaign.simulator
    groups: list[tuple[str, Mapping[str, float]]] = [
        (prefix, part.parameters) for prefix, _, _, part in parts(campaign)
    ]
    groups += [("start", scenario.start), ("goal", scenario.goal)] if scenario is not None else []
    groups += [(PREFIX, simulator.parameters)] if simulator is not None else []
    for prefix, values in groups:
        yield from ((f"{prefix}.{name}", value) for name, value in values.items())


def _steps(scenario: Scenario) -> dict[str, int]:
    """The horizon and the period of the avoider as they are evaluated: in whole steps."""
    horizon, period = (round(time / scenario.step) for time in (scenario.horizon, scenario.guidance.period))
    return {"horizon": horizon, "guidance": max(1, period) if scenario.guidance.period else 0}


def _below(prefix: str, bounds: Mapping[str, Bounds]) -> dict[str, Bounds]:
    start = f"{prefix}."
    return {path.removeprefix(start): bound for path, bound in bounds.items() if path.startswith(start)}
