"""`make scoreboard`: measures all methods and peers on the judging half; writes build/scoreboard.json and .md.

`python -m tests.bench.scoreboard [--only PART[,PART]] [--methods A,B] [--seeds N] [--budgets 100,200] [--half setting]
[--processes N]` measures less, or the other half. With --functions, --dimension or --instance it prints only the chosen
cells, line by line, and leaves the files as they are; --again measures them although they are stored. A finished cell
is stored, so that an interrupted board continues with the same command. --stored measures nothing; --keep puts the
cells with the code (`kept/`) and the page into docs/scoreboard.md.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

from tests.bench.scoreboard import bbob, niching, page, reaching, sureness, verdicts
from tests.bench.scoreboard.bars import bars
from tests.bench.scoreboard.cells import KEPT, Cell, Row, keep, kept, lines, measured, stored, versions
from tests.bench.scoreboard.contestants import names, own_names
from tests.bench.scoreboard.parts import Part, Request
from tests.bench.scoreboard.peers import INSTALL, PEERS
from tests.given.landscapes import Half

BUILD, DOCS = Path("build"), Path("docs")
SEEDS = 30
IN_ORDER = (
    bbob.PART, reaching.LANDSCAPES, niching.PART, reaching.LOOPS, reaching.FALSIFICATION, verdicts.PART, sureness.PART,
)  # fmt: skip
PARTS: dict[str, Part] = {part.name: part for part in IN_ORDER}


def main(
    arguments: Sequence[str] | None = None, build: Path = BUILD, kept_in: Path = KEPT, docs: Path = DOCS
) -> dict[str, Any]:
    """Measure, write, print; returns what it wrote."""
    given = parser()
    asked = given.parse_args(arguments)
    _refuse(given, asked)
    began = time.perf_counter()
    installed = [name for name in asked.methods if name not in PEERS or PEERS[name].version()]
    request = Request(asked.half, tuple(installed), asked.seeds, tuple(asked.budgets) if asked.budgets else None)
    found: dict[str, Any] = {
        "half": asked.half,
        "commit": commit(),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}",
        "processes": asked.processes,
        "seeds": asked.seeds,
        "peers": {name: PEERS[name].version() for name in asked.methods if name in PEERS},
        "parts": {},
    }
    chosen = bool(asked.functions or asked.dimension or asked.instance)
    for name in asked.only:
        part = PARTS[name]
        cells = [cell for cell in part.cells(request) if _is_chosen(cell, asked)]
        valid = versions({*installed}, part.reach)
        file = build / "scoreboard" / ("again.jsonl" if asked.again else "cells.jsonl")
        known = {} if asked.again else stored(lines(kept(name, kept_in)), valid)
        if asked.again:
            file.unlink(missing_ok=True)
        rows = measured(
            cells, None if asked.stored else part.measure, file, asked.processes, valid, known, part.function
        )
        if chosen:
            print("\n".join(json.dumps({**row.cell._asdict(), **row.figures, "error": row.error}) for row in rows))
        if asked.keep:
            keep(rows, kept(name, kept_in), valid)
        found["parts"][name] = _summary(part, rows)
    _finish(found, list(found["parts"].values()), time.perf_counter() - began)
    if not chosen:
        build.mkdir(exist_ok=True)
        (build / "scoreboard.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
        (build / "scoreboard.md").write_text(page.markdown(found), encoding="utf-8")
        print(page.markdown(found))
    if asked.keep:
        (docs / "scoreboard.md").write_text(page.markdown(found), encoding="utf-8")
    return found


def _summary(part: Part, rows: Sequence[Row]) -> dict[str, Any]:
    errors: dict[str, list[Any]] = {}
    for row in rows:
        if row.error:
            errors.setdefault(row.cell.method, [0, row.error])[0] += 1
    return {
        "title": part.title,
        "text": part.text,
        "shown": part.shown,
        "table": part.table(rows),
        "cells": len(rows),
        "missing": sum(not row.figures and not row.error for row in rows),
        "seconds": sum(row.seconds for row in rows),
        "errors": errors,
        "example": rows[0].cell.command if rows else "",
    }


def _finish(found: dict[str, Any], parts: Sequence[dict[str, Any]], seconds: float) -> None:
    judged = bars({name: part["table"] for name, part in found["parts"].items()}, own_names())
    found["bars"] = [bar._asdict() | {"verdict": bar.verdict} for bar in judged]
    found["seconds"] = seconds
    found["example"] = next((part["example"] for part in parts if part["example"]), "")


def _is_chosen(cell: Cell, asked: argparse.Namespace) -> bool:
    return (
        (not asked.functions or cell.problem in asked.functions)
        and (not asked.dimension or cell.dimension in asked.dimension)
        and (not asked.instance or cell.number in asked.instance)
    )


def parser() -> argparse.ArgumentParser:
    """The arguments."""

    def words(text: str) -> list[str]:
        return [word.strip() for word in text.split(",")]

    def numbers(text: str) -> list[int]:
        return [int(word) for word in words(text)]

    given = argparse.ArgumentParser(
        prog="python -m tests.bench.scoreboard", description="Score board of search methods"
    )
    given.add_argument("--only", type=words, default=list(PARTS), help=f"parts: {', '.join(PARTS)}")
    given.add_argument("--methods", type=words, default=names(), help="all by default")
    given.add_argument("--seeds", type=int, default=SEEDS)
    given.add_argument("--budgets", type=numbers, help="evaluations per parameter; by default those of each part")
    given.add_argument("--half", choices=get_args(Half), default="judging")
    given.add_argument("--processes", type=int, default=os.cpu_count())
    given.add_argument("--functions", type=words, default=[], help="problems of the part, by name")
    given.add_argument("--dimension", type=numbers, default=[])
    given.add_argument("--instance", type=numbers, default=[], help="instances, numbers or seeds of the part")
    given.add_argument("--again", action="store_true", help="measure although stored")
    given.add_argument("--stored", action="store_true", help="measure nothing: what is missing has no figure")
    given.add_argument("--keep", action="store_true", help="keep the cells with the code, and write docs/scoreboard.md")
    return given


def _refuse(given: argparse.ArgumentParser, asked: argparse.Namespace) -> None:
    """End with a sentence where the arguments are not possible."""
    for what, stated, known in (("part", asked.only, PARTS), ("method", asked.methods, names())):
        if wrong := [name for name in stated if name not in known]:
            given.error(f"there is no {what} {', '.join(wrong)}; give some of {', '.join(known)}")
    if min(asked.seeds, asked.processes, *(asked.budgets or [1])) < 1:
        given.error("seeds, processes and budgets must be at least 1")
    if asked.keep and (asked.half != "judging" or asked.functions or asked.dimension or asked.instance):
        given.error(
            "only the judging half as a whole is kept; leave --half, --functions, --dimension and --instance out"
        )
    if "bbob" in asked.only and not bbob.available():
        given.error(f"BBOB needs the package ioh: {INSTALL}; or name other parts with --only")


def commit() -> str:
    """The commit of the working tree, and whether files differ from it."""
    try:
        texts = [
            subprocess.run(["git", *words], capture_output=True, text=True, check=True).stdout.strip()
            for words in (("rev-parse", "--short=12", "HEAD"), ("status", "--porcelain"))
        ]
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return texts[0] + (" with changes" if texts[1] else "")


if __name__ == "__main__":
    main()
