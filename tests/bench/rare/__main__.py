"""`python -m tests.bench.rare`: the estimate on 22 public and 40 generated problems; writes build/rare.json.

Constants are set on the half `setting` (`--half setting`); the half `judging` judges, with other seeds. `--seeds N`
takes N seeds per run, `--references` computes the probabilities of the public problems again, `--loops` compares with
plain samples of closed loops, `--whole` begins with a search, `--subset` compares with subset simulation. `--keep`
keeps the figures of the judging half for the guide (`tests.bench.figures`).
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tests.bench import figures as kept
from tests.bench.rare import loops, subset, whole
from tests.bench.rare.generated import PROBLEMS, generated
from tests.bench.rare.judge import Outcome, figures, outcomes
from tests.bench.rare.problem import Problem
from tests.bench.rare.public import PUBLIC
from tests.bench.rare.reference import probability

SEEDS = {"setting": 1, "judging": 2001}
"""The first seed of each half."""


def main(arguments: Sequence[str] | None = None, build: Path = Path("build")) -> dict[str, Any]:
    """Measure, print, write; returns what it wrote."""
    given = argparse.ArgumentParser(prog="python -m tests.bench.rare")
    given.add_argument("--half", choices=[*SEEDS], action="append")
    given.add_argument("--seeds", type=int, default=10)
    given.add_argument("--references", action="store_true")
    given.add_argument("--loops", action="store_true")
    given.add_argument("--whole", action="store_true")
    given.add_argument("--subset", action="store_true")
    given.add_argument("--keep", action="store_true")
    asked = given.parse_args(arguments)
    if asked.references:
        return references()
    if asked.loops:
        return {"loops": loops.measured()}
    if asked.whole or asked.subset:
        compare = whole.measured if asked.whole else subset.measured
        compared = {half: compare(*chosen(half, asked.seeds)) for half in asked.half or [*SEEDS]}
        if asked.keep and "judging" in compared:
            kept.keep_rare("whole" if asked.whole else "subset", asked.seeds, compared["judging"])
        return compared
    began, halves = time.perf_counter(), {}
    for half in asked.half or [*SEEDS]:
        runs = measured(half, asked.seeds)
        halves[half] = {name: figures(of) for name, of in parts(runs).items()}
        report(half, runs, halves[half])
        if asked.keep and half == "judging":
            kept.keep_rare("judging", asked.seeds, halves[half]["all"])
    result = {"seeds": asked.seeds, "seconds": time.perf_counter() - began, "halves": halves}
    build.mkdir(exist_ok=True)
    (build / "rare.json").write_text(json.dumps(result, indent=2), encoding="utf-8")
    return result


def chosen(half: str, seeds: int) -> tuple[list[Problem], range]:
    """The problems and the seeds of a half."""
    problems = [*PUBLIC, *(generated(i) for i in range(PROBLEMS))]
    return [problem for problem in problems if problem.half == half], range(SEEDS[half], SEEDS[half] + seeds)


def measured(half: str, seeds: int) -> list[Outcome]:
    """All runs of a half."""
    problems, of_half = chosen(half, seeds)
    return [run for problem in problems for run in outcomes(problem, of_half)]


def parts(runs: list[Outcome]) -> dict[str, list[Outcome]]:
    """The runs together, and of each kind of problem."""
    made = [run for run in runs if run.problem.startswith("generated")]
    return {"all": runs, "public": [run for run in runs if run not in made], "generated": made}


def report(half: str, runs: list[Outcome], found: dict[str, dict[str, Any]]) -> None:
    """A table of the figures, and the problems on which an interval failed without an alarm."""
    print(f"\n{half:24}{''.join(f'{name:>12}' for name in found)}")
    for figure in found["all"]:
        values = ["-" if of[figure] is None else f"{of[figure]:.4g}" for of in found.values()]
        print(f"{figure:24}{''.join(f'{value:>12}' for value in values)}")
    silent = [r for r in runs if not r.alarms and not r.holds]
    for (name, withheld), count in Counter((r.problem, r.withheld) for r in silent).most_common():
        ratios = [f"{r.ratio:.2f}" for r in silent if (r.problem, r.withheld) == (name, withheld)]
        print(f"  does not hold, no alarm: {name}, withheld {withheld:.0%}: {count} times, of P {', '.join(ratios)}")
    missed = Counter((r.problem, r.withheld) for r in runs if r.withheld > 0.1 and not r.found and not r.alarms)
    for (name, withheld), count in missed.most_common():
        print(f"  not found, no alarm: {name}, withheld {withheld:.0%}: {count} times")


def references() -> dict[str, Any]:
    """The probabilities of the public problems again, next to those in the table and the published ones."""
    found: dict[str, Any] = {}
    for problem in PUBLIC:
        value, error = probability(problem)
        found[problem.name] = {**asdict(problem), "recomputed": value, "error": error}
        published = problem.published or value
        print(
            f"{problem.name:14} recomputed {value:.6g} +- {error / value:.2%}, table {problem.probability:.6g} "
            f"({problem.probability / value - 1.0:+.2%}), published {published:.5g} ({published / value - 1.0:+.2%})"
        )
    return found


if __name__ == "__main__":
    main()
