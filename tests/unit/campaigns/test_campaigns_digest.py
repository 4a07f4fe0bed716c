"""The digest of a campaign: independent of formatting, different for every value; and the JSON Schema."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator
from typing import Any

import pytest
import yaml

from campaigns import Campaign, library, load_file, load_text
from campaigns.asked.load import load_document
from campaigns.asked.text import to_yaml
from campaigns.documents import canonical
from tests.given.case_campaigns import CASE1, campaign, document, nested, searching


def shuffled(value: Any, chance: random.Random) -> Any:
    """The document with its keys in another order."""
    if isinstance(value, dict):
        items = [(key, shuffled(inner, chance)) for key, inner in value.items()]
        chance.shuffle(items)
        return dict(items)
    return [shuffled(inner, chance) for inner in value] if isinstance(value, list) else value


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_keys_means_nothing(seed: int) -> None:
    found = load_document(shuffled(CASE1, random.Random(seed)))
    assert found == campaign()
    assert found.digest == campaign().digest
    assert list(found.uncertain) == ["vehicle.m", "vehicle.J"]  # the axes of the search, so that the numbers agree too


def test_the_form_of_the_file_means_nothing() -> None:
    digest = campaign().digest
    assert load_text(json.dumps(CASE1)).digest == digest
    assert load_text(yaml.safe_dump(CASE1)).digest == digest
    assert load_text(to_yaml(campaign())).digest == digest
    assert load_text(canonical(campaign().document())).digest == digest
    changed = document()
    for obstacle in changed["scenario"]["obstacles"]:
        obstacle["parameters"] = nested(obstacle["parameters"])
    assert changed != CASE1
    assert load_document(changed).digest == digest


def test_defaults_may_be_written_out_or_left_out() -> None:
    defaults = {"version": 1, "agreement": 0.05, "confidence": 0.95, "seed": 1, "target_probability": None}
    short = {k: v for k, v in document(agreement=0.05, seed=1).items() if k not in defaults}
    assert load_document(short).digest == load_document(short | defaults).digest
    assert campaign(scenario__guidance={}).digest == campaign(scenario__guidance={"period": 0}).digest
    bounds = {"low": 4, "high": 6}
    spelled = bounds | {"plus_minus": None, "unit": None, "distribution": {"kind": "uniform"}}
    digests = {campaign(**{"uncertain__vehicle.m": b}).digest for b in (bounds, spelled, bounds | {"low": "4.0"})}
    digests.add(campaign(**{"uncertain__vehicle.m": bounds | {"distribution": "uniform"}}).digest)
    assert len(digests) == 1


@pytest.mark.parametrize(("one", "other"), [(5, 5.0), (0.0, -0.0), (1e-3, "1e-3"), (1e6, 10**6)])
def test_the_spelling_of_a_number_means_nothing(one: Any, other: Any) -> None:
    assert campaign(scenario__start__x=one).digest == campaign(scenario__start__x=other).digest
    search = {"method": "direct", "evaluations": 10}
    a, b = (searching(search | {"options": {"o": float(v)}}).digest for v in (one, other))
    assert a == b == searching(search | {"options": {"o": one}}).digest


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every plain value of a document with its path, joined by `__`."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value)
    for key, inner in pairs:
        place = f"{path}__{key}" if path else str(key)
        if isinstance(inner, dict | list):
            yield from leaves(inner, place)
        else:
            yield place, inner


def another(place: str, value: Any) -> Any:
    """Another value that is valid at the same path."""
    others = {"uniform": "uniform", "worst": "mean", "20%": "21%", "kg": "g", "kg m2": "g m2", 15.0: 14.0}
    if place == "scenario__guidance__period":
        return CASE1["scenario"]["step"]
    if isinstance(value, str):
        return others.get(value, value + "x")
    if value is None:
        return None
    return others.get(value, value + 1 if isinstance(value, int) else value * (1 + 2**-52) or 1e-300)


def test_every_value_counts() -> None:
    digests = {campaign().digest: "the campaign itself"}
    fixed = {"version", "scenario__step"}
    for place, value in leaves(CASE1):
        changed = another(place, value)
        if place in fixed or changed in (None, "uniform"):
            continue
        digest = campaign(**{place: changed}).digest
        assert digest not in digests, f"{place} = {changed!r} has the digest of {digests.get(digest)}"
        digests[digest] = f"{place} = {changed!r}"
    assert len(digests) > 60


def test_campaigns_never_change() -> None:
    with pytest.raises(ValueError, match="frozen"):
        campaign().seed = 2


# The few words of JSON Schema that pydantic writes.

TYPES = {"object": dict, "array": list, "string": str, "integer": int, "number": int | float, "null": type(None)}


def misfits(value: Any, rule: Any, root: Any, at: str = "$") -> list[str]:
    """Where a document breaks a JSON Schema."""
    if "$ref" in rule:
        return misfits(value, root["$defs"][rule["$ref"].rpartition("/")[2]], root, at)
    if "anyOf" in rule or "oneOf" in rule:
        found = [misfits(value, r, root, at) for r in rule.get("anyOf", rule.get("oneOf"))]
        return [] if [] in found else min(found, key=len)
    wrong = []
    if "type" in rule and (not isinstance(value, TYPES[rule["type"]]) or isinstance(value, bool)):
        return [f"{at} is no {rule['type']}"]
    if "const" in rule and value != rule["const"]:
        wrong.append(f"{at} is not {rule['const']!r}")
    if "pattern" in rule and not re.search(rule["pattern"], value):
        wrong.append(f"{at} is not like {rule['pattern']}")
    for word, broken in (
        ("minimum", lambda limit: value < limit), ("exclusiveMinimum", lambda limit: value <= limit),
        ("maximum", lambda limit: value > limit), ("exclusiveMaximum", lambda limit: value >= limit),
        ("minItems", lambda limit: len(value) < limit), ("maxItems", lambda limit: len(value) > limit),
        ("minLength", lambda limit: len(value) < limit), ("maxLength", lambda limit: len(value) > limit),
        ("minProperties", lambda limit: len(value) < limit), ("maxProperties", lambda limit: len(value) > limit),
    ):  # fmt: skip
        if word in rule and broken(rule[word]):
            wrong.append(f"{at} breaks {word}")
    if isinstance(value, list):
        for i, inner in enumerate(value):
            wrong += misfits(inner, rule.get("items", {}), root, f"{at}.{i}")
    if isinstance(value, dict):
        wrong += [f"{at}.{key} is missing" for key in rule.get("required", []) if key not in value]
        for key, inner in value.items():
            known = rule.get("properties", {}).get(key, rule.get("additionalProperties", {}))
            wrong += (
                [f"{at}.{key} is unknown"]
                if known is False
                else misfits(inner, {} if known is True else known, root, f"{at}.{key}")
            )
    return wrong


SCHEMA = json.loads(json.dumps(Campaign.model_json_schema()))


@pytest.mark.parametrize("name", library())
def test_the_json_schema_holds_for_the_library(name: str) -> None:
    flat = load_file(library()[name]).document()
    assert misfits(flat, SCHEMA, SCHEMA) == []


@pytest.mark.parametrize(
    ("changes", "statement"),
    [
        ({"sede": 1}, "$.sede is unknown"),
        ({"scenario__step": 0}, "$.scenario.step breaks exclusiveMinimum"),
        ({"scenario__vehicle__component": 5}, "$.scenario.vehicle.component is no string"),
        ({"stages__search": []}, "$.stages.search breaks minItems"),
        ({"stages__search__0__evaluations": 5.5}, "$.stages.search.0.evaluations is no integer"),
        ({"uncertain": {}}, "$.uncertain breaks minProperties"),
        ({"seed": -1}, "$.seed breaks minimum"),
        ({"version": 2}, "$.version is not 1"),
    ],
)
def test_the_json_schema_refuses_what_the_campaign_refuses(changes: dict[str, Any], statement: str) -> None:
    wrong = document(**changes)
    assert statement in misfits(wrong, SCHEMA, SCHEMA)
    with pytest.raises(ValueError, match=statement.split()[0].removeprefix("$.")):
        load_document(wrong)
