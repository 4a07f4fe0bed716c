"""`make bench`: cost of an evaluation, as ratios measured in one run; prints a table, writes build/bench.json.

Every figure is the best of several repetitions on one thread; the machine should be idle.
"""

from __future__ import annotations

import ctypes
import json
import os
import platform
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from campaigns import library, load_file
from clearance.testing.problems import Problem
from tests.bench import functions, methods, reference_pioneer, reference_uav, slots
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.runs.provenance import versions

BUILD = Path("build")
FULL = 4096
FLAGS = ["-O3", "-march=native", "-ffast-math", "-fPIC"]

FIRST_EVALUATION = """
import time
began = time.perf_counter()
from campaigns import library, load_file
from clearance.testing.problems import Problem
problem = Problem(load_file(library()["unicycle_static"]))
problem.evaluate(problem.nominal_point[None])
print(time.perf_counter() - began)
"""


def main() -> None:
    """Measure, print, write."""
    BUILD.mkdir(exist_ok=True)
    problem = Problem(load_file(library()["unicycle_static"]))
    found: dict[str, Any] = unicycle(problem) | pioneer() | aircraft() | methods.measure()
    found |= functions.measure() | slots.measure()
    found["second_process_first_eval_s"] = second_process()
    cpu = versions(problem.campaign, problem.system).cpu
    found |= {"cpu": cpu.model if cpu else "", "cores": os.cpu_count(), "python": platform.python_version()}
    (BUILD / "bench.json").write_text(json.dumps(found, indent=2) + "\n")
    width = max(map(len, found))
    for key, value in found.items():
        print(f"{key:<{width}}  {value:,.4g}" if isinstance(value, float) else f"{key:<{width}}  {value}")


def unicycle(problem: Problem) -> dict[str, Any]:
    """Case 1 at full batch: the lockstep loop, the same components at one lane, and hand-written C++."""
    points = np.random.default_rng(0).random((FULL, problem.dimension))
    vectors = problem.vectors(points)
    steps, _ = problem.system.counts(problem.system.step)
    narrow = Loop(problem.system.parts, lanes=1)
    wide = lambda: problem.system.loop.simulate(vectors, problem.system.step, steps)  # noqa: E731
    slow = lambda: narrow.simulate(vectors[:256], problem.system.step, steps)  # noqa: E731
    library_, compiler = build_cpp()
    costs = np.empty(256)
    handwritten = lambda: fly_cpp(library_, problem, vectors[:256], steps, costs)  # noqa: E731
    handwritten()
    apart = float(
        np.abs(costs - problem.system.loop.simulate(vectors[:256], problem.system.step, steps).costs[:, 0]).max()
    )
    seconds = interleaved([(wide, FULL), (slow, 256), (handwritten, 256)])
    one = interleaved([(lambda: problem.system.loop.simulate(vectors[:1], problem.system.step, steps), 1)], repeats=50)
    return {
        "unicycle_evals_per_s": 1.0 / seconds[0],
        "unicycle_us": 1e6 * seconds[0],
        "unicycle_one_lane_us": 1e6 * seconds[1],
        "unicycle_cpp_us": 1e6 * seconds[2],
        "unicycle_single_us": 1e6 * one[0],
        "unicycle_vs_one_lane": seconds[1] / seconds[0],
        "unicycle_vs_cpp": seconds[2] / seconds[0],
        "unicycle_largest_difference_from_cpp_m": apart,
        "unicycle_lanes": problem.system.loop.lanes,
        "cpp_compiler": compiler,
    }


