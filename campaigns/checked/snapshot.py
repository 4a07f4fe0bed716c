"""The part of a catalogue that a campaign uses, stored with its runs: the meaning of its components and methods.

A snapshot is a catalogue of the used entries only, identified by its own digest, so that runs share it. `changes`
reports the differences from the present catalogue.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue, ComponentEntry, MethodEntry, ParameterEntry, SimulatorEntry
from campaigns.checked.check import parameters, parts
from campaigns.documents import digest_of as digest_of
from campaigns.versions import NOT_INSTALLED

_WORDS = {
    "title": "title",
    "dimension": "dimension",
    "frame": "frame of axes",
    "written_in": "assumed frame of axes",
    "moving": "autonomous movement",
    "fits": "list of supported vehicles",
    "demand": "kind of demand",
    "demands": "supported kinds of demand",
    "inputs": "inputs",
    "path": "position in the loop",
    "unit": "unit",
    "quantity": "quantity",
    "worse": "direction of search",
    "of": "object that it measures",
    "measured_to": "reference point of distances",
    "own_rule": "rule by which it excludes",
    "unswitched": "lack of switches",
    "reach": "reach",
    "rate": "rate of motion",
    "orders": "condition on its parameters",
    "kind": "kind",
    "source": "source",
    "how": "short description of the search",
    "starts": "use of start points",
    "evaluations": "usual budget",
    "family": "family",
    "families": "families",
    "apart": "members that are apart",
}
_ADVICE = (
    "whole_budget", "own_rule", "effort", "parallel", "at_once", "takes", "suits", "drawback", "proposed", "confirms",
    "most_parameters",
)  # fmt: skip
"""What a method states for its choice, for estimates and for the check of a campaign; it changes no result."""
_GROUPS = {"parameters": "", "starts": "start state ", "goals": "goal "}


def snapshot(campaign: Campaign, catalogue: Catalogue) -> Catalogue:
    """The entries that the campaign uses, in the catalogue's order; entries missing from the catalogue are omitted."""
    used = {(role, part.component) for _, _, role, part in parts(campaign)}
    searched = {search.method for search in campaign.stages.search}
    return Catalogue(
        version=catalogue.version,
        components=[c for c in catalogue.components if (c.role, c.name) in used],
        methods=[m for m in catalogue.methods if m.name in searched],
        simulators=[s for s in catalogue.simulators if campaign.simulator and s.name == campaign.simulator.name],
    )


def changes(then: Catalogue, now: Catalogue) -> list[str]:
    """The differences between another catalogue and a snapshot's entries, as clauses; the version is not compared."""
    found: list[str] = []
    for component in then.components:
        called, here = f"the {component.role} {component.name}", now.component(component.role, component.name)
        found += [_gone(called)] if here is None else _component(called, component, here)
    for method in then.methods:
        called, same = f"the method {method.name}", now.method(method.name)
        found += [_gone(called)] if same is None else _method(called, method, same)
    for simulator in then.simulators:
        called, own = f"the simulator {simulator.name}", now.simulator(simulator.name)
        found += [_gone(called)] if own is None else _simulator(called, simulator, own)
    return found


def values_changed(campaign: Campaign, then: Catalogue, now: Catalogue) -> list[str]:
    """The differences that change the campaign's simulations, as clauses: effective values, units, missing
    components."""
    if gone := absent(then.model_copy(update={"methods": []}), now):
        return gone
    found, after = [], parameters(campaign, now)
    for path, (entry, value) in parameters(campaign, then).items():
        if path not in after:
            found.append(f"{path} no longer exists in this installation")
            continue
        was, is_ = _value(value, entry.unit), _value(after[path][1], after[path][0].unit)
        if was != is_:
            found.append(f"{path} was {was}, here it is {is_}")
    return found


def absent(then: Catalogue, now: Catalogue) -> list[str]:
    """The entries of a snapshot that another catalogue does not have, as clauses."""
    gone = [f"the {c.role} {c.name}" for c in then.components if now.component(c.role, c.name) is None]
    gone += [f"the method {m.name}" for m in then.methods if now.method(m.name) is None]
    gone += [f"the simulator {s.name}" for s in then.simulators if now.simulator(s.name) is None]
    return [_gone(called) for called in gone]


