"""Evaluations stated and made: the bound of each campaign that is announced before it runs, and what its system made.

`python -m tests.bench.bounds [NAME ...]`, by default all campaigns of the library and those of own systems, prints the
rows of the table in docs/methods.md; it ends with 1 if a bound was exceeded.
"""

from __future__ import annotations

import itertools
import subprocess
import sys
from typing import Any

import clearance
from campaigns import Campaign, library, load_file
from campaigns.asked.load import load_document
from campaigns.sample_seed import SampleSeed
from campaigns.stages.plan import most
from tests.faults.processes import REPOSITORY
from tests.given.made_evaluations import flights, requests
from tests.simulators import noisy
from tests.simulators.adversaries import adversary
from worker.engine.problem.problem import Problem
from worker.engine.systems.simulators.declared.descriptor import read
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

EXAMPLES = REPOSITORY / "docs" / "examples"
PROGRAMS = ("mass_spring", "fmu_drop", "jsbsim_intruder", "bluesky_mvp")
OWN = ("Python function", "noisy", *PROGRAMS)
Row = tuple[int, int, int]
"""The budget of the searches, the bound of the run, and what was made."""


def shipped(name: str) -> Row:
    """A campaign of the library."""
    asked = load_file(library()[name])
    with flights() as made:
        execute(asked, MemoryStore())
    return _searches(asked), most(asked), made.total()


def program(name: str) -> tuple[Row, MemoryStore]:
    """An example of docs/examples, with its campaign, and its results; the seed of its sample is that of the guide."""
    if (build := EXAMPLES / name / "build.sh").exists():
        subprocess.run(["bash", str(build)], cwd=build.parent, check=True, capture_output=True)
    simulator = read(EXAMPLES / name)
    asked = load_file(EXAMPLES / "campaigns" / f"{name}.yaml")
    known = catalogue().model_copy(update={"simulators": [simulator.entry]})
    system: Any = opened.simulated(asked, simulator, known)
    store = MemoryStore(sample_seed=SampleSeed(1))
    with requests(system) as made:
        execute(asked, store, problem=Problem(asked, system))
    return (_searches(asked), most(asked), made[0]), store


def unrepeatable() -> Row:
    """A simulator that does not repeat."""
    made: Any = noisy.campaign(1.0, 120).document()
    made["stages"]["validate"].pop("evaluations")
    asked = load_document(made)
    with adversary("noise") as simulated:
        execute(asked, MemoryStore(), threads=1)
        return _searches(asked), most(asked), next(simulated.world.calls) - 1


def function() -> Row:
    """A function with two minima and the settings that `clearance.search` has by default."""
    calls = itertools.count()

    def margin(a: float, b: float) -> float:
        next(calls)
        return 10 - 3 * a - (b - 0.5) ** 2 + 0.5 * (1 - (2 * b - 1) ** 4)

    found = clearance.search(margin, {"a": (0.0, 1.0), "b": (0.0, 1.0)}, 6.0)
    return _searches(found.origin.campaign), found.bound, next(calls)


def _searches(campaign: Campaign) -> int:
    return sum(search.evaluations for search in campaign.stages.search)


def main(names: list[str]) -> int:
    """The exit code."""
    exceeded = 0
    for name in names or [*library(), *OWN]:
        own = {"Python function": function, "noisy": unrepeatable}
        row = own[name]() if name in own else program(name)[0] if name in PROGRAMS else shipped(name)
        exceeded += row[-1] > row[-2]
        print(f"| {name} | {' | '.join(f'{number:,}' for number in row)} |", flush=True)
    return int(exceeded > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
