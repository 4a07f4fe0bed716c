"""The question that a campaign asks: what it evaluates, within which bounds, by which criterion.

What is written differently and evaluates the same is the same question: a violation must not be lifted by a unit that
is stated, or by `plus_minus: 20%` in place of the bounds that it means. Nor by wider bounds: see `box`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pydantic import BaseModel

from campaigns.asked.scenario import Scenario
from campaigns.asked.spec import Campaign
from campaigns.asked.values import PlusMinus
from campaigns.catalogue import Catalogue
from campaigns.checked.box import Box, Part
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
    defaults = _defaults(campaign, described)
    bounds = _bounds(campaign, described, defaults)
    omitted = {path for path, value in defaults.items() if path in bounds and bounds[path] == (value, value)}
    omitted -= campaign.uncertain.keys()
    texts: dict[str, list[str]] = {}
    for prefix, name, fields in _named(campaign):
        values = {end: bound for end, bound in _below(prefix, bounds).items() if f"{prefix}.{end}" not in omitted}
        texts.setdefault(name, []).append(canonical({"fields": fields, "values": values}))
    return digest_of({name: sorted(each) for name, each in texts.items()})


def box(campaign: Campaign, described: Catalogue | None) -> Box:
    """The bounds of all values of the question, defaults included, and the digest of all else that it asks."""
    bounds = _bounds(campaign, described, _defaults(campaign, described))
    texts: dict[str, list[str]] = {}
    parts: dict[str, list[Part]] = {}
    for prefix, name, fields in _named(campaign):
        values = _below(prefix, bounds)
        unknown = {end: bound for end, bound in values.items() if not isinstance(bound, tuple)}
        what = canonical({"fields": fields, "unknown": unknown})
        texts.setdefault(name, []).append(what)
        known = {end: bound for end, bound in values.items() if isinstance(bound, tuple)}
        parts.setdefault(f"{name} {digest_of({'what': what})}", []).append(Part(prefix, known))
    return Box(digest_of({name: sorted(each) for name, each in texts.items()}), parts)


def _named(campaign: Campaign) -> Iterator[tuple[str, str, object]]:
    """Of each part the prefix of the paths of its values, what the question calls it, and what counts of its fields."""
    for prefix, part, left_out in _parts(campaign):
        fields = {} if part is None else part.model_dump(exclude={"parameters", *left_out})
        if isinstance(part, Scenario):
            fields |= _steps(part)
        group = prefix.partition(".")[0]
        yield prefix, group if group in _UNORDERED else prefix, fields


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


def _defaults(campaign: Campaign, described: Catalogue | None) -> dict[str, float]:
    known = {} if described is None else parameters(campaign, described)
    return {path: entry.default for path, (entry, _) in known.items() if entry.default is not None}


def _bounds(campaign: Campaign, described: Catalogue | None, defaults: Mapping[str, float]) -> dict[str, Bounds]:
    """The bounds of every value that is stated, uncertain or a default, by path, without seeds, which select a
    realisation as `realisations` does."""
    stated = {**defaults, **dict(_stated(campaign))}
    found: dict[str, Bounds] = {}
    seeds = () if described is None else seeded(campaign, described)
    for path in (stated.keys() | campaign.uncertain.keys()).difference(seeds):
        uncertain, value = campaign.uncertain.get(path), stated.get(path)
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
