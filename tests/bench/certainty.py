"""What a sample of any size takes: `make certainty-bench` prints it and writes build/certainty.json.

Case 1 to 1e-6 (2,995,732 flights) as a worker flies it, into a database in a file, beside the bare kernel in the same
process before and after; its memory and what it stores. Then the same sample by one worker and by two, each on one
thread, from its first block to its last. Then the rate of case 5; last what is computed from stored evaluations.
`--samples N` flies fewer.
"""

from __future__ import annotations

from worker.running.processes import blas as blas  # before numpy is loaded

# isort: split
import argparse
import json
import math
import resource
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import sqlalchemy as sa

from backend.db.engine import connect, default_url, migrate, read
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from backend.db.tables import EvaluationChunk, Run, SampleShare, Stage, Worker
from campaigns import Campaign, library, load_file
from campaigns.results.draws import uniform
from campaigns.sample_seed import SampleSeed
from campaigns.stages.certify import CertifyResult
from campaigns.stages.plan import most
from tests.bench import stored
from tests.faults.processes import until, worker
from worker.engine.problem.evaluate import InProcess
from worker.engine.systems import optional
from worker.running.opening import opened
from worker.running.runs.runner import execute

SAMPLES = math.ceil(math.log(0.05) / math.log1p(-1e-6))
BARE, RATE = 200_000, 20_000
"""Flights of the bare kernel, and those that give the rate of case 5."""
OUT = Path("build/certainty.json")


def case(name: str, samples: int) -> Campaign:
    """A campaign of the library with short searches and a counted sample."""
    document = load_file(library()[name]).document()
    document["stages"]["search"] = [{"method": "direct", "evaluations": 200}]
    document["stages"] |= {"sensitivity": None, "certify": {"samples": samples, "keep": "lowest"}}
    document["stages"] |= {"validate": {"neighbours": 0, "evaluations": 20_000}}
    return Campaign.model_validate(document)


def bare(campaign: Campaign) -> float:
    """Flights a second of the kernel alone, on points of the sample's own generator."""
    problem = opened.problem(campaign)
    optional.warm(problem.system)
    evaluate = InProcess(problem)
    points = uniform(2, 0, 0, BARE, problem.dimension)
    evaluate(points[:4096])
    began = time.perf_counter()
    evaluate(points)
    taken = time.perf_counter() - began
    evaluate.close()
    optional.close(problem.system)
    return BARE / taken


def alone(campaign: Campaign, samples: int, folder: Path) -> dict[str, Any]:
    """In this process, into a database in a file."""
    migrate(url := default_url(folder))
    engine = connect(url)
    with engine.begin() as connection:
        submit(connection, campaign, name="bench", tags=[], owner="", planned=most(campaign), seed=SampleSeed.drawn())
    claim = Queue(engine).claim("bench")
    assert claim is not None
    before, memory = bare(campaign), peak()
    verdict = execute(campaign, RunStore(engine, claim))
    grown, after = peak() - memory, bare(campaign)
    with read(engine) as connection:
        of = sa.select(Stage.position, Stage.seconds, sa.func.length(sa.cast(Stage.result, sa.Text)).label("result"))
        stage = connection.execute(of.where(Stage.kind == "certify")).one()
        sizes = [sa.func.sum(sa.func.length(getattr(EvaluationChunk, name))) for name in ("points", "costs", "status")]
        rows = connection.execute(sa.select(*sizes).where(EvaluationChunk.position == stage.position)).one()
        whole = connection.scalar(sa.select(Run.size))
    engine.dispose()
    rate, kernel = samples / stage.seconds, (before + after) / 2
    assert verdict.statistics is not None
    return {
        "samples": samples,
        "statement": verdict.statistics.text,
        "upper_bound": verdict.statistics.upper_bound,
        "seconds": stage.seconds,
        "flights_per_second": rate,
        "bare_kernel_per_second": [before, after],
        "share_of_bare_kernel": rate / kernel,
        "memory_grown_bytes": grown,
        "stored_bytes_of_stage": int(stage.result) + sum(map(int, rows)),
        "stored_bytes_of_run": whole,
    }


