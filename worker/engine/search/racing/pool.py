"""The searchers of contrast racing: their starts, incumbents and rungs."""

from __future__ import annotations

from bisect import insort

import numpy as np

from worker.engine.search.base import Floats
from worker.engine.search.racing import cma as racing_cma
from worker.engine.search.racing import moves as racing_moves
from worker.engine.search.racing.state import BEGIN, Ints, grown, receive, requested, room

NEAR = 0.03
"""Incumbents closer than this (largest difference of a parameter) count as one valley until tested."""


class Pool:
    """All searchers started so far, by index."""

    def __init__(self, dimension: int, random: np.random.Generator) -> None:
        self.state = room(64, dimension)
        self.random = random
        self.count = 0
        self.rung: Ints = np.zeros(64, dtype=np.int64)
        self.starts: list[Floats] = []

    @property
    def cost(self) -> Floats:
        """Costs of the incumbents (count,)."""
        return self.state.cost[: self.count]

    @property
    def best(self) -> Floats:
        """The incumbents (count, n)."""
        return self.state.best[: self.count]

    def begin(self, point: Floats, cost: float, start: Floats, kind: int, first: float, after: float, rung: int) -> int:
        """Start a searcher at a point of known cost; `start`: its origin; `after`: initial deviation of its CMA-ES."""
        t = self.count
        if t == len(self.rung):
            self.state = grown(self.state)
            self.rung = np.concatenate([self.rung, np.zeros_like(self.rung)])
        self.count += 1
        self.starts.append(start)
        self.rung[t] = rung
        s = self.state
        s.kind[t], s.stage[t] = kind, BEGIN
        s.best[t], s.cost[t] = point, cost
        s.begin[t] = first, after
        s.step[t] = first
        self._advance(np.array([t]))
        return t

    def requested(self, rows: Ints) -> Floats:
        """The points that these searchers request."""
        return requested(self.state, rows)

    def tell(self, rows: Ints, values: Floats) -> None:
        """Pass the values of those points, infinity if there is no value."""
        receive(self.state, rows, values)
        self._advance(rows)

    def _advance(self, rows: Ints) -> None:
        racing_moves.tell(self.state, rows, self.random)
        racing_cma.tell(self.state, rows, self.random)

    def apart(self, most: int) -> list[int]:
        """The best incumbents that are not close to each other, best first."""
        chosen: list[int] = []
        for t in np.argsort(self.cost, kind="stable"):
            if len(chosen) == most:
                break
            if all(np.abs(self.best[t] - self.best[u]).max() > NEAR for u in chosen):
                chosen.append(int(t))
        return chosen

    def follows(self, t: int) -> bool:
        """Whether searcher t is close to a better one on a higher rung."""
        above = (self.rung[: self.count] > self.rung[t]) & (self.cost < self.cost[t])
        return bool((np.abs(self.best[above] - self.best[t]).max(axis=1) < NEAR).any()) if above.any() else False


class Rung:
    """The searchers that have reached a given number of evaluations, by their cost at that time."""

    def __init__(self) -> None:
        self.costs: list[float] = []
        self.standing: list[tuple[float, int]] = []
        self.promoted = 0

    def add(self, t: int, cost: float) -> None:
        """Add searcher t."""
        insort(self.costs, cost)
        insort(self.standing, (cost, t))

    def next(self, eta: int, pool: Pool) -> int | None:
        """The next searcher to promote: the best one left among the best 1/eta of all; None if the quota is used up.

        Searchers close to a better one on a higher rung are dropped.
        """
        quota = len(self.costs) // eta
        if quota <= self.promoted:
            return None
        while self.standing and self.standing[0][0] <= self.costs[quota - 1]:
            t = self.standing.pop(0)[1]
            if not pool.follows(t):
                self.promoted += 1
                return t
        return None
