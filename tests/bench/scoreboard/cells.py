"""Cells of the score board: one search on one problem with one seed; measured in processes, stored line by line.

A finished cell is a line of `build/scoreboard/cells.jsonl`, so that an interrupted board continues; those that are kept
with the code are lines of `kept/PART.jsonl.xz`. A line counts only for the code that measured it: the board, the method
or the version of the peer, and what it searched: nothing of ours, closed loops, or all that makes a run.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import lzma
import os
import shlex
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Literal, NamedTuple

from clearance.testing.searching import Function
from tests.bench.scoreboard.peers import PEERS
from tests.bench.scoreboard.together import together
from worker.running.catalogue.installed import methods
from worker.running.runs.identity import code_parts

ROOT = Path(__file__).parents[3]
HERE = "tests/bench/scoreboard"
TESTING = ("clearance/testing/problems.py", "clearance/testing/searching.py")
BOARD = (HERE, *TESTING, "tests/given/landscapes.py", "tests/given/falsification", "tests/given/niching")
KEPT = Path(__file__).with_name("kept")
LIBRARY = ("campaigns/library", "tests/golden/library_verdicts.json")
WHOLE_RUNS = tuple(f"{HERE}/{name}" for name in ("niching.py", "sureness.py", "verdicts.py"))
RUNS = ("worker/evidence/verdicts", "campaigns/rules.py", "clearance/function", *WHOLE_RUNS)
"""Besides the code that a run uses, what decides the figures of whole runs."""
WORDS = tuple(f"worker/evidence/verdicts/{name}" for name in ("regression.py", "sentence.py", "validation.py"))
"""Of these: sentences, and the comparison with a baseline, which no cell has. They change no figure."""
PRESENTATION = tuple(
    f"{HERE}/{name}"
    for name in (
        "__main__.py",
        "bars.py",
        "cells.py",
        "fitted.py",
        "page.py",
        "parts.py",
        "published.py",
        "together.py",
    )
)
"""Modules of the board that change no figure of a cell; those before change only figures of whole runs."""


class Cell(NamedTuple):
    """One method on one problem: the part of the board, the problem's name, its instance or seed, and the budgets in
    evaluations per parameter (none where the problem has a budget of its own)."""

    part: str
    half: str
    method: str
    problem: str
    dimension: int
    number: int
    budgets: tuple[int, ...] = ()

    @property
    def command(self) -> str:
        """What measures this cell again."""
        budgets = f" --budgets {','.join(map(str, self.budgets))}" if self.budgets else ""
        return (
            f"python -m tests.bench.scoreboard --only {self.part} --half {self.half} --methods {self.method} "
            f"--functions {shlex.quote(self.problem)} --dimension {self.dimension} --instance {self.number}{budgets}"
        )


class Row(NamedTuple):
    """A measured cell: its figures, or the error that prevented them, and how long it took [s]."""

    cell: Cell
    figures: dict[str, Any]
    error: str
    seconds: float


Reach = Literal["method", "loops", "runs"]
"""What of our code decides a cell's figures: the method alone, closed loops of the library besides, or all."""

Measure = Callable[..., dict[str, Any]]
"""The figures of one cell, of kinds that JSON has; `error` is what a peer raised. Its second argument, where its part
states one, is the function to search."""
Searched = Callable[[Cell], Function]
"""The function that the searches of a cell evaluate, the same for all numbers."""


