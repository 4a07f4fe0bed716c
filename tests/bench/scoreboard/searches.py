"""One search, seen from outside: the values of its evaluations in their order, for own methods and peers alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from campaigns.results.base import FAILED
from clearance.testing.searching import Function, batch, plain, space
from worker.engine.search.base import Floats, Method

PENALTY = 1e9
"""The value of a failed evaluation for a peer until one succeeded; later, the highest value so far."""


class Trace(NamedTuple):
    """Points (m, n) and values (m,) of distinct evaluations, NaN where failed, and the search's own time [s].

    error: what a peer raised, which ended its search.
    """

    points: Floats
    values: Floats
    own: float
    error: str = ""

    def reached(self, target: float) -> int | None:
        """The evaluations until one was at or below the target; None if none was."""
        found = np.flatnonzero(self.values <= target)
        return int(found[0]) + 1 if len(found) else None

    def lowest(self, evaluations: int) -> float:
        """The lowest value of the first so many evaluations; infinity if none succeeded."""
        return float(np.nanmin(np.append(self.values[:evaluations], np.inf)))


class Spent(Exception):
    """The budget of a peer is used up, or its target reached."""


class Evaluations:
    """The function as a peer calls it, one point at a time, until the budget is used up."""

    def __init__(self, function: Function, budget: int, stop: float = -np.inf) -> None:
        self.function, self.budget, self.stop = function, budget, stop
        self.points: list[Floats] = []
        self.values: list[float] = []
        self.seconds = 0.0
        self.highest = -np.inf

    def __call__(self, point: Floats, *_: object) -> float:
        """The value at this point; a number also where the evaluation fails, because libraries know no failure."""
        if len(self.values) >= self.budget or (self.values and self.values[-1] <= self.stop):
            raise Spent
        began = time.process_time()
        inside = np.clip(np.asarray(point, dtype=float), 0.0, 1.0)
        value = float(self.function(inside[None, :])[0])
        self.seconds += time.process_time() - began
        self.points.append(inside)
        self.values.append(value)
        if not np.isfinite(value):
            return self.highest if np.isfinite(self.highest) else PENALTY
        self.highest = max(self.highest, value)
        return value


Peer = Callable[[Evaluations, int, int, int], None]
"""Minimises over the unit cube, given the evaluations, dimension, budget and seed; ends by itself or by `Spent`."""


def own_trace(
    method: Method,
    function: Function,
    dimension: int,
    budget: int,
    seed: int,
    options: Mapping[str, object],
    stop: float = -np.inf,
    status: int = FAILED,
) -> Trace:
    """A method of ours, until its budget ends or a value is at or below `stop`.

    A point that it may request twice counts once, as in a run. Evaluations without a value have the status.
    """
    search = plain(method.search(space(dimension, budget, seed=seed), method.options(**options)))
    points, values = [np.empty((0, dimension))], [np.empty(0)]
    known: dict[bytes, float] = {}
    used, own, answer = 0, 0.0, None
    try:
        while used < budget:
            began = time.process_time()
            try:
                request = search.send(answer)  # type: ignore[arg-type]
            finally:
                own += time.process_time() - began
            found = function(request)
            fresh = _fresh(request, found, known) if method.repeats else np.ones(len(request), dtype=bool)
            points.append(request[fresh])
            values.append(found[fresh])
            used += int(fresh.sum())
            if (found <= stop).any():
                break
            answer = batch(found, status)
    except StopIteration:
        pass
    finally:
        search.close()
    return Trace(np.concatenate(points)[:budget], np.concatenate(values)[:budget], own)


def _fresh(request: Floats, found: Floats, known: dict[bytes, float]) -> Floats:
    """Which of these points were not evaluated before."""
    before = len(known)
    fresh = np.empty(len(request), dtype=bool)
    for i, (point, value) in enumerate(zip(request, found, strict=True)):
        known.setdefault(point.tobytes(), float(value))
        fresh[i], before = len(known) > before, len(known)
    return fresh


def peer_trace(peer: Peer, function: Function, dimension: int, budget: int, seed: int, stop: float = -np.inf) -> Trace:
    """A peer, as a user of its library calls it; whatever it raises ends it, and is stated."""
    evaluations, error = Evaluations(function, budget, stop), ""
    began = time.process_time()
    try:
        peer(evaluations, dimension, budget, seed)
    except Spent:
        pass
    except Exception as raised:
        error = f"{type(raised).__name__}: {raised}"
    own = time.process_time() - began - evaluations.seconds
    return Trace(np.array(evaluations.points).reshape(-1, dimension), np.array(evaluations.values), own, error)
