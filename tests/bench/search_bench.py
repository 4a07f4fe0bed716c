"""`make search-bench`: every method on every test function; prints tables, writes build/search.json and search.md.

`python -m tests.bench.search_bench [METHOD ...]` takes only these, `--seeds N` other than 30 seeds, `--small-seeds N`
other than 15 for the table of small budgets, `--processes N` as many processes; tables and files state what was asked.
Costly methods, which take milliseconds of their own per evaluation, are only in the table of small budgets.
Success: a value within 1 % of the minimum, within 0.01 where that is 0, in 5,000 evaluations. Expected running time
(Auger and Hansen, CEC 2005): all evaluations of all seeds, each counted to its success or end, over the successes.
Points that a method may ask for twice count once, as in a run.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from campaigns.results.base import EXCLUDED
from tests.bench import small_budgets
from tests.bench.scoreboard.searches import own_trace
from tests.given.functions_with_minima import FUNCTIONS, on_unit_cube
from worker.running.catalogue.installed import methods

BUILD = Path("build")
BUDGET, SEEDS, WITHIN = 5_000, 30, 0.01
PORTFOLIO, TIMES, MORE = "portfolio", 3, 500


class Task(NamedTuple):
    """One method on one function, shifted and seeded by the same number."""

    method: str
    function: str
    seed: int


def main() -> None:
    """Run, print, write."""
    given = argparse.ArgumentParser(description="Search methods on test functions")
    small_budgets.add_arguments(given, SEEDS)
    given.add_argument("--small-seeds", type=int, default=small_budgets.SEEDS)
    asked = small_budgets.checked(given)
    if asked.small_seeds < 1:
        given.error(f"{asked.small_seeds} seeds for small budgets: give at least 1")
    BUILD.mkdir(exist_ok=True)
    began = time.perf_counter()
    taking = [m for m in methods().values() if m.kind != "multi" and (not asked.method or m.name in asked.method)]
    tasks = [Task(m.name, f, s) for m in taking if not m.costly for f in FUNCTIONS for s in range(asked.seeds)]
    os.environ["OMP_NUM_THREADS"] = "1"
    with get_context("spawn").Pool(asked.processes) as pool:
        spent = pool.map(evaluations, tasks, chunksize=10)
        small = small_budgets.measured(pool, [m.name for m in taking], asked.small_seeds)
    found: dict[str, Any] = {
        "budget": BUDGET,
        "seeds": asked.seeds,
        "within": WITHIN,
        "functions": {f.name: {"dimension": f.dimension, "minimum": f.minimum} for f in FUNCTIONS.values()},
        "methods": summary(tasks, spent),
    }
    found["portfolio"] = compared(found["methods"]) if PORTFOLIO in found["methods"] else {}
    found["small_budgets"] = small
    found["seconds"] = time.perf_counter() - began
    (BUILD / "search.json").write_text(json.dumps(found, indent=2) + "\n")
    text = markdown(found)
    (BUILD / "search.md").write_text(text)
    print(text)


def evaluations(task: Task) -> tuple[int, bool]:
    """How many evaluations it took, and whether it succeeded."""
    method, function = methods()[task.method], on_unit_cube(task.function, task.seed)
    limit = function.minimum + WITHIN * (abs(function.minimum) or 1.0)
    trace = own_trace(method, function, function.dimension, BUDGET, task.seed, {}, limit, EXCLUDED)
    reached = trace.reached(limit)
    return (len(trace.values), False) if reached is None else (reached, True)


def summary(tasks: list[Task], spent: list[tuple[int, bool]]) -> dict[str, dict[str, dict[str, Any]]]:
    """The seeds that succeeded and the expected evaluations, by method and function; None if none succeeded."""
    found: dict[str, dict[str, dict[str, Any]]] = {}
    for method in dict.fromkeys(t.method for t in tasks):
        found[method] = {}
        for function in FUNCTIONS:
            own = [s for t, s in zip(tasks, spent, strict=True) if (t.method, t.function) == (method, function)]
            solved = sum(ok for _, ok in own)
            total = sum(n for n, _ in own)
            found[method][function] = {"solved": solved, "expected": total / solved if solved else None}
    return found


def compared(found: dict[str, dict[str, dict[str, Any]]]) -> dict[str, dict[str, Any]]:
    """The portfolio next to the best of the other methods, function by function."""
    rows = {}
    for function in FUNCTIONS:
        others = {
            m: r[function]["expected"]
            for m, r in found.items()
            if m != PORTFOLIO and r[function]["expected"] is not None
        }
        best = min(others, key=lambda m: others[m]) if others else None
        own = found[PORTFOLIO][function]["expected"]
        allowed = TIMES * others[best] + MORE if best else None
        within = allowed is None or (own is not None and own <= allowed)
        rows[function] = {"best": best, "expected": own, "allowed": allowed, "within": within}
    return rows


def markdown(found: dict[str, Any]) -> str:
    """The tables in words: a row per function."""
    lines = ["# Search methods on test functions"]
    if found["methods"]:  # otherwise all that were asked for are costly
        lines += solved_lines(found)
    if found["portfolio"]:
        lines += compared_lines(found["portfolio"])
    lines += ["", *small_budgets.markdown(found["small_budgets"])]
    return "\n".join([*lines, "", f"Took {found['seconds']:.0f} s.", ""])


def solved_lines(found: dict[str, Any]) -> list[str]:
    """The table of successes and expected evaluations."""
    names = list(found["methods"])
    titles = [methods()[name].title for name in names]
    lines = [
        "",
        f"Seeds of {found['seeds']} that came within {100 * WITHIN:g} % of the minimum ({WITHIN:g} where it is 0) in "
        f"{BUDGET:,} evaluations, and the expected evaluations to get there (all evaluations over successes). Minima "
        "shifted by the seed. Methods of several criteria and costly ones take no part.",
        "",
        f"| function | n | {' | '.join(titles)} |",
        f"|---|---|{'---|' * len(names)}",
    ]
    for function, about in found["functions"].items():
        best = min((found["methods"][m][function]["expected"] or np.inf) for m in names)
        cells = [_cell(found["methods"][m][function], best) for m in names]
        lines.append(f"| {function} | {about['dimension']} | {' | '.join(cells)} |")
    return lines


def compared_lines(portfolio: dict[str, dict[str, Any]]) -> list[str]:
    """The table of the portfolio."""
    lines = ["", f"## Portfolio: within {TIMES} times the best other method's and {MORE} more?", ""]
    lines += ["| function | best other | portfolio | allowed | within |", "|---|---|---|---|---|"]
    for function, row in portfolio.items():
        best_title = methods()[row["best"]].title if row["best"] else "none"
        lines.append(
            f"| {function} | {best_title} | {_number(row['expected'])} | {_number(row['allowed'])} | "
            f"{'yes' if row['within'] else 'no'} |"
        )
    return lines


def _cell(row: dict[str, Any], best: float) -> str:
    text = f"{row['solved']}: {_number(row['expected'])}"
    return f"**{text}**" if row["expected"] == best else text


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:,.0f}"


if __name__ == "__main__":
    main()
