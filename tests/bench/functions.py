"""Our own time for an evaluation of a Python function, whose own time is nearly nothing."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import clearance
from campaigns.asked.load import load_document
from worker.engine.problem.problem import Problem
from worker.running.catalogue.files import PythonFunction
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened

FULL = 4096
PARAMETERS = {"mass": (1.5, 2.3), "drag": (0.1, 0.2)}


def mass_alone(mass: Any, drag: Any) -> Any:
    """Returns its argument."""
    return mass


def problem(vectorized: bool) -> Problem:
    """The function as a search evaluates it: points of the unit cube in, a batch out."""
    declare = clearance.simulator(parameters=PARAMETERS, isolated=False, vectorized=vectorized)
    declared = PythonFunction(declare(mass_alone).declaration, {}, mass_alone)
    campaign = load_document(
        {
            "name": "bench",
            "simulator": {"name": declared.declaration.name},
            "uncertain": {f"simulator.{name}": {"low": low, "high": high} for name, (low, high) in PARAMETERS.items()},
            "criterion": {"result": "value", "threshold": 0.0},
            "stages": {"search": [{"method": "direct", "evaluations": 100}]},
        }
    )
    known = catalogue().model_copy(update={"simulators": [declared.entry]})
    return Problem(campaign, opened.simulated(campaign, declared, known))


def measure() -> dict[str, float]:
    """Microseconds for each evaluation: in batches, called one by one, and in batches of one."""
    points = np.random.default_rng(0).random((FULL, len(PARAMETERS)))
    batches, calls = problem(True), problem(False)
    return {
        "function_vectorized_us": _best(lambda: batches.evaluate(points), FULL),
        "function_call_us": _best(lambda: calls.evaluate(points), FULL),
        "function_single_us": _best(lambda: calls.evaluate(points[:1]), 1, 200),
    }


def _best(work: Callable[[], object], count: int, repeats: int = 9) -> float:
    found = float("inf")
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        found = min(found, time.perf_counter() - began)
    return 1e6 * found / count