def code(names: Iterable[str]) -> str:
    """A digest of these source files and of those of these folders."""
    digest = hashlib.sha256()
    for name in names:
        path = ROOT / name
        files = _of_folder(path) if path.is_dir() else [path] * path.exists()
        for file in files:
            digest.update(file.relative_to(ROOT).as_posix().encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def _of_folder(path: Path) -> list[Path]:
    without = {ROOT / name for name in (*WHOLE_RUNS, *PRESENTATION, *WORDS)}
    files = (file for file in path.rglob("*") if file.suffix in (".py", ".yaml", ".npz", ".json"))
    return sorted(file for file in files if file not in without)


def versions(names: Iterable[str], reach: Reach) -> dict[str, str]:
    """What each method's cells are valid for."""
    board, parts = code(BOARD), code_parts()
    searched = {
        "method": [],
        "loops": [code(LIBRARY), _digest(parts.systems | parts.components)],
        "runs": [code(RUNS), _digest(parts.systems | parts.stages | parts.components)],
    }
    by = {name: PEERS[name].version() if name in PEERS else parts.methods[name] for name in names}
    return {name: " ".join([board, version, *searched[reach]]) for name, version in by.items()}


def _digest(parts: Mapping[str, str]) -> str:
    return hashlib.sha256(repr(sorted(parts.items())).encode()).hexdigest()[:16]


def stored(lines: Iterable[str], versions_of: Mapping[str, str] | None = None) -> dict[Cell, Row]:
    """The cells of these lines, valid for these versions if some are given. A line that an interruption cut off is left
    out, and a cell that failed altogether."""
    found: dict[Cell, Row] = {}
    for line in lines:
        try:
            entry = json.loads(line)
        except json.JSONDecodeError:
            continue
        cell = Cell(**{**entry["cell"], "budgets": tuple(entry["cell"]["budgets"])})
        valid = versions_of is None or versions_of.get(cell.method) == entry["code"]
        if valid and entry["figures"]:
            found[cell] = Row(cell, entry["figures"], entry["error"], entry["seconds"])
    return found


def lines(file: Path) -> list[str]:
    """The lines of a file of cells, packed or not; none if there is no file."""
    if not file.exists():
        return []
    packed = file.suffix == ".xz"
    return (lzma.decompress(file.read_bytes()) if packed else file.read_bytes()).decode().splitlines()


def kept(part: str, folder: Path) -> Path:
    """The file of the cells of a part that are kept with the code."""
    return folder / f"{part}.jsonl.xz"


def keep(rows: Iterable[Row], file: Path, versions_of: Mapping[str, str]) -> None:
    """Write these cells to the file; those of other code that it had are dropped. Without any there is no file."""
    text = "".join(
        f"{_line(row._replace(seconds=round(row.seconds, 2)), versions_of)}\n" for row in rows if row.figures
    )
    file.parent.mkdir(exist_ok=True)
    file.unlink(missing_ok=True)
    if text:
        file.write_bytes(lzma.compress(text.encode(), preset=9))


def measured(
    cells: Sequence[Cell], measure: Measure | None, file: Path, processes: int, versions_of: dict[str, str],
    known: Mapping[Cell, Row] | None = None, function: Searched | None = None,
) -> list[Row]:  # fmt: skip
    """Every cell in the given order, known, from the file, or measured now and added to it; without a measure a missing
    one has no figures. Cells of one function are searched side by side."""
    found = {**(known or {}), **stored(lines(file), versions_of)}
    missing = [cell for cell in cells if cell not in found]
    if measure is None:
        found |= {cell: Row(cell, {}, "", 0.0) for cell in missing}
    elif missing:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("a", encoding="utf-8") as out:
            for row in _run(missing, measure, function, processes):
                found[row.cell] = row
                out.write(f"{_line(row, versions_of)}\n")
                out.flush()
    return [found[cell] for cell in cells]


def _line(row: Row, versions_of: Mapping[str, str]) -> str:
    entry = row._asdict() | {"cell": row.cell._asdict(), "code": versions_of[row.cell.method]}
    return json.dumps(entry, allow_nan=False)


def _run(cells: Sequence[Cell], measure: Measure, function: Searched | None, processes: int) -> Iterable[Row]:
    one = _One(measure, function)
    groups = _groups(cells) if function else [[cell] for cell in cells]
    if processes == 1:
        yield from itertools.chain.from_iterable(map(one, groups))
        return
    os.environ["OMP_NUM_THREADS"] = "1"
    done = 0
    # Its processes may have processes of their own, those of a `Pool` may not.
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        for ended in as_completed([pool.submit(one, group) for group in groups]):
            yield from ended.result()
            done += 1
            if sys.stderr.isatty():
                print(f"\r{done} of {len(groups)}", end="", file=sys.stderr)


def _groups(cells: Iterable[Cell]) -> list[list[Cell]]:
    """The cells of one method on one problem, which differ in their numbers."""
    groups: dict[Cell, list[Cell]] = {}
    for cell in cells:
        groups.setdefault(cell._replace(number=0), []).append(cell)
    return [*groups.values()]


class _One:
    """Measures one cell, or several side by side; an exception is its cell's error, so that the board goes on."""

    def __init__(self, measure: Measure, function: Searched | None) -> None:
        self.measure, self.function = measure, function

    def __call__(self, cells: Sequence[Cell]) -> list[Row]:
        methods()
        began = time.perf_counter()
        found = self._measured(cells)
        seconds = (time.perf_counter() - began) / len(cells)
        return [_row(cell, one, seconds) for cell, one in zip(cells, found, strict=True)]

    def _measured(self, cells: Sequence[Cell]) -> Sequence[dict[str, Any] | Exception]:
        try:
            if self.function:
                return together([partial(self.measure, cell) for cell in cells], self.function(cells[0]))
            return [self.measure(cell) for cell in cells]
        except Exception as raised:
            return [raised] * len(cells)


def _row(cell: Cell, found: dict[str, Any] | Exception, seconds: float) -> Row:
    if isinstance(found, Exception):
        return Row(cell, {}, f"{type(found).__name__}: {found}", seconds)
    return Row(
        cell, {name: figure for name, figure in found.items() if name != "error"}, str(found.get("error", "")), seconds
    )
