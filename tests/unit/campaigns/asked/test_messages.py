"""Every limit and every choice of keys in the schema of a campaign is in the message for a value outside of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from campaigns import CampaignError, Problem, limits
from campaigns.asked.expected import LIMITS
from campaigns.asked.load import load_document
from campaigns.asked.spec import Campaign
from tests.given.small_catalogue import campaign

SCHEMA = Campaign.model_json_schema()
KEYS = {
    "^[A-Za-z_][A-Za-z0-9_]*(\\.[A-Za-z0-9_]+)+$": "vehicle.m",
    "^(obstacles|environment|faults)\\.(0|[1-9][0-9]?)$": "obstacles.0",
}
"""A key for each pattern of keys."""
Place = tuple[str | int, ...]


def walked(node: dict[str, Any], at: Place = (), fixed: tuple[tuple[Place, Any], ...] = ()) -> Iterator[Any]:
    """Every node of the schema with its place in a document, and what must be elsewhere for it to be the one."""
    if "$ref" in node:
        yield from walked(SCHEMA["$defs"][node["$ref"].rpartition("/")[2]], at, fixed)
    yield at, node, fixed
    mapping = node.get("discriminator", {}).get("mapping", {})
    for kind, ref in mapping.items():
        yield from walked({"$ref": ref}, at, (*fixed, ((*at, node["discriminator"]["propertyName"]), kind)))
    for word in ("anyOf", "allOf", *(() if mapping else ("oneOf",))):
        for one in node.get(word, ()):
            yield from walked(one, at, fixed)
    inside: dict[str | int, Any] = dict(node.get("properties", {}))
    inside |= {KEYS[pattern]: one for pattern, one in node.get("patternProperties", {}).items()}
    inside |= dict(enumerate(node.get("prefixItems", ())))
    inside |= {"x" if name == "additionalProperties" else 0: node[name]
               for name in ("additionalProperties", "items") if isinstance(node.get(name), dict)}  # fmt: skip
    for key, one in inside.items():
        yield from walked(one, (*at, key), fixed)


def put(document: Any, at: Place, value: Any) -> Any:
    """The document with the value at a place, and with what leads there."""
    if not at:
        return value
    if isinstance(at[0], int):
        return [*[0.0] * at[0], put(document[at[0]] if document else None, at[1:], value)]
    return {**(document or {}), at[0]: put((document or {}).get(at[0]), at[1:], value)}


def problems(at: Place, value: Any, fixed: tuple[tuple[Place, Any], ...] = ()) -> list[Problem]:
    """Those of a campaign that has nothing but this, at the place."""
    document: Any = {}
    for place, given in (*fixed, (at, value)):
        document = put(document, place, given)
    with pytest.raises(CampaignError) as caught:
        load_document(document)
    field = ".".join(map(str, at))
    return [problem for problem in caught.value.problems if problem.field == field]


def beyond(word: str, limit: float) -> float:
    """A value outside of one limit."""
    return limit if word.startswith("exclusive") else limit - 1 if word == "minimum" else limit + 1


def number(limit: float) -> str:
    return f"{int(limit):,}" if float(limit).is_integer() else f"{limit:g}"


LIMITED = [(at, word, node[word], fixed) for at, node, fixed in walked(SCHEMA) for word in LIMITS if word in node]
CHOICES = [
    (at, node["propertyNames"]["enum"]) for at, node, _ in walked(SCHEMA) if "enum" in node.get("propertyNames", ())
]


@pytest.mark.parametrize(("at", "word", "limit", "fixed"), LIMITED, ids=lambda v: str(v)[:60])
def test_the_message_for_a_number_beyond_a_limit_has_the_limit(
    at: Place, word: str, limit: float, fixed: tuple[tuple[Place, Any], ...]
) -> None:
    found = problems(at, beyond(word, limit), fixed)
    assert found
    assert f"{LIMITS[word].removeprefix('of ')} {number(limit)}" in found[0].message


def test_limits_are_found_in_mappings_and_kinds() -> None:
    places = {".".join(map(str, at)) for at, *_ in LIMITED}
    assert {
        "confidence",
        "uncertain.vehicle.m.distribution.deviation",
        "uncertain.vehicle.m.distribution.alpha",
    } <= places
    assert len(places) > 30


def test_a_stored_campaign_below_the_least_confidence_is_read() -> None:
    """New ones are refused: see the checks."""
    assert load_document(campaign(confidence=0.6)).confidence < limits.CONFIDENCE_AT_LEAST
    assert SCHEMA["properties"]["confidence"]["minimum"] == limits.CONFIDENCE_AT_LEAST


@pytest.mark.parametrize(("at", "keys"), CHOICES, ids=lambda v: str(v)[:40])
def test_the_message_for_an_unknown_key_has_those_that_there_are(at: Place, keys: list[str]) -> None:
    found = problems((*at, f"{keys[0]}x"), "a reason")
    assert found
    assert [key for key in keys if repr(key) not in found[0].message] == []


def test_a_key_that_is_no_path_is_refused_as_one() -> None:
    assert CHOICES
    (found,) = problems(("uncertain", "mass"), {"low": 1.0, "high": 2.0})
    assert "vehicle.m" in found.message
