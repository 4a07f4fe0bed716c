"""Every search method at small budgets: part of `make search-bench`.

`python -m tests.bench.small_budgets [METHOD ...]` prints this table alone, of all or of the given methods; `--seeds N`
takes N seeds from `--first-seed` on, `--processes N` as many processes, and `--functions` names another set: those on
which constants are set (`tuning`, `valleys`), and those on which a choice is checked before it is judged (`check`).
`--keep` keeps the figures for the table of the guide (`tests.bench.figures`).

A score of 1 means that the minimum was found, 0 that the result is the median of as many random points as the smallest
budget: score = 1 - log(1 + gap / tolerance) / log(1 + gap of random points / tolerance), clipped at 0, with the
tolerance 1e-3 of the gap of the random points. It is averaged over problems and seeds. The problems that judge are
those of `tests.given.small_budget_functions`, on which nothing was tuned.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from multiprocessing import get_context
from multiprocessing.pool import Pool
from typing import Any, NamedTuple

import numpy as np

from tests.bench import figures
from tests.bench.scoreboard.searches import Trace, own_trace
from tests.given.small_budget_functions import JUDGED, Judged
from tests.given.small_budget_tuning import TUNING
from tests.given.small_budget_valleys import VALLEYS, Landscape
from worker.running.catalogue.installed import methods

BUDGETS, SEEDS = (20, 50, 100), 15
"""Evaluations per parameter. With three seeds, the mean of ten problems varies by 0.1, as much as methods differ."""
TOLERANCE = 1e-3


class Functions(NamedTuple):
    """A set of problems, its first seed, what they are for, and the problem of which 40 % of the box fails."""

    problems: Mapping[str, Judged | Landscape]
    first_seed: int
    use: str
    failing: str = ""


SETS = {
    "judged": Functions(JUDGED, 1000, "nothing was tuned", "half fails 4"),
    "tuning": Functions(TUNING, 1, "constants are set", "hole 4"),
    "valleys": Functions(VALLEYS[0], 1, "constants are set"),
    "check": Functions(VALLEYS[1], 1, "choices are checked"),
}
PROBLEMS = {name: problem for given in SETS.values() for name, problem in given.problems.items()}
GROUPS = {"many valleys": True, "few valleys": False}


class Task(NamedTuple):
    """One method on one problem with one seed."""

    method: str
    problem: str
    seed: int


class Outcome(NamedTuple):
    """Scores by budget, fraction of failed evaluations at the largest budget, own time per evaluation [s]."""

    scores: tuple[float, ...]
    failed: float
    own: float


def measured(
    pool: Pool, only: list[str] | None = None, seeds: int = SEEDS, functions: str = "judged", first: int | None = None
) -> dict[str, Any]:
    """Scores of every method, or only of these, by group and budget."""
    names = only or [m.name for m in methods().values() if m.kind != "multi"]
    given = SETS[functions]
    first = given.first_seed if first is None else first
    tasks = [Task(m, p, first + s) for m in names for p in given.problems for s in range(seeds)]
    tasks.sort(key=lambda t: not methods()[t.method].costly)
    outcomes = dict(zip(tasks, pool.map(outcome, tasks, chunksize=1), strict=True))
    return {
        "budgets_per_parameter": BUDGETS,
        "seeds": seeds,
        "first_seed": first,
        "problems": len(given.problems),
        "functions": functions,
        "methods": {n: _row({t: o for t, o in outcomes.items() if t.method == n}, given) for n in names},
    }


def _row(own: dict[Task, Outcome], given: Functions) -> dict[str, Any]:
    """The means of one method; a group without problems is left out."""
    row: dict[str, Any] = {}
    for group, valleys in GROUPS.items():
        scores = [o.scores for t, o in own.items() if given.problems[t.problem].valleys == valleys]
        if scores:
            row[group] = list(np.mean(scores, axis=0))
    row["problems"] = {
        p: list(np.mean([o.scores for t, o in own.items() if t.problem == p], axis=0)) for p in given.problems
    }
    if given.failing:
        row["failed of half fails"] = float(np.mean([o.failed for t, o in own.items() if t.problem == given.failing]))
    return row | {"own_ms": 1e3 * float(np.mean([o.own for o in own.values()]))}


def outcome(task: Task) -> Outcome:
    """The scores of one search at each budget; a method whose points depend on the budget searches for each."""
    problem = PROBLEMS[task.problem]
    f, random = problem.at(task.seed), np.random.default_rng(task.seed)
    sizes = [b * problem.dimension for b in BUDGETS]
    drawn = f(random.random((100 * sizes[0], problem.dimension)))
    drawn = np.where(np.isnan(drawn), np.inf, drawn).reshape(100, sizes[0])
    reference = float(np.median(drawn.min(axis=1))) - problem.minimum
    one = methods()[task.method].extend is not None
    long = _trace(task, sizes[-1]) if one else None
    scores, last = [], long
    for size in sizes:
        last = long if long is not None else _trace(task, size)
        gap = max(last.lowest(size) - problem.minimum, 0.0)
        gain = np.log1p(gap / (TOLERANCE * reference)) / np.log1p(1 / TOLERANCE)
        scores.append(max(0.0, 1.0 - float(gain)))
    assert last is not None
    return Outcome(tuple(scores), float(np.isnan(last.values).mean()), last.own / len(last.values))


def _trace(task: Task, budget: int) -> Trace:
    """A search of at most `budget` evaluations."""
    problem = PROBLEMS[task.problem]
    return own_trace(methods()[task.method], problem.at(task.seed), problem.dimension, budget, task.seed, {})


def markdown(found: dict[str, Any]) -> list[str]:
    """The table: a row per method, the best of each column in bold."""
    given, rows = SETS[found["functions"]], found["methods"]
    columns = [(g, k) for g in GROUPS if all(g in row for row in rows.values()) for k in range(len(BUDGETS))]
    heads = [f"{g}, {BUDGETS[k]} n" for g, k in columns] + ["failed"] * bool(given.failing) + ["own [ms]"]
    failed = f"Failed: fraction of evaluations that fail on {given.failing!r}. " if given.failing else ""
    lines = [
        "## Small budgets",
        "",
        f"Mean score at {', '.join(f'{b} n' for b in BUDGETS)} evaluations over {found['problems']} problems and "
        f"{found['seeds']} seeds from {found['first_seed']} on; on these functions {given.use}. 1 is the minimum, 0 "
        f"the median of 20 n random points, on a logarithmic scale. {failed}Own time per evaluation.",
        "",
        f"| method | {' | '.join(heads)} |",
        f"|---|{'---|' * len(heads)}",
    ]
    best = {c: max(row[c[0]][c[1]] for row in rows.values()) for c in columns}
    for name, row in rows.items():
        cells = [f"{row[g][k]:.2f}" for g, k in columns]
        cells = [f"**{t}**" if row[g][k] == best[g, k] else t for t, (g, k) in zip(cells, columns, strict=True)]
        if given.failing:
            cells.append(f"{100 * row['failed of half fails']:.0f} %")
        cells.append(f"{row['own_ms']:.2g}")
        lines.append(f"| {methods()[name].title} | {' | '.join(cells)} |")
    return lines


def add_arguments(given: argparse.ArgumentParser, seeds: int) -> None:
    """The arguments of every bench of search methods."""
    given.add_argument("method", nargs="*", metavar="METHOD", help="all by default")
    given.add_argument("--seeds", type=int, default=seeds)
    given.add_argument("--processes", type=int, default=os.cpu_count())


def checked(given: argparse.ArgumentParser) -> argparse.Namespace:
    """The arguments as given; ends with a sentence where one is not possible."""
    asked = given.parse_args()
    known = [m.name for m in methods().values() if m.kind != "multi"]
    if wrong := [name for name in asked.method if name not in known]:
        given.error(f"no such method: {', '.join(wrong)}; give some of {', '.join(known)}")
    if min(asked.seeds, asked.processes) < 1:
        given.error(f"{asked.seeds} seeds, {asked.processes} processes: give at least 1 of each")
    return asked


def main() -> None:
    """Measure and print the table of small budgets alone, of all methods or of those named."""
    given = argparse.ArgumentParser(description="Scores of search methods at small budgets")
    add_arguments(given, SEEDS)
    given.add_argument("--first-seed", type=int, help="by default that of the set")
    given.add_argument("--functions", choices=SETS, default="judged", help="which set")
    given.add_argument("--keep", action="store_true", help="keep the figures for the table of the guide")
    asked = checked(given)
    if asked.first_seed is not None and asked.first_seed < 0:
        given.error(f"first seed {asked.first_seed}: give 0 or more")
    if asked.keep and (asked.functions, asked.first_seed, asked.seeds) != ("judged", None, SEEDS):
        given.error("the guide has the functions that judge, with the seeds of this bench: leave the other options out")
    os.environ["OMP_NUM_THREADS"] = "1"
    with get_context("spawn").Pool(asked.processes) as pool:
        found = measured(pool, asked.method, asked.seeds, asked.functions, asked.first_seed)
    print("\n".join(markdown(found)))
    if asked.keep:
        figures.keep_small_budgets(found)


if __name__ == "__main__":
    main()
