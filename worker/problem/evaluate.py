"""Many points in, their batch out: the seam between a search and whatever simulates.

`InProcess` evaluates on threads where the system takes several calls at once (the compiled loop releases the GIL). An
evaluation's bits depend on its point alone, never on the batch, the thread or the machine's load. Start reading at
`Evaluate`.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Protocol

import numpy as np

from worker.problem.problem import Problem
from worker.search.base import Batch
from worker.systems.base import Floats, Seeds
from worker.systems.threads import usual_threads


class Evaluate(Protocol):
    """Evaluates points (m, n) of the unit cube: the batch, and the reasons by row of those that are not ok.

    Under the realisations that the campaign states, or each point under one of its own: seeds (m,).
    """

    def __call__(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, dict[int, str]]: ...


class InProcess:
    """Evaluates in this process, on `threads` threads; each takes whole blocks."""

    def __init__(self, problem: Problem, threads: int | None = None) -> None:
        self.problem = problem
        self.threads = (threads or usual_threads()) if problem.system.block else 1
        self._pool = ThreadPoolExecutor(self.threads, thread_name_prefix="fly") if self.threads > 1 else None

    def __call__(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, dict[int, str]]:
        block = self.problem.system.block
        if self._pool is None or len(points) <= block:
            return self.problem.fly(points, seeds)
        blocks = -(-len(points) // block)
        share = -(-blocks // self.threads) * block
        rows = [slice(i, i + share) for i in range(0, len(points), share)]
        drawn = [None if seeds is None else seeds[r] for r in rows]
        flown = list(self._pool.map(self.problem.fly, [points[r] for r in rows], drawn))
        reasons = {i * share + row: why for i, (_, said) in enumerate(flown) for row, why in said.items()}
        costs = np.concatenate([batch.costs for batch, _ in flown])
        return Batch(costs, np.concatenate([batch.status for batch, _ in flown])), reasons

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()
