"""Reads YAML or JSON into a `Campaign`, or reports every problem: file, field, what was given, what is allowed."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from campaigns.asked.expected import expected
from campaigns.asked.problem import MOST, CampaignError, Problem, shown
from campaigns.asked.reading import UnreadableError, misshapen, parse
from campaigns.asked.spec import Campaign

__all__ = ["CampaignError", "Problem", "library", "load_document", "load_file", "load_text", "read_text"]

LARGEST_FILE = 1_000_000
"""[bytes]"""

CODE = frozenset({
    "class", "code", "command", "entry_point", "exec", "executable", "expression", "file", "fmu", "function", "import",
    "lambda", "module", "package", "program", "python", "run", "script", "shell", "source", "url",
})  # fmt: skip
"""Keys with which a campaign might try to give code."""
SETTINGS = frozenset({
    "args", "arguments", "cwd", "environment", "folder", "ids", "memory", "path", "protocol", "recycle", "results",
    "slots", "start", "step", "timeout", "trace",
})  # fmt: skip
"""Keys of a simulator's descriptor, which a campaign cannot give either."""

INSTALLED = (
    "it names what this installation has, as in `simulator: {name: drop}`. The operator installs a simulator: a folder "
    "with simulator.yaml, or a Python file, in a folder that CLEARANCE_SIMULATORS lists, or a Python package (guide: "
    "Your own simulator)"
)

LIBRARY = Path(__file__).parents[1] / "library"


def load_file(path: Path) -> Campaign:
    """Read a campaign from a file; raises `CampaignError` for all problems, including a missing file."""
    return load_text(read_text(path), str(path))


def read_text(path: Path) -> str:
    """The text of a campaign's file; raises `CampaignError` if it cannot be read."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise CampaignError(str(path), [Problem("", str(path), f"the file cannot be read: {error.strerror}")]) from None
    except ValueError as error:  # a name that no file can have
        raise CampaignError(str(path), [Problem("", str(path), f"the file cannot be read: {error}")]) from None
    if len(content) > LARGEST_FILE:
        raise CampaignError(str(path), [_too_large()])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CampaignError(str(path), [Problem("", "", "the file is not UTF-8 text")]) from None


def load_text(text: str, source: str = "campaign") -> Campaign:
    """Read a campaign from YAML or JSON text."""
    if len(text) > LARGEST_FILE:
        raise CampaignError(source, [_too_large()])
    try:
        document = parse(text)
    except UnreadableError as error:
        raise CampaignError(source, [error.problem]) from None
    return load_document(document, source)


def load_document(document: Any, source: str = "campaign") -> Campaign:
    """Read a campaign from plain JSON values."""
    if not isinstance(document, Mapping):
        raise CampaignError(source, [Problem("", shown(document), "a campaign is a mapping with name, scenario, ...")])
    if problems := list(itertools.islice(misshapen(document), MOST + 1)):
        more = [Problem("", "", "and more problems; correct these first")] if len(problems) > MOST else []
        raise CampaignError(source, [*problems[: MOST - len(more)], *more])
    try:
        return Campaign.model_validate(document)
    except ValidationError as error:
        found = error.errors(include_url=False)
        problems = [_problem(e) for e in found[:MOST]]
        if any(e["loc"] for e in found) and not {"scenario", "simulator"} & document.keys():
            # Reported with the others, although the model checks it only once everything else is valid.
            problems.insert(0, Problem("scenario", "", "this key is required, or simulator"))
        raise CampaignError(source, problems[:MOST], len(found)) from None


def library() -> dict[str, Path]:
    """The shipped campaigns by identifier (the file name without its extension)."""
    return {path.stem: path for path in sorted(LIBRARY.glob("*.yaml"))}


def _problem(error: Any) -> Problem:
    kind, message = error["type"], expected(error, Campaign)
    at = list(error["loc"])
    if "distribution" in at[:-1]:  # what follows is the kind, which is no key of the document
        del at[at.index("distribution") + 1]
    value = "" if kind in ("missing", "model_type") or not at else shown(error.get("input"))
    if kind == "extra_forbidden":
        message = _unknown(at)
    elif at == ["simulator"] and kind == "model_type":
        message = f"a mapping with the key name is expected: a campaign {INSTALLED[3:]}"
    elif at == ["simulator", "name"] and kind in ("string_pattern_mismatch", "string_type"):
        message = f"not the name of a simulator, which has small letters, digits and _; a campaign {INSTALLED[3:]}"
    elif at and at[-1] == "[key]" and kind == "string_pattern_mismatch":
        message = "not the path of a parameter, such as vehicle.m or obstacles.0.position.x"
    elif at and at[-1] == "[key]" and kind == "literal_error":
        message = f"unknown key; {message}"
    return Problem(".".join(str(part) for part in at if part != "[key]"), value, message)


def _unknown(at: Sequence[Any]) -> str:
    """What to do about an unknown key; one that would give code has a sentence of its own."""
    name = str(at[-1])
    if name in CODE or (at[0] == "simulator" and name in SETTINGS):
        return f"a campaign contains no code and no settings of a program; {INSTALLED}"
    return "unknown key; remove it or correct its spelling"


def _too_large() -> Problem:
    return Problem("", f"more than {LARGEST_FILE} bytes", f"a campaign is at most {LARGEST_FILE} bytes")
