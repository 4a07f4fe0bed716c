"""What a slot costs, here and on a cluster of this machine: a simulator that does nothing, and one that sleeps.

`python -m tests.bench.slots` prints these rows alone.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from worker.engine.systems.simulators.cluster.address import evaluator
from worker.engine.systems.simulators.cluster.pool import DaskPool
from worker.engine.systems.simulators.cluster.work import WORK, Files
from worker.engine.systems.simulators.declared.folder import digest_of
from worker.engine.systems.simulators.slots.outcome import Limits, Request
from worker.engine.systems.simulators.slots.pool import SlotPool
from worker.engine.systems.simulators.slots.program import Program

SLEEP = 0.2
"""[s]"""
EACH = 10
"""Sleeping evaluations for each worker."""
MANY = 2000
SIMULATOR = """
import json, sys, time
for line in sys.stdin:
    time.sleep(json.loads(line)["parameters"]["s"])
    print('{"results": {}}', flush=True)
"""


def measure() -> dict[str, float]:
    """Time of an evaluation that takes none, and the fraction of the ideal speed of one that takes 0.2 s."""
    found: dict[str, float] = {}
    command = [sys.executable, "-S", "-E", "-c", SIMULATOR]
    with tempfile.TemporaryDirectory() as folder:
        with SlotPool(Program(command, "lines", folder=folder), 1) as pool:
            warm(pool)
            found["slot_us"] = 1e6 * best(lambda: pool.evaluate(requests(MANY, 0.0))) / MANY
            found["slot_one_by_one_us"] = 1e6 * best(lambda: [pool.evaluate(requests(1, 0.0)) for _ in range(50)]) / 50
        program, nothing = Program(command, "lines", folder=WORK), Files(folder, digest_of(Path(folder)))
        for workers in (1, 2, 4):
            cluster = evaluator(f"local:{workers}")
            with DaskPool(cluster, program, Limits(), nothing) as there:
                warm(there)
                took = best(lambda: there.evaluate(requests(EACH * there.size, SLEEP)))
                found[f"cluster_{workers}_of_ideal"] = EACH * SLEEP / took
                if workers == 1:
                    found["cluster_us"] = 1e6 * best(lambda: there.evaluate(requests(MANY, 0.0))) / MANY
                    one = best(lambda: [there.evaluate(requests(1, 0.0)) for _ in range(20)])
                    found["cluster_one_by_one_us"] = 1e6 * one / 20
    return found


def requests(count: int, seconds: float) -> list[Request]:
    return [{"parameters": {"s": seconds}}] * count


def warm(pool: SlotPool | DaskPool) -> None:
    """Start all slots."""
    pool.evaluate(requests(4 * pool.size, SLEEP / 4))


def best(work: Callable[[], object], repeats: int = 2) -> float:
    """The shortest time [s]."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return min(times)


if __name__ == "__main__":
    for name, value in measure().items():
        print(f"{name:<24}  {value:,.4g}")
