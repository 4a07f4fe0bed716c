"""`make library-verdicts`: runs every campaign of the library to its verdict, into a file that a nightly test holds.

Samples depend on their seed, which every launch draws; here it is `SEED`. A change of a rule shows as a change of the
file and of the table in docs/evidence.md, where its reason is to be added. With names, only these campaigns are run:
`python -m tools.library_verdicts uav_static`.
"""

from __future__ import annotations

from worker.running.processes import blas as blas  # before numpy is loaded

# isort: split
import json
import sys
import time
from pathlib import Path
from typing import Any

from campaigns import library, load_file
from campaigns.results import Verdict
from campaigns.sample_seed import SampleSeed
from tools import generated
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

FILE = Path(__file__).parents[1] / "tests" / "golden" / "library_verdicts.json"
SEED = 20_261_124
"""Of every sample, as if it had been drawn at the launch."""
DIGITS = 6


def main(names: list[str]) -> None:
    """Write the verdicts of these campaigns again, of all without names."""
    known = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    for name in names or library():
        began, before = time.monotonic(), known.get(name)
        known[name] = ran(name)
        change = "" if known[name] == before else f" (before: {before})"
        print(f"{name}: {known[name]} in {time.monotonic() - began:.0f} s{change}", flush=True)
        FILE.write_text(written({name: known[name] for name in library() if name in known}), encoding="utf-8")
    generated.main()


def written(verdicts: dict[str, Any]) -> str:
    """The file's text: one line for each campaign, so that a change shows which."""
    return "{\n" + ",\n".join(f"{json.dumps(name)}: {json.dumps(one)}" for name, one in verdicts.items()) + "\n}\n"


def ran(name: str) -> dict[str, Any]:
    """The verdict of a campaign of the library, run now, and the evaluations that it took."""
    store = MemoryStore(sample_seed=SampleSeed(SEED, stated=False))
    return stated(execute(load_file(library()[name]), store)) | {"evaluations": evaluated(store)}


def evaluated(store: MemoryStore) -> dict[str, int]:
    """The number of stored evaluations by kind of stage."""
    found: dict[str, int] = {}
    for position, record in enumerate(store.stages):
        columns = store.evaluations(position)
        found[record.plan.kind] = found.get(record.plan.kind, 0) + (0 if columns is None else len(columns.status))
    return found


def stated(verdict: Verdict) -> dict[str, Any]:
    """What the file has of a verdict; margin: of the worst case that it states [unit of the criterion]."""
    worst = verdict.worst
    return {
        "verdict": str(verdict.verdict),
        "fails": [check.name for check in verdict.checks if not check.ok],
        "margin": None if worst is None else float(f"{worst.margin:.{DIGITS}g}"),
        "unit": verdict.unit,
    }


if __name__ == "__main__":
    main(sys.argv[1:])
