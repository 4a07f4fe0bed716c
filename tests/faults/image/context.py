"""What an engine sends to a build: the files of the clone that .dockerignore leaves."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path


def copied(source: Path, into: Path) -> None:
    """Copy the files of a build there."""
    for file in _files(source, _rules(source / ".dockerignore")):
        (into / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source / file, into / file)


def _rules(file: Path) -> list[tuple[bool, re.Pattern[str]]]:
    """Whether each line takes files in, and what it names; the last one that fits counts."""
    lines = [line.strip() for line in file.read_text(encoding="utf-8").splitlines()]
    return [
        (line.startswith("!"), re.compile(_expression(line.removeprefix("!").strip("/"))))
        for line in lines
        if line and not line.startswith("#")
    ]


def _expression(pattern: str) -> str:
    parts = {"**/": "(?:.*/)?", "**": ".*", "*": "[^/]*", "?": "[^/]"}
    tokens = re.findall(r"\*\*/|\*\*|\*|\?|[^*?]+", pattern)
    return "".join(parts.get(token, re.escape(token)) for token in tokens)


def _files(source: Path, rules: list[tuple[bool, re.Pattern[str]]]) -> Iterator[Path]:
    for folder, inner, names in os.walk(source):
        here = Path(folder).relative_to(source)
        if str(here) != ".":
            inner[:] = [name for name in inner if _taken(here / name, rules)]
        yield from (here / name for name in names if _taken(here / name, rules))


def _taken(path: Path, rules: list[tuple[bool, re.Pattern[str]]]) -> bool:
    """A rule for a folder is one for all that is in it."""
    names = [path.as_posix(), *(parent.as_posix() for parent in path.parents if parent != Path())]
    taken = True
    for takes, expression in rules:
        if any(expression.fullmatch(name) for name in names):
            taken = takes
    return taken
