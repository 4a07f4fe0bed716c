"""Writes the files that follow from the code: `python -m tools.generated`; those in git are tested to be up to date.

In git are the API's description, the types of the client's answers, the packages of the image, and the tables of the
guides between `<!-- generated: NAME -->` and `<!-- end -->`. The looks of the shipped methods and the rules of a claim
are not: `python -m tools.generated pages` writes these alone, before the pages are built. Start reading at `FILES`.
"""

from __future__ import annotations

import json
import re
import sys
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

from campaigns import Campaign
from campaigns.asked.spec import Repeats
from campaigns.asked.stages import Certify, Findings
from campaigns.rules import LIMITS, RULES
from tools import bench_tables, image_packages, openapi
from worker.engine.search.base import Method
from worker.evidence.audit.trusted import TRUSTED
from worker.running.catalogue.installed import methods

ROOT = Path(__file__).parents[1]


def shipped() -> list[Method]:
    """The methods that are part of this package, as a table lists them: by kind, then by title."""
    order = ("global", "local", "random", "multi")
    own = [m for m in methods().values() if m.search.__module__.startswith("worker.")]
    return sorted(own, key=lambda m: (order.index(m.kind), m.title.casefold()))


def _looks() -> str:
    """Name, earlier names, title and look of every shipped method; pages use them until they have the catalogue."""
    found = [
        {"name": m.name, "earlier": list(m.earlier), "title": m.title, "look": asdict(m.look)}
        for m in shipped()
        if m.look is not None
    ]
    return json.dumps(found, indent=2) + "\n"


def _rules() -> str:
    """The limits of `campaigns.rules` by name, the checks in their order, and what a campaign means that leaves a field
    out."""
    checks = [
        {"code": rule.code, "title": rule.title, "requires": rule.requires, "intended": rule.intended} for rule in RULES
    ]
    limits = {name.lower(): limit.value for name, limit in LIMITS.items()}
    fields = ((Campaign, "confidence"), (Certify, "samples"), (Repeats, "count"), (Findings, "at_most"))
    defaults = {name: model.model_fields[name].default for model, name in fields}
    return json.dumps({"limits": limits, "checks": checks, "defaults": defaults}, indent=1) + "\n"


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    return "".join(f"| {' | '.join(row)} |\n".replace("|  |", "| |") for row in (header, ["---"] * len(header), *rows))


def table_of_methods() -> str:
    """One row for each method: what it is, what it is for, when it ends and how many points it requests at a time."""
    rows = []
    for m in shipped():
        ends = ("budget or option" if m.own_rule or m.effort else "budget") if m.whole_budget else "own rule"
        at_a_time = f"`{m.at_once}`" if m.at_once else m.parallel
        aim = f"{m.suits}. {m.drawback}" if m.drawback else m.suits
        rows.append((m.title, f"`{m.name}`", m.how, aim, m.family, ends, at_a_time, m.source))
    return _table(("method", "name", "how", "for", "family", "ends", "at a time", "source"), rows)


def methods_without_more() -> str:
    """The sentence that names the methods whose finished searches cannot be extended."""
    *names, last = [f"`{m.name}`" for m in shipped() if m.extend is None]
    return f"A finished search can be extended, except {', '.join(names)} and {last}.\n"


def _table_of_checks() -> str:
    rows = [(r.title, r.requires, ", ".join(r.evidence) or "all stages", r.remedy or "") for r in RULES]
    return _table(("Check", "Requires", "Evidence", "A next run changes"), rows)


def _table_of_limits() -> str:
    rows = [(f"`{name}`: {limit.text}", f"{limit.value:g}", limit.source) for name, limit in LIMITS.items()]
    return _table(("Limit", "Value", "Source"), rows)


def _table_of_trusted() -> str:
    return _table(("Taken as given", "Why"), [(one.what, one.why) for one in TRUSTED])


def _table_of_verdicts() -> str:
    """The table of the library's verdicts, from what `tools.library_verdicts` stores."""
    known = json.loads((ROOT / "tests" / "golden" / "library_verdicts.json").read_text("utf-8"))
    rows = [
        (
            f"`{name}`",
            one["verdict"],
            f"{one['margin']:+.4g} {one['unit']}".replace("-", "\u2212"),
            ", ".join(one["fails"]),
        )
        for name, one in known.items()
    ]
    return _table(("Campaign", "Verdict", "Worst margin", "Checks that fail"), rows)


