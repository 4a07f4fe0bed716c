"""Runs an NLopt optimiser, which requests one point at a time, as a search.

NLopt needs a number for every point. A point without a value gets the highest cost so far, but only inside the library:
everything counted, stored and reported comes from the evaluations themselves.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Generator
from typing import Any

import nlopt
import numpy as np

from campaigns.results.base import OK
from worker.engine.search.base import Batch, Ended, Floats, Search, Space
from worker.engine.search.parts.callback import Abandoned, Ask, called_back, called_back_in_thread
from worker.engine.search.parts.descent import End
from worker.engine.search.parts.lowest import Lowest, Reported

STOPPED = {
    nlopt.FTOL_REACHED: Ended("converged", "the cost no longer changes"),
    nlopt.XTOL_REACHED: Ended("converged", "the step is within its tolerance"),
    nlopt.STOPVAL_REACHED: Ended("optimal", "the cost cannot be lower"),
}


OWN = Ended("library", "the library's own rule stopped the search")


_streams = threading.local()
"""`lock` is held by the search of this thread that draws from NLopt's random stream, which belongs to the thread."""


def optimised(space: Space, build: Callable[[], Any], random: bool = True) -> Search:
    """Run the optimiser returned by `build` on the unit cube until it ends; reports its lowest point.

    random: it draws from NLopt's random stream. A second one in this thread gets a thread of its own, which costs 15 us
    more for each point.
    """
    seed = int(space.random.integers(1, 2**31)) if random else None
    stream = _streams.__dict__.setdefault("lock", threading.Lock())
    alone = random and stream.acquire(blocking=False)
    called = called_back_in_thread if random and not alone else called_back
    try:
        with Reported(space) as best:
            centre = np.full(space.dimension, 0.5)
            best.text = yield from called(lambda ask: _run(ask, centre, build, best, seed))
        return best.text
    finally:
        if alone:
            stream.release()


def local(start: Floats, cost: float, build: Callable[[], Any]) -> Generator[Floats, Batch, End]:
    """Run an optimiser without random numbers from a start (n,) of known cost."""
    best = Lowest()
    best.point, best.cost = start, cost
    text = yield from called_back(lambda ask: _run(ask, start, build, best, None))
    return End(best.point, best.cost, best.evaluations, text)


def _run(ask: Ask, start: Floats, build: Callable[[], Any], best: Lowest, seed: int | None) -> str:
    highest = -np.inf if best.point is None else best.cost
    known, begun = best.cost, False

    def cost(x: Floats, gradient: Floats) -> float:
        nonlocal highest, begun
        point = x.clip(0.0, 1.0)
        if not math.isfinite(point.dot(point)):  # a model degraded by rounding may request NaN: use the centre instead
            point = np.where(np.isfinite(x), point, 0.5)
        if known < np.inf and best.evaluations == 0 and (point == start).all():
            return known
        first, begun = not begun, True
        try:
            batch = ask(point[None, :].copy())
        except Abandoned:
            if first:  # where it raises, NLopt's orig_direct crashes the process: its next evaluation raises again
                return 0.0
            raise
        best.evaluations += 1
        value = float(batch.costs[0, 0]) if batch.status[0] == OK else np.inf
        if not math.isfinite(value):
            return highest if math.isfinite(highest) else 0.0
        if value < best.cost:
            best.cost, best.point = value, point
        highest = max(highest, value)
        return value

    if seed is not None:
        nlopt.srand(seed)
    optimiser = build()
    optimiser.set_min_objective(cost)
    optimiser.set_lower_bounds(np.zeros(len(start)))
    optimiser.set_upper_bounds(np.ones(len(start)))
    try:
        optimiser.optimize(start)
    except (nlopt.RoundoffLimited, nlopt.roundoff_limited):
        return Ended("rounding", "rounding stopped the search")
    except (nlopt.runtime_error, RuntimeError, MemoryError, ValueError) as error:
        return Ended("library", "the library stopped the search: {error}", error=str(error) or type(error).__name__)
    return STOPPED.get(optimiser.last_optimize_result(), OWN)
