"""The searchers of contrast racing: their starts, their results so far, and their rungs in the race.

Start reading at `Pool.begin`; the search steps are in `moves` and `cma`.
"""

from __future__ import annotations

from bisect import insort

import numpy as np

from worker.search.base import Floats
from worker.search.racing import cma as racing_cma
from worker.search.racing import moves as racing_moves
from worker.search.racing.state import BEGIN, Ints, grown, receive, room, wanted

NEAR = 0.03
"""Incumbents closer than this (largest difference of a parameter) count as one valley until tested."""


class Pool:
    """All searchers begun so far, by number."""

    def __init__(self, dimension: int, random: np.random.Generator) -> None:
        self.state = room(64, dimension)
        self.random = random
        self.count = 0
        self.rung: Ints = np.zeros(64, dtype=np.int64)
        self.starts: list[Floats] = []

    @property
    def cost(self) -> Floats:
        """(count,) of the incumbents."""
        return self.state.cost[: self.count]

    @property
    def best(self) -> Floats:
        """(count, n) the incumbents."""
        return self.state.best[: self.count]

    def begin(self, point: Floats, cost: float, start: Floats, kind: int, first: float, after: float, rung: int) -> int:
        """A new searcher from a point of known cost; it comes from `start`; `after`: the deviation of its CMA-ES."""
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
        self._go_on(np.array([t]))
        return t

    def wanted(self, rows: Ints) -> Floats:
        """The points that these searchers request."""
        return wanted(self.state, rows)

    def tell(self, rows: Ints, values: Floats) -> None:
        """The values of those points, infinity where there is none."""
        receive(self.state, rows, values)
        self._go_on(rows)

    def _go_on(self, rows: Ints) -> None:
        racing_moves.tell(self.state, rows, self.random)
        racing_cma.tell(self.state, rows, self.random)

    def apart(self, most: int) -> list[int]:
        """The best incumbents that are not near one another, the best first."""
        chosen: list[int] = []
        for t in np.argsort(self.cost, kind="stable"):
            if len(chosen) == most:
                break
            if all(np.abs(self.best[t] - self.best[u]).max() > NEAR for u in chosen):
                chosen.append(int(t))
        return chosen

    def follows(self, t: int) -> bool:
        """Whether it is near a better one on a higher rung."""
        above = (self.rung[: self.count] > self.rung[t]) & (self.cost < self.cost[t])
        return bool((np.abs(self.best[above] - self.best[t]).max(axis=1) < NEAR).any()) if above.any() else False


class Rung:
    """Those who have reached one number of evaluations, by their cost then."""

    def __init__(self) -> None:
        self.costs: list[float] = []
        self.standing: list[tuple[float, int]] = []
        self.promoted = 0

    def reach(self, t: int, cost: float) -> None:
        """Searcher t has come."""
        insort(self.costs, cost)
        insort(self.standing, (cost, t))

    def next(self, eta: int, pool: Pool) -> int | None:
        """The next to go up: among the best 1/eta of all who came, the best that has not gone; None if it is too early.

        One that follows a better one is dropped on the way.
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
