"""What a format of export files is: its name, when a run offers it, and how its content is made.

A module of `backend.exports.formats` that declares `export` adds one to the list of a run's files, the one route that
serves them, the export menu and the API's description.
"""

from __future__ import annotations

import importlib
import pkgutil
import re
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Literal, NamedTuple

import sqlalchemy as sa
from fastapi import Request
from fastapi.responses import Response

from backend.db.engine import read
from backend.http.errors import RefusedError

LABEL = "{label}"
"""Stands for the finding or the flight in the name of a file."""


class Stored(NamedTuple):
    """What a run has: whether it evaluates a simulator, its flights, those that can be drawn in 3D, its findings.

    Names are in order, the worst case first.
    """

    simulated: bool
    flights: tuple[str, ...]
    drawn: tuple[str, ...]
    findings: tuple[str, ...]


class Words(NamedTuple):
    """How a file is called in a menu, and what it contains."""

    title: str
    text: str


def words(title: str, text: str, simulated: tuple[str, str] | None = None) -> Callable[[Stored], Words]:
    """A function that returns title and text of a format; `simulated` replaces them for a run of a simulator."""
    return lambda stored: Words(*simulated) if simulated and stored.simulated else Words(title, text)


@dataclass(frozen=True)
class Format:
    """One kind of file.

    file: its name, which may contain `{label}`; order: its position in the menu.
    offered: the label of the file that the list of a run has; None if it has none. The route serves every label.
    needs: what a run must have stored; missing: why this installation cannot write it.
    made: its content; streamed: the same in pieces, sent while they are made, where it may be large; answer: for a file
    that more than the database decides, of a request, the run, the label and whether the theme is dark. One of them.
    address: below the run's, of a file that another route serves.
    """

    file: str
    order: float
    media_type: str
    words: Callable[[Stored], Words]
    made: Callable[[sa.Engine, int], bytes] | None = None
    streamed: Callable[[sa.Engine, int], Iterator[bytes]] | None = None
    answer: Callable[[Request, str, str, bool], Awaitable[Response]] | None = None
    address: str = ""
    offered: Callable[[Stored], str | None] = lambda _: ""
    needs: Literal["", "flights", "findings"] = ""
    missing: Callable[[], str | None] = lambda: None

    @property
    def binary(self) -> bool:
        return not (self.media_type.startswith("text/") or self.media_type in ("application/json", "image/svg+xml"))

    def unavailable(self, stored: Stored) -> str | None:
        """Why the file cannot be had now; None if it can."""
        if self.needs == "flights" and not stored.flights:
            return f"this run has no stored {'trace' if stored.simulated else 'flight'}"
        if self.needs == "findings" and not (stored.flights or stored.findings):
            return "this run has no " + (
                "finding and no nominal case" if stored.simulated else "stored flight and no finding"
            )
        return self.missing()


def missing(package: str, extra: str) -> str | None:
    """Why a file that this package writes cannot be written here; None if it can."""
    return f"needs the package {package}: pip install 'clearance[{extra}]'" if find_spec(package) is None else None


def require(missing: Callable[[], str | None]) -> None:
    """Raise 503 if a package is missing."""
    if reason := missing():
        raise RefusedError("no-package", f"the service {reason}")


@cache
def known() -> tuple[Format, ...]:
    names = [info.name for info in pkgutil.iter_modules([str(Path(__file__).with_name("formats"))])]
    modules = [importlib.import_module(f"backend.exports.formats.{name}") for name in names]
    return tuple(sorted((module.export for module in modules), key=lambda one: one.order))


def named(file: str) -> tuple[Format, str] | None:
    """The format of a file that the route serves, and its label; None if there is none."""
    for one in known():
        pattern = re.escape(one.file).replace(re.escape(LABEL), r"(\w{1,20})")
        found = None if one.address else re.fullmatch(pattern, file, re.ASCII)
        if found:
            return one, "".join(found.groups())
    return None


def whole(engine: sa.Engine, run_id: int, made: Callable[[sa.Connection, int], bytes | Iterator[bytes]]) -> bytes:
    with read(engine) as reader:
        content = made(reader, run_id)
        return content if isinstance(content, bytes) else b"".join(content)
