"""CMA-ES from its library: one strategy over the unit cube, its stopping conditions, and costs that it can rank."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

import numpy as np

from worker.engine.search.base import Ended, Floats
from worker.engine.search.parts.cma import Normal

# pycma's stopping conditions and their sentences; the first that holds is reported.
STOPS = {
    "tolflatfitness": Ended("converged", "the cost is constant around the best point"),
    "tolfun": Ended("converged", "the cost no longer changes"),
    "tolfunrel": Ended("converged", "the cost no longer changes"),
    "tolfunhist": Ended("converged", "the cost no longer changes"),
    "tolx": Ended("converged", "the step is within its tolerance"),
    "tolstagnation": Ended("converged", "the cost stopped improving"),
    "tolxstagnation": Ended("converged", "the step is within its tolerance"),
    "tolconditioncov": Ended("rounding", "the valley is too narrow for floating-point numbers"),
}


def strategy(start: Floats, deviation: float, population: int, random: np.random.Generator, step: float) -> Any:
    """pycma's strategy from a start point; it draws from `random` alone and stops below a step."""
    import cma  # imported late: it takes most of a second to load

    options = {
        "bounds": [0.0, 1.0],
        "popsize": population,
        "randn": lambda *shape: random.standard_normal(shape),  # by default it would use numpy's global stream
        "seed": np.nan,
        "tolx": step,
        "verbose": -9,
        "verb_log": 0,
    }
    if len(start) == 1:
        options["maxstd_boundrange"] = np.inf  # keeping to its limit breaks it where there is one parameter
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return cma.CMAEvolutionStrategy(start, deviation, options)


def distribution(strategy: Any) -> Normal:
    """What a strategy draws its next generation from."""
    mean = np.clip(strategy.mean, 0.0, 1.0)
    scales = np.broadcast_to(np.asarray(strategy.sigma_vec.scaling, dtype=np.float64), mean.shape)
    return Normal(mean, float(strategy.sigma), scales[:, None] * np.asarray(strategy.C) * scales)


def ending(stopped: Iterable[str]) -> str:
    """The sentence of the conditions that stopped a strategy."""
    conditions = set(stopped)
    return next((sentence for word, sentence in STOPS.items() if word in conditions), "the strategy stopped")


def last(values: Floats) -> Floats:
    """Values to rank by: infinite ones rank after all others, with equal rank."""
    known = np.isfinite(values)
    if known.all():
        return values
    worst = float(values[known].max()) if known.any() else 0.0
    return np.where(known, values, worst + 1e-3 * max(abs(worst), 1e-3))
