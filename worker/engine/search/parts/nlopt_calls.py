"""Runs an NLopt optimiser, which requests one point at a time, as a search.

NLopt needs a number for every point. A point without a value gets the highest cost so far, but only inside the library:
everything counted, stored and reported comes from the evaluations themselves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import nlopt
import numpy as np

from worker.engine.search.base import Ended, Floats, Search, Space
from worker.engine.search.parts.callback import Ask, called_back, called_back_in_thread
from worker.engine.search.parts.lowest import Lowest, Reported

STOPPED = {
    nlopt.FTOL_REACHED: Ended("converged", "the cost no longer changes"),
    nlopt.XTOL_REACHED: Ended("converged", "the step is within its tolerance"),
    nlopt.STOPVAL_REACHED: Ended("optimal", "the cost cannot be lower"),
}


OWN = Ended("library", "the library's own rule stopped the search")


def optimised(space: Space, build: Callable[[], Any], random: bool = True) -> Search:
    """Run the optimiser returned by `build` on the unit cube until it ends; reports its lowest point.

    random: it draws from NLopt's random stream, which belongs to a thread; others need none of their own.
    """
    called = called_back_in_thread if random else called_back
    seed = int(space.random.integers(1, 2**31))
    with Reported(space) as best:
        best.text = yield from called(lambda ask: _run(ask, space.dimension, build, best, seed))
    return best.text


def _run(ask: Ask, dimension: int, build: Callable[[], Any], best: Lowest, seed: int) -> str:
    highest = -np.inf

    def cost(x: Floats, gradient: Floats) -> float:
        nonlocal highest
        point = x.clip(0.0, 1.0)[None, :]
        if not math.isfinite(float(x.sum())):  # a model degraded by rounding may request NaN: use the centre instead
            point = np.where(np.isfinite(x), point, 0.5)
        values = ask(point.copy()).ranked()
        best.see(point, values)
        value = float(values[0])
        if not np.isfinite(value):
            return highest if np.isfinite(highest) else 0.0
        highest = max(highest, value)
        return value

    nlopt.srand(seed)  # NLopt's random stream belongs to the thread, which is this search's own
    optimiser = build()
    optimiser.set_min_objective(cost)
    optimiser.set_lower_bounds(np.zeros(dimension))
    optimiser.set_upper_bounds(np.ones(dimension))
    try:
        optimiser.optimize(np.full(dimension, 0.5))
    except (nlopt.RoundoffLimited, nlopt.roundoff_limited):
        return Ended("rounding", "rounding stopped the search")
    except (nlopt.runtime_error, RuntimeError, MemoryError, ValueError) as error:
        return Ended("library", "the library stopped the search: {error}", error=str(error) or type(error).__name__)
    return STOPPED.get(optimiser.last_optimize_result(), OWN)
