"""Validates the options of searches against what their methods declare: the JSON Schema, and what a value is for."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Search
from campaigns.catalogue import Catalogue, MethodEntry
from campaigns.checked import texts


def value(search: Search, entry: MethodEntry, name: str) -> Any:
    """The value of an option: as stated, else the default of the method; None without either."""
    return search.options.get(name, entry.options.get("properties", {}).get(name, {}).get("default"))


def changed(search: Search, entry: MethodEntry, names: Iterable[str]) -> bool:
    """Whether one of these options has another value than its default."""
    usual = search.model_copy(update={"options": {}})
    return any(value(search, entry, name) != value(usual, entry, name) for name in names)


def unsuited(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    """Options with which a search cannot begin, because the campaign has more uncertain parameters than they take."""
    dimension = len(campaign.uncertain)
    for i, search in enumerate(campaign.stages.search):
        entry = catalogue.method(search.method)
        if entry is None:
            continue
        for name, most in entry.most_parameters.items():
            chosen = str(value(search, entry, name))
            if dimension > most.get(chosen, dimension):
                text = f"{chosen} takes at most {most[chosen]} uncertain parameters, this campaign has {dimension}: "
                yield Problem(f"stages.search.{i}.options.{name}", chosen, f"{text}choose another, or vary fewer")


def refused(field: str, options: Mapping[str, Any], schema: Mapping[str, Any]) -> Iterator[Problem]:
    """Validates the JSON Schema keywords that an options dataclass yields: type, enum, minimum, maximum."""
    properties = schema.get("properties", {})
    for name, value in options.items():
        if name not in properties:
            yield Problem(f"{field}.{name}", str(value), f"no such option; {texts.known(name, properties)}")
        elif (reason := _misfit(value, properties[name])) is not None:
            yield Problem(f"{field}.{name}", repr(value), reason)


_TYPES = {"integer": (int,), "number": (int, float), "string": (str,), "boolean": (bool,), "null": (type(None),)}


def _misfit(value: Any, rule: Mapping[str, Any]) -> str | None:
    if "anyOf" in rule:
        reasons = [_misfit(value, r) for r in rule["anyOf"]]
        return None if None in reasons else next(r for r in reasons if r is not None)
    kind = rule.get("type")
    if kind in _TYPES and (not isinstance(value, _TYPES[kind]) or (isinstance(value, bool) and kind != "boolean")):
        return f"expected a value of type {kind}"
    if "enum" in rule and value not in rule["enum"]:
        return f"expected one of {', '.join(map(str, rule['enum']))}"
    limits: tuple[tuple[str, Callable[[Any, Any], bool], str], ...] = (
        ("minimum", operator.lt, "at least"),
        ("maximum", operator.gt, "at most"),
        ("exclusiveMinimum", operator.le, "above"),
        ("exclusiveMaximum", operator.ge, "below"),
    )
    for word, outside, text in limits:
        if word in rule and (value != value or outside(value, rule[word])):
            return f"expected {text} {rule[word]}"
    return None