def pioneer() -> dict[str, Any]:
    """Case 2 at full batch, against the plain scalar program that does the same work."""
    problem = Problem(load_file(library()["pioneer_moving"]))
    vectors = problem.vectors(np.random.default_rng(0).random((FULL, problem.dimension)))
    reference = reference_pioneer.Reference(problem, vectors[:128])
    apart = float(np.abs(reference.costs() - problem.system.simulate_vectors(vectors[:128])[0].costs[:, 0]).max())
    seconds = interleaved([(lambda: problem.system.simulate_vectors(vectors), FULL), (reference.costs, 128)])
    return {
        "pioneer_us": 1e6 * seconds[0],
        "pioneer_reference_us": 1e6 * seconds[1],
        "pioneer_vs_reference": seconds[1] / seconds[0],
        "pioneer_largest_difference_from_reference_m": apart,
    }


def aircraft() -> dict[str, Any]:
    """Cases 3 to 5 at full batch, against the plain scalar programs, which stop once the flight is clear."""
    found: dict[str, Any] = {}
    for case, name in ((3, "uav_static"), (4, "uav_moving"), (5, "uav_aca")):
        problem = Problem(load_file(library()[name]))
        vectors = problem.vectors(np.random.default_rng(0).random((FULL, problem.dimension)))
        reference = reference_uav.Reference(case, problem, vectors[:128])
        apart = float(np.abs(reference.costs() - problem.system.simulate_vectors(vectors[:128])[0].costs[:, 0]).max())
        every = [(partial(problem.system.simulate_vectors, vectors), FULL), (reference.costs, 128)]
        seconds = interleaved([*every, (partial(problem.system.simulate_vectors, vectors[:1]), 1)])
        found |= {
            f"{name}_us": 1e6 * seconds[0],
            f"{name}_single_us": 1e6 * seconds[2],
            f"{name}_reference_us": 1e6 * seconds[1],
            f"{name}_vs_reference": seconds[1] / seconds[0],
            f"{name}_largest_difference_from_reference_m": apart,
        }
    return found


def interleaved(measured: list[tuple[Callable[[], object], int]], repeats: int = 9) -> list[float]:
    """Seconds per evaluation of each, the best of several interleaved rounds, so that noise affects all equally."""
    for work, _ in measured:
        work()
    best = [float("inf")] * len(measured)
    for _ in range(repeats):
        for i, (work, count) in enumerate(measured):
            began = time.perf_counter()
            work()
            best[i] = min(best[i], (time.perf_counter() - began) / count)
    return best


def build_cpp() -> tuple[ctypes.CDLL, str]:
    """Compile the yardstick; returns it and the compiler's version."""
    compiler = shutil.which(os.environ.get("CXX", "g++"))
    if compiler is None:
        sys.exit("g++ is needed for the comparison; install it or name a compiler in CXX")
    target = BUILD / "unicycle_cpp.so"
    source, compiled = Path(__file__).with_name("unicycle.cpp"), target.with_suffix(".o")
    subprocess.run([compiler, *FLAGS, "-c", "-o", str(compiled), str(source)], check=True)
    # Linked without -ffast-math: that would add start-up code which rounds subnormal numbers of the whole process to 0.
    subprocess.run([compiler, "-shared", "-o", str(target), str(compiled)], check=True)
    version = subprocess.run([compiler, "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]
    return ctypes.CDLL(str(target.absolute())), f"{version}, {' '.join(FLAGS[:3])}"


def fly_cpp(cpp: ctypes.CDLL, problem: Problem, vectors: Floats, steps: int, costs: Floats) -> None:
    """Simulate with the hand-written loop; its parameters have the same order."""
    cpp.simulate_all(
        vectors.ctypes.data_as(ctypes.c_void_p), len(vectors), ctypes.c_double(problem.system.step), steps,
        costs.ctypes.data_as(ctypes.c_void_p),
    )  # fmt: skip


def second_process() -> float:
    """Seconds from the first import to the first evaluation in a process that finds the loop on disk."""
    times = []
    for _ in range(3):
        done = subprocess.run([sys.executable, "-c", FIRST_EVALUATION], check=True, capture_output=True, text=True)
        times.append(float(done.stdout))
    return min(times)


if __name__ == "__main__":
    main()