def peak() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def shared(campaign: Campaign, number: int, folder: Path) -> dict[str, Any]:
    """By so many workers of one thread each; the time from the first block to the last."""
    folder.mkdir()
    migrate(url := default_url(folder))
    engine = connect(url)

    def value(query: sa.Select[Any]) -> Any:
        with read(engine) as connection:
            return connection.scalar(query)

    with ExitStack() as stack:
        for k in range(number):
            stack.enter_context(worker(url, folder, f"worker-{k}"))
        ready = sa.select(sa.func.count()).select_from(Worker).where(Worker.installation != "")
        until(lambda: value(ready) == number, "all workers are ready", 120)
        with engine.begin() as connection:
            submit(connection, campaign, name="bench", tags=[], owner="", planned=1, seed=SampleSeed(1, stated=True))
        counted = sa.select(Stage.counted).where(Stage.kind == "certify")
        until(lambda: (value(counted) or 0) > 0, "the sample is begun", 120)
        takers = sa.select(sa.func.count(sa.distinct(SampleShare.worker)))
        until(lambda: value(takers) == number, "it is shared", 60)
        began, first = time.perf_counter(), value(counted)
        until(lambda: value(sa.select(Stage.state).where(Stage.kind == "certify")) == "done", "it is drawn", 3600)
        taken, drawn = time.perf_counter() - began, value(counted)
        result = value(sa.select(Stage.result).where(Stage.kind == "certify"))
    engine.dispose()
    found = CertifyResult.model_validate(result)
    assert found.blocks is not None
    return {"workers": number, "flights_per_second": (drawn - first) / taken, "digests": found.blocks.digests}


def sharing(samples: int, folder: Path) -> dict[str, Any]:
    one, two = (shared(case("unicycle_static", samples), k, folder / f"of-{k}") for k in (1, 2))
    same = one.pop("digests") == two.pop("digests")
    return {"samples": samples, "one": one, "two": two, "same_bits": same,
            "ratio": two["flights_per_second"] / one["flights_per_second"]}  # fmt: skip


def rate() -> dict[str, Any]:
    """Of case 5."""
    campaign = case("uav_aca", RATE)
    problem = opened.problem(campaign)
    optional.warm(problem.system)
    evaluate = InProcess(problem)
    points = uniform(3, 0, 0, RATE, problem.dimension)
    evaluate(points[:256])
    began = time.perf_counter()
    evaluate(points)
    taken = time.perf_counter() - began
    return {"case": "uav_aca", "flights_per_second": RATE / taken, "hours_to_1e-6": SAMPLES / (RATE / taken) / 3600}


def lines(found: dict[str, Any]) -> Iterator[str]:
    a, s, r = found["alone"], found["sharing"], found["rate"]
    yield a["statement"]
    yield (
        f"{a['samples']:,} flights in {a['seconds']:.1f} s: {a['flights_per_second']:,.0f} a second, "
        f"{a['share_of_bare_kernel']:.2f} of the bare kernel; memory +{a['memory_grown_bytes'] / 1e6:.0f} MB; "
        f"the stage stores {a['stored_bytes_of_stage'] / 1e6:.2f} MB, the run {a['stored_bytes_of_run'] / 1e6:.2f} MB"
    )
    yield f"two workers of one thread: {s['ratio']:.2f} times the rate of one; same bits: {s['same_bits']}"
    yield f"{r['case']}: {r['flights_per_second']:,.0f} flights a second, {r['hours_to_1e-6']:.1f} h to 1e-6"
    yield stored.line(found["stored"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=SAMPLES)
    parser.add_argument("--join", action="store_true", help="only add what the other benches of certainty wrote")
    asked = parser.parse_args()
    if asked.join:
        join()
    else:
        measure(asked.samples)


def measure(samples: int) -> None:
    """Measure, write and print what a sample takes."""
    np.seterr(all="ignore")
    with tempfile.TemporaryDirectory() as folder:
        found = {
            "alone": alone(case("unicycle_static", samples), samples, Path(folder)),
            "sharing": sharing(min(samples, 400_000), Path(folder)),
            "rate": rate(),
            "stored": stored.measured(case("unicycle_static", samples)),
        }
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    print("\n".join(lines(found)))


def join() -> None:
    """Add the files of the benches of estimates, regions of attraction and proofs, as far as they have been run."""
    found = json.loads(OUT.read_text(encoding="utf-8"))
    for file in (OUT.with_stem(name) for name in ("rare", "attraction", "proof")):
        found[file.stem] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else None
    OUT.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
