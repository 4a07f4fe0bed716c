"""Writes the files that follow from the code: `python -m tools.generated`; tests check that they are as it writes them.

The API's description and the looks of the shipped methods, which the pages are built with, and the tables of the guides
between the lines `<!-- generated: NAME -->` and `<!-- end -->`. Start reading at `FILES`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict
from pathlib import Path

from backend import openapi
from worker.engine.search.base import Method
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


def table_of_methods() -> str:
    """One row for each method: what it is, what it is for, when it ends and how many points it requests at a time."""
    rows: list[Iterable[str]] = [("method", "name", "how", "for", "family", "ends", "at a time", "source"), ["---"] * 8]
    for m in shipped():
        ends = "budget" if m.whole_budget else "own rule"
        at_a_time = f"`{m.at_once}`" if m.at_once else m.parallel
        rows.append((m.title, f"`{m.name}`", m.how, m.suits, m.family, ends, at_a_time, m.source))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def methods_without_more() -> str:
    """The sentence that names the methods whose finished searches cannot be extended."""
    *names, last = [f"`{m.name}`" for m in shipped() if m.extend is None]
    return f"A finished search can be extended, except {', '.join(names)} and {last}.\n"


TABLES: Mapping[str, Callable[[], str]] = {"methods": table_of_methods, "methods without more": methods_without_more}


def _guide(path: Path) -> str:
    """The guide with its generated parts as they are now."""

    def part(match: re.Match[str]) -> str:
        return f"{match[1]}\n{TABLES[match[2]]()}\n<!-- end -->"

    return re.sub(r"(<!-- generated: ([\w ]+) -->\n).*?<!-- end -->", part, path.read_text("utf-8"), flags=re.DOTALL)


FILES: Mapping[str, Callable[[], str]] = {
    "frontend/openapi.json": openapi.text,
    "frontend/src/ui/shipped.json": _looks,
    "docs/methods.md": lambda: _guide(ROOT / "docs" / "methods.md"),
}


def main() -> None:
    for name, text in FILES.items():
        (ROOT / name).write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    main()
