"""Writes the types of the client's answers from the OpenAPI document: `python tools/client_answers.py`.

A field has the type and the description of the document. A field of a schema that is not in `CLASSES` is left to
`Answer.document`. A name here that the document does not have is an error. Start reading at `text`.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

Schema = Mapping[str, Any]
FILE = Path(__file__).parents[1] / "clearance" / "client" / "answers.py"
WIDTH = 120
HEAD = '''"""What the service answers, as types. Times are `datetime` in UTC; costs and margins are in the run's unit.

Written by tools/client_answers.py from the OpenAPI document. A field that is not described here is ignored, and is
still in `document`, the JSON as it was sent; what earlier versions did not send has a default. So a client works with
services of other versions. Start reading at `Run`.
"""

from __future__ import annotations

from pydantic import AwareDatetime

from campaigns.documents import JsonObject
from clearance.client.answer import Answer, RunAnswer, SweepAnswer
'''


class Class(NamedTuple):
    """A schema as a class of the client."""

    schema: str
    name: str
    required: str
    """The fields that services of all versions send; a class without any has those of its base."""
    base: str = "Answer"


CLASSES = (
    Class("Health", "Health", "status"),
    Class("ProblemOut", "FieldProblem", "field given message"),
    Class("Checked", "Checked", "ok digest problems"),
    Class("ExportFile", "ExportFile", "name title media_type href unavailable"),
    Class("StageProgress", "StageProgress", "position kind method state planned evaluations failed best seconds"),
    Class("RunBaseline", "Baseline", "asked run sentence"),
    Class("DescribedCheck", "Check", "name title standing text"),
    Class("RunVerdict", "VerdictParts", "verdict sentence scope checks"),
    Class(
        "RunSummary",
        "Run",
        "id name owner tags state verdict reason error campaign_name campaign_digest quantity unit threshold "
        "nominal_cost worst_cost margin evaluations planned failed_evaluations created started finished stage",
        "RunAnswer",
    ),
    Class("RunSubmitted", "Submitted", "", "Run"),
    Class("RunDetail", "RunDetail", "notes campaign stages summary", "Run"),
    Class("RunPage", "RunPage", "items next_cursor counts"),
    Class("Validation", "Validation", "ok"),
    Class("FindingDetail", "Finding", "label cost margin parameters nominal low high methods values at_bounds"),
    Class("TraceColumn", "TraceColumn", "name unit"),
    Class("TraceInfo", "TraceInfo", "name rows columns"),
    Class("TraceData", "TraceData", "data", "TraceInfo"),
    Class("Outcome", "Outcome", "state verdict margin upper_bound confidence unit error"),
    Class("SweepPoint", "SweepPoint", "value run outcome"),
    Class("SweepDetail", "Sweep", "id name path unit owner created runs states points", "SweepAnswer"),
)
NAMES = {one.schema: one.name for one in CLASSES} | {"Campaign": "JsonObject"}
TYPES = {"string": "str", "integer": "int", "number": "float", "boolean": "bool", "null": "None"}
EMPTY = {"list": "[]", "dict": "{}"}


def text(document: Schema) -> str:
    """The module."""
    known = document["components"]["schemas"]
    fields = {one.name: set(known[one.schema]["properties"]) for one in CLASSES}
    inherited = {one.name: fields.get(one.base, {"document"}) for one in CLASSES}
    return HEAD + "".join(f"\n\n{_class(one, known, inherited[one.name])}" for one in CLASSES)


def _class(one: Class, known: Schema, inherited: set[str]) -> str:
    schema = known[one.schema]
    required = set(one.required.split())
    unknown = required - set(schema["properties"])
    if unknown:
        raise KeyError(f"{one.schema} has no {', '.join(sorted(unknown))}")
    lines = [*_quoted(schema["description"]), ""]
    for name, described in schema["properties"].items():
        kind = _type(described, known)
        if name not in inherited and kind is not None:
            lines += [f"{name}: {kind}" if name in required else _optional(name, kind)]
            lines += _quoted(described.get("description") or ", ".join(_members(described, known)))
    return f"class {one.name}({one.base}):\n" + textwrap.indent("\n".join(lines).rstrip(), "    ") + "\n"


def _optional(name: str, kind: str) -> str:
    """None: the service did not send it."""
    empty = "None" if kind.endswith("| None") else EMPTY.get(kind.partition("[")[0])
    return f"{name}: {kind} | None = None" if empty is None else f"{name}: {kind} = {empty}"


def _members(schema: Schema, known: Schema) -> list[str]:
    """Of an enumeration, nullable or not; else empty."""
    options = [option["$ref"].rsplit("/", 1)[-1] for option in schema.get("anyOf", [schema]) if "$ref" in option]
    return [str(member) for name in options for member in known[name].get("enum", ())]


def _quoted(description: str) -> list[str]:
    """As a docstring, in the words of Python, where times are no seconds."""
    for word, ours in (("null", "None"), ("Null", "None"), ("Times are seconds since 1970; costs", "Costs")):
        description = description.replace(word, ours)
    if not description:
        return []
    parts = description.split("\n\n")
    lines = ["\n".join(textwrap.wrap('"""' * (k == 0) + part, WIDTH - 4)) for k, part in enumerate(parts)]
    several = "\n" in "\n".join(lines) or len(lines[-1]) > WIDTH - 7
    return [*"\n\n".join(lines).split("\n"), '"""'] if several else [f'{lines[0]}"""']


def _type(schema: Schema, known: Schema) -> str | None:
    """None of a schema that has no class."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        return "str" if "enum" in known[name] else NAMES.get(name)
    kind = schema.get("type", "")
    if "anyOf" in schema:
        parts = [_type(option, known) for option in schema["anyOf"]]
    elif kind == "array":
        parts = [_type(item, known) for item in schema.get("prefixItems", [schema.get("items", {})])]
    elif kind == "object":
        parts = [_type(schema.get("additionalProperties", {}), known)]
    else:
        return "AwareDatetime" if schema.get("format") == "unix-time" else TYPES.get(kind)
    if None in parts or not parts:
        return None
    inner = [part for part in parts if part is not None]
    if "anyOf" in schema:
        return " | ".join(sorted(dict.fromkeys(inner), key=lambda part: part == "None"))
    opened = "dict[str, " if kind == "object" else "tuple[" if "prefixItems" in schema else "list["
    return f"{opened}{', '.join(inner)}]"


if __name__ == "__main__":
    import json

    from backend import openapi

    FILE.write_text(text(json.loads(openapi.text())), encoding="utf-8")
