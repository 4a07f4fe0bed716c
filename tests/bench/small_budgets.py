"""Every search method at small budgets: part of `make search-bench`.

`python -m tests.bench.small_budgets [METHOD ...]` prints this table alone, of all or of the given methods; `--seeds N`
takes N seeds, `--processes N` as many processes, and `--tuning` the functions on which constants are set.

A score of 1 means that the minimum was found, 0 that the result is the median of as many random points as the smallest
budget: score = 1 - log(1 + gap / tolerance) / log(1 + gap of random points / tolerance), clipped at 0, with the
tolerance 1e-3 of the gap of the random points. It is averaged over problems and seeds. The problems are those of
`tests.unit.small_budgets`, on which nothing was tuned. Start reading at `measured`.
"""

from __future__ import annotations

import argparse
import os
import time
from multiprocessing import get_context
from multiprocessing.pool import Pool
from typing import Any, NamedTuple

import numpy as np

from campaigns.results.base import FAILED
from tests.unit.searching import batch, space
from tests.unit.small_budgets import JUDGED
from tests.unit.small_budgets_tuning import TUNING
from worker.catalogue.installed import methods
from worker.search.base import Floats

BUDGETS, SEEDS, FIRST_SEED = (20, 50, 100), 3, 1000
"""Evaluations per parameter; seeds from 1000 on, which nothing else uses."""
TOLERANCE = 1e-3
TUNING_SEED = 1
"""Constants are set with seeds from here on."""
PROBLEMS = {**JUDGED, **TUNING}
FAILING = {False: "half fails 4", True: "hole 4"}
"""Where evaluations fail: among the problems that judge and among those of tuning."""
SET = {False: "nothing was tuned", True: "constants are set"}


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


def measured(pool: Pool, only: list[str] | None = None, seeds: int = SEEDS, tuning: bool = False) -> dict[str, Any]:
    """Scores of every method, or only of these, by group and budget."""
    names = only or [m.name for m in methods().values() if m.kind != "multi"]
    problems, first = (TUNING, TUNING_SEED) if tuning else (JUDGED, FIRST_SEED)
    tasks = [Task(m, p, first + s) for m in names for p in problems for s in range(seeds)]
    tasks.sort(key=lambda t: not methods()[t.method].costly)
    outcomes = dict(zip(tasks, pool.map(outcome, tasks, chunksize=1), strict=True))
    found: dict[str, Any] = {"budgets_per_parameter": BUDGETS, "seeds": seeds, "problems": len(problems)}
    found |= {"tuning": tuning, "methods": {}}
    for name in names:
        own = {t: o for t, o in outcomes.items() if t.method == name}
        groups = {
            "many valleys": [o for t, o in own.items() if problems[t.problem].valleys],
            "few valleys": [o for t, o in own.items() if not problems[t.problem].valleys],
        }
        found["methods"][name] = {g: list(np.mean([o.scores for o in rows], axis=0)) for g, rows in groups.items()} | {
            "problems": {
                p: list(np.mean([o.scores for t, o in own.items() if t.problem == p], axis=0)) for p in problems
            },
            "failed of half fails": float(np.mean([o.failed for t, o in own.items() if t.problem == FAILING[tuning]])),
            "own_ms": 1e3 * float(np.mean([o.own for o in own.values()])),
        }
    return found


def outcome(task: Task) -> Outcome:
    """The scores of one search at each budget; a method whose points depend on the budget searches for each."""
    problem = PROBLEMS[task.problem]
    f, random = problem.at(task.seed), np.random.default_rng(task.seed)
    sizes = [b * problem.dimension for b in BUDGETS]
    drawn = f(random.random((100 * sizes[0], problem.dimension)))
    drawn = np.where(np.isnan(drawn), np.inf, drawn).reshape(100, sizes[0])
    reference = float(np.median(drawn.min(axis=1))) - problem.minimum
    one = methods()[task.method].extend is not None
    long = _values(task, sizes[-1]) if one else None
    scores, last = [], long
    for size in sizes:
        last = long if long is not None else _values(task, size)
        lowest = float(np.nanmin(np.append(last[0][:size], np.inf)))
        gap = max(lowest - problem.minimum, 0.0)
        gain = np.log1p(gap / (TOLERANCE * reference)) / np.log1p(1 / TOLERANCE)
        scores.append(max(0.0, 1.0 - float(gain)))
    assert last is not None
    values, own = last
    return Outcome(tuple(scores), float(np.isnan(values).mean()), own / len(values))


