"""YAML or JSON in, a `Campaign` out, or every problem found: file, field, what was given, what is allowed.

YAML is read by the safe loader without aliases and without repeated keys. Start reading at `load_text`.
"""

from __future__ import annotations

import json
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from campaigns.spec import Campaign

LARGEST_FILE = 1_000_000
"""[bytes]"""

LIBRARY = Path(__file__).parent / "library"


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a campaign: where, what was given, and what is allowed or to do."""

    field: str
    given: str
    message: str

    def __str__(self) -> str:
        given = f" (given: {self.given})" if self.given else ""
        return f"{self.field or 'campaign'}: {self.message}{given}"


class CampaignError(ValueError):
    """The campaign cannot be used; `problems` lists why, `source` says which file or request it came from."""

    def __init__(self, source: str, problems: Sequence[Problem]) -> None:
        self.source = source
        self.problems = list(problems)
        super().__init__(f"{source}: " + "; ".join(map(str, problems)))


def load_file(path: Path) -> Campaign:
    """Read a campaign from a file; raises `CampaignError` for anything that is wrong, a missing file included."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise CampaignError(str(path), [_too_large(path.stat().st_size)])
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise CampaignError(str(path), [Problem("", str(path), f"the file cannot be read: {error.strerror}")]) from None
    except UnicodeDecodeError:
        raise CampaignError(str(path), [Problem("", "", "the file is not UTF-8 text")]) from None
    return load_text(text, str(path))


def load_text(text: str, source: str = "campaign") -> Campaign:
    """Read a campaign from YAML or JSON text (JSON is YAML)."""
    if len(text) > LARGEST_FILE:
        raise CampaignError(source, [_too_large(len(text))])
    try:
        document = yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise CampaignError(
            source, [Problem(where, "", f"not readable as YAML: {error.problem or error.context}")]
        ) from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        message = "nested too deeply" if isinstance(error, RecursionError) else str(error).splitlines()[0]
        raise CampaignError(source, [Problem("", "", f"not readable as YAML: {message}")]) from None
    return load_document(document, source)


def load_document(document: Any, source: str = "campaign") -> Campaign:
    """Read a campaign from plain JSON values."""
    if not isinstance(document, Mapping):
        raise CampaignError(source, [Problem("", _shown(document), "a campaign is a mapping with name, scenario, ...")])
    try:
        return Campaign.model_validate(document)
    except ValidationError as error:
        raise CampaignError(source, [_problem(e) for e in error.errors(include_url=False)]) from None


def library() -> dict[str, Path]:
    """The shipped campaigns by identifier (the file's name without its ending)."""
    return {path.stem: path for path in sorted(LIBRARY.glob("*.yaml"))}


class _Loader(yaml.SafeLoader):
    """The safe loader without aliases (a small file must stay small) and without repeated keys."""

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(
                problem="aliases (*name) are not allowed, write the value out", problem_mark=mark
            )
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str):
                raise yaml.MarkedYAMLError(problem=f"keys are text, given {key!r}", problem_mark=key_node.start_mark)
            if key in seen:
                raise yaml.MarkedYAMLError(problem=f"the key {key!r} is given twice", problem_mark=key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep)


def _problem(error: Any) -> Problem:
    kind, message = error["type"], error["msg"].removeprefix("Value error, ")
    location = [str(part) for part in error["loc"] if part != "[key]"]
    given = "" if kind in ("missing", "model_type") else _shown(error.get("input"))
    if kind == "extra_forbidden":
        message = "this key is not known here; remove it or correct its spelling"
    elif kind == "missing":
        message = "this key is required"
    elif error["loc"] and error["loc"][-1] == "[key]":
        message = "not the path of a parameter, such as vehicle.m or obstacles.0.position.x"
    return Problem(".".join(location), given, message)


def _shown(value: Any) -> str:
    try:
        text = json.dumps(value, default=str)
    except (TypeError, ValueError, RecursionError):
        text = str(type(value).__name__)
    return text if len(text) <= 120 else text[:117] + "..."


def _too_large(size: int) -> Problem:
    return Problem("", f"{size} bytes", f"a campaign is at most {LARGEST_FILE} bytes")