TABLES: Mapping[str, Callable[[], str]] = {
    "verdicts": _table_of_verdicts,
    "trusted": _table_of_trusted,
    "methods": table_of_methods,
    "methods without more": methods_without_more,
    "small budgets": lambda: _table(*bench_tables.small_budgets()),
    "rare": lambda: _table(*bench_tables.rare()),
    "subset": bench_tables.subset,
    "checks": _table_of_checks,
    "limits": _table_of_limits,
}


def _guide(name: str) -> str:
    """The guide with its generated parts as they are now."""

    def part(match: re.Match[str]) -> str:
        return f"{match[1]}\n{TABLES[match[2]]()}\n<!-- end -->"

    text = (ROOT / name).read_text("utf-8")
    return re.sub(r"(<!-- generated: ([\w ]+) -->\n).*?<!-- end -->", part, text, flags=re.DOTALL)


Schema = Mapping[str, Any]
WIDTH = 120
HEAD = '''"""What the service answers, as types. Times are `datetime` in UTC; costs and margins are in the run's unit.

Written by `python -m tools.generated` from the OpenAPI document. A field that is not described here is ignored, and is
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
    Class("PredictedBound", "PredictedBound", "statement warning"),
    Class("Foreseen", "Foreseen", "code statement"),
    Class("Checked", "Checked", "ok digest problems"),
    Class("ExportFile", "ExportFile", "name title media_type href unavailable"),
    Class("StageProgress", "StageProgress", "position kind method state planned evaluations failed best seconds"),
    Class("RunBaseline", "Baseline", "asked run sentence"),
    Class("DescribedCheck", "Check", "name title standing text"),
    Class("Sureness", "Sureness", "chance lower landscapes text"),
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
    Class("Likelihood", "Likelihood", "text"),
    Class("LikelyViolation", "LikelyViolation", "position index cost margin parameters likelihood"),
    Class("MostLikely", "MostLikely", "violations text"),
    Class("FindingDetail", "Finding", "label cost margin parameters nominal low high methods values at_bounds"),
    Class("Signoff", "Signoff", "name role"),
    Class("Signoffs", "Signoffs", "items"),
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


def answers(document: Schema) -> str:
    """The types of the client's answers.

    A field has the type and the description of the document. A field of a schema that is not in `CLASSES` is left to
    `Answer.document`. A name there that the document does not have is an error.
    """
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
    """A field with its default: None if the service did not send it."""
    empty = "None" if kind.endswith("| None") else EMPTY.get(kind.partition("[")[0])
    return f"{name}: {kind} | None = None" if empty is None else f"{name}: {kind} = {empty}"


def _members(schema: Schema, known: Schema) -> list[str]:
    """The members of an enumeration, nullable or not; empty for any other schema."""
    options = [option["$ref"].rsplit("/", 1)[-1] for option in schema.get("anyOf", [schema]) if "$ref" in option]
    return [str(member) for name in options for member in known[name].get("enum", ())]


def _quoted(description: str) -> list[str]:
    """The description as the lines of a docstring, in the words of Python, where times are no seconds."""
    for word, ours in (("null", "None"), ("Null", "None"), ("Times are seconds since 1970; costs", "Costs")):
        description = description.replace(word, ours)
    if not description:
        return []
    parts = description.split("\n\n")
    lines = ["\n".join(textwrap.wrap('"""' * (k == 0) + part, WIDTH - 4)) for k, part in enumerate(parts)]
    several = "\n" in "\n".join(lines) or len(lines[-1]) > WIDTH - 7
    return [*"\n\n".join(lines).split("\n"), '"""'] if several else [f'{lines[0]}"""']


def _type(schema: Schema, known: Schema) -> str | None:
    """The annotation of a schema; None if it has no class."""
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


FILES: Mapping[str, Callable[[], str]] = {
    "frontend/openapi.json": openapi.text,
    "clearance/client/answers.py": lambda: answers(json.loads(openapi.text())),
    "tools/image-packages.txt": image_packages.text,
    "docs/methods.md": lambda: _guide("docs/methods.md"),
    "docs/evidence.md": lambda: _guide("docs/evidence.md"),
}


PAGES: Mapping[str, Callable[[], str]] = {
    "frontend/src/generated/methods.json": _looks,
    "frontend/src/generated/rules.json": _rules,
}


def main() -> None:
    for name, text in {**({} if sys.argv[1:] == ["pages"] else FILES), **PAGES}.items():
        (ROOT / name).parent.mkdir(parents=True, exist_ok=True)
        (ROOT / name).write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    main()
