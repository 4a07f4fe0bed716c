"""What a model expects where pydantic refuses a value, as a clause of ours: `expected`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

from pydantic import BaseModel
from pydantic_core import ErrorDetails

LIMITS = {"exclusiveMinimum": "above", "minimum": "of at least", "exclusiveMaximum": "below", "maximum": "of at most"}
"""By the words of a JSON Schema; an interval names the lower end first."""
WORDS = {
    "string_type": "expected text",
    "int_type": "expected a whole number",
    "int_from_float": "expected a whole number",
    "int_parsing": "expected a whole number",
    "int_parsing_size": "expected a whole number",
    "float_type": "expected a number",
    "float_parsing": "expected a number",
    "bool_type": "expected true or false",
    "bool_parsing": "expected true or false",
    "finite_number": "expected a finite number",
    "list_type": "expected a list",
    "tuple_type": "expected a list",
    "dict_type": "expected a mapping of names and values",
    "model_type": "expected a mapping of names and values",
    "model_attributes_type": "expected a mapping of names and values",
    "missing": "this key is required",
    "extra_forbidden": "unknown key; remove it or correct its spelling",
}


def expected(error: ErrorDetails, model: type[BaseModel]) -> str:
    """The clause for one error of a model, as `ValidationError.errors` gives it with its context."""
    kind, context = str(error["type"]), error.get("ctx", {})
    if kind.startswith(("greater_than", "less_than")):
        return f"expected a number {_interval(model, error['loc'])}"
    if kind == "multiple_of":
        return f"expected a multiple of {_number(context['multiple_of'])} {_interval(model, error['loc'])}".rstrip()
    if kind in ("too_short", "too_long", "string_too_short", "string_too_long"):
        least = kind.endswith("short")
        many = context["min_length" if least else "max_length"]
        what = "character" if kind.startswith("string") else "entry"
        plural = {"character": "characters", "entry": "entries"}[what] if many != 1 else what
        length_clause = f", given {context['actual_length']}" if context.get("actual_length") is not None else ""
        return f"expected at {'least' if least else 'most'} {many:,} {plural}{length_clause}"
    if kind in ("literal_error", "enum"):
        return f"expected {context['expected']}"
    if kind == "string_pattern_mismatch":
        return f"expected text of the form {context['pattern']}"
    if kind == "union_tag_invalid":
        return f"expected the {context['discriminator']} {context['expected_tags']}"
    if kind == "union_tag_not_found":
        return f"the key {context['discriminator']} is required"
    return WORDS.get(kind) or str(error["msg"]).removeprefix("Value error, ")


def _interval(model: type[BaseModel], at: Sequence[str | int]) -> str:
    """The limits of a number: both, although a value is beyond one of them."""
    schema = _schema(model)
    nodes = [*_alternatives(schema, schema)]
    for key in at:
        inside = [child for node in nodes for child in _children(node, key)]
        # The tag of an alternative, such as the kind of a distribution, selects it.
        if tags := [tag for node in nodes if (tag := node.get("discriminator", {}).get("mapping", {}).get(key))]:
            inside = [{"$ref": tag} for tag in tags]
        # A key that no schema has is the name of an alternative, of which all are in the list already.
        nodes = [found for child in inside for found in _alternatives(child, schema)] or nodes
    found = {name: node[name] for node in nodes for name in LIMITS if name in node}
    stated = " and ".join(f"{words} {_number(found[name])}" for name, words in LIMITS.items() if name in found)
    return stated.replace(" and of ", " and ")


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    return model.model_json_schema()


def _alternatives(node: Mapping[str, Any], schema: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """A node, those that it refers to, and those of which it is one."""
    yield node
    if "$ref" in node:
        yield from _alternatives(schema["$defs"][node["$ref"].rpartition("/")[2]], schema)
    for word in ("anyOf", "oneOf", "allOf"):
        for one in node.get(word, ()):
            yield from _alternatives(one, schema)


def _children(node: Mapping[str, Any], key: str | int) -> Iterator[Mapping[str, Any]]:
    named = node.get("properties", {}).get(key)
    parts = node.get("prefixItems", [])
    inside = [named, node.get("items") if isinstance(key, int) else node.get("additionalProperties")]
    if isinstance(key, int):
        inside += parts[key : key + 1]
    else:
        inside += [one for pattern, one in node.get("patternProperties", {}).items() if re.search(pattern, key)]
    yield from (one for one in inside if isinstance(one, dict))


def _number(value: float) -> str:
    return f"{int(value):,}" if float(value).is_integer() and abs(value) <= 2**53 else f"{value:g}"