def _values(task: Task, budget: int) -> tuple[Floats, float]:
    """The values of at most `budget` evaluations, NaN where failed, and the method's own time [s]."""
    method, problem = methods()[task.method], PROBLEMS[task.problem]
    f, known = problem.at(task.seed), dict[bytes, float]()
    values: list[float] = []
    search = method.search(space(problem.dimension, budget, seed=task.seed), method.options())
    own, answer = 0.0, None
    try:
        while len(values) < budget:
            began = time.process_time()
            try:
                points = search.send(answer)  # type: ignore[arg-type]
            finally:
                own += time.process_time() - began
            got = f(points)
            for point, value in zip(points, got, strict=True):
                if not (method.repeats and point.tobytes() in known):
                    values.append(float(value))
                known[point.tobytes()] = float(value)
            answer = batch(got, FAILED)
    except StopIteration:
        pass
    finally:
        search.close()
    return np.array(values[:budget]), own


def markdown(found: dict[str, Any]) -> list[str]:
    """The table: a row per method, the best of each column in bold."""
    groups = ("many valleys", "few valleys")
    columns = [(g, k) for g in groups for k in range(len(BUDGETS))]
    heads = [f"{g}, {BUDGETS[k]} n" for g, k in columns]
    lines = [
        "## Small budgets",
        "",
        f"Mean score at {', '.join(f'{b} n' for b in BUDGETS)} evaluations over {found['problems']} problems and "
        f"{found['seeds']} seeds on which {SET[found['tuning']]}: 1 is the minimum, 0 the median of 20 n random "
        f"points, on a logarithmic scale. Failed: fraction of evaluations that fail on {FAILING[found['tuning']]!r}. "
        "Own time per evaluation.",
        "",
        f"| method | {' | '.join(heads)} | failed | own [ms] |",
        f"|---|{'---|' * (len(heads) + 2)}",
    ]
    best = {c: max(row[c[0]][c[1]] for row in found["methods"].values()) for c in columns}
    for name, row in found["methods"].items():
        cells = [f"{row[g][k]:.2f}" for g, k in columns]
        cells = [f"**{t}**" if row[g][k] == best[g, k] else t for t, (g, k) in zip(cells, columns, strict=True)]
        more = f"{100 * row['failed of half fails']:.0f} % | {row['own_ms']:.2g}"
        lines.append(f"| {methods()[name].title} | {' | '.join(cells)} | {more} |")
    return lines


def main() -> None:
    """Measure and print the table of small budgets alone, of all methods or of those named."""
    given = argparse.ArgumentParser(description="Scores of search methods at small budgets")
    given.add_argument("method", nargs="*", metavar="METHOD", help="all by default")
    given.add_argument("--seeds", type=int, default=SEEDS)
    given.add_argument("--processes", type=int, default=os.cpu_count())
    given.add_argument("--tuning", action="store_true")
    asked = given.parse_args()
    known = [m.name for m in methods().values() if m.kind != "multi"]
    if wrong := [name for name in asked.method if name not in known]:
        given.error(f"no such method: {', '.join(wrong)}; give some of {', '.join(known)}")
    if min(asked.seeds, asked.processes) < 1:
        given.error(f"{asked.seeds} seeds, {asked.processes} processes: give at least 1 of each")
    os.environ["OMP_NUM_THREADS"] = "1"
    with get_context("spawn").Pool(asked.processes) as pool:
        print("\n".join(markdown(measured(pool, asked.method, asked.seeds, asked.tuning))))


if __name__ == "__main__":
    main()