def _component(called: str, then: ComponentEntry, now: ComponentEntry) -> Iterator[str]:
    yield from _fields(called, then, now, ("parameters", "starts", "goals", "role", "name", "look", "computed_by"))
    for group in _GROUPS:
        yield from _parameters(called, then, now, group)


def _parameters(
    called: str, then: ComponentEntry | SimulatorEntry, now: ComponentEntry | SimulatorEntry, group: str
) -> Iterator[str]:
    """Default values that the campaign relies on, parameters that no longer exist, and then what else differs."""
    before, after, of = _by_name(then, group), _by_name(now, group), _GROUPS[group]
    for name, entry in before.items():
        if name not in after:
            yield f"{called} has no parameter {of}{name} in this installation any more"
        elif after[name].default != entry.default:
            was, is_ = _value(entry.default, entry.unit), _value(after[name].default, after[name].unit)
            yield f"the default of {of}{name} of {called} was {was}, here it is {is_}"
    for name, entry in after.items():
        if name in before:
            yield from _parameter(f"{of}{name} of {called}", before[name], entry)
        else:
            yield f"{called} has one more parameter here, {of}{name}"


def _parameter(called: str, then: ParameterEntry, now: ParameterEntry) -> Iterator[str]:
    if (then.low, then.high) != (now.low, now.high):
        was, is_ = (f"{p.low:g} to {p.high:g}" for p in (then, now))
        yield f"the limits of {called} were {was}, here they are {is_}"
    for field in ("symbol", "unit", "text"):
        was, is_ = getattr(then, field), getattr(now, field)
        if was != is_:
            yield f"the {field} of {called} was “{was}”, here it is “{is_}”"


def _method(called: str, then: MethodEntry, now: MethodEntry) -> Iterator[str]:
    yield from _fields(called, then, now, ("name", "options", "look", *_ADVICE))
    before, after = (entry.options.get("properties", {}) for entry in (then, now))
    for name in {**before, **after}:
        if name not in after or name not in before:
            yield f"{called} has {'no' if name in before else 'one more'} option {name} here"
        elif before[name] != after[name]:
            was, is_ = (options[name].get("default") for options in (before, after))
            what = f"its default was {was}, here it is {is_}" if was != is_ else "its limits or text are different here"
            yield f"the option {name} of {called}: {what}"


def _simulator(called: str, then: SimulatorEntry, now: SimulatorEntry) -> Iterator[str]:
    if (then.title, then.text) != (now.title, now.text):
        yield f"the text of {called} is different here"
    if then.results != now.results:
        yield f"the results of {called} are described differently here"
    yield from _parameters(called, then, now, "parameters")


def _fields(
    called: str, then: ComponentEntry | MethodEntry, now: ComponentEntry | MethodEntry, but: tuple[str, ...]
) -> Iterator[str]:
    """Plain fields; of the long text only that it has changed. A look does not affect a simulation; that
    the code of a criterion has changed is stated with the identity of a run."""
    for field in type(then).model_fields:
        was, is_ = getattr(then, field), getattr(now, field)
        # A field that the older catalogue did not record yet shows no change.
        if field in but or was == is_ or field not in then.model_fields_set:
            continue
        if field == "text":
            yield f"the text of {called} (equations, source) is different here"
        else:
            yield f"the {_WORDS.get(field, field)} of {called} was {_shown_value(was)}, here it is {_shown_value(is_)}"


def _gone(called: str) -> str:
    return f"{called} {NOT_INSTALLED}"


def _by_name(entry: ComponentEntry | SimulatorEntry, group: str) -> dict[str, ParameterEntry]:
    return {p.name: p for p in getattr(entry, group)}


def _value(value: float | None, unit: str) -> str:
    return "none" if value is None else f"{repr(value).removesuffix('.0')} {unit}".strip()


def _shown_value(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(str, value)) or "none"
    return "none" if value in (None, "") else f"“{value}”" if isinstance(value, str) else str(value)
