"""The interface between a search and the simulation: many points in, their batch out.

`InProcess` evaluates on threads if the system allows concurrent calls (the compiled loop releases the GIL). The bits of
an evaluation depend only on its point, never on the batch, the thread or the load.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Protocol

import numpy as np

from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.systems import optional
from worker.engine.systems.base import Floats, Seeds
from worker.engine.systems.threads import usual_threads


class Evaluate(Protocol):
    """Evaluates points (m, n) of the unit cube: the batch, and the reasons by row of failed or excluded evaluations.

    By default under the realisations that the campaign states; with seeds (m,), each point under its own realisation.
    """

    def __call__(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, dict[int, str]]: ...


class InProcess:
    """Evaluates in this process on `threads` threads, each of which gets whole blocks."""

    def __init__(self, problem: Problem, threads: int | None = None) -> None:
        self.problem = problem
        self.threads = (threads or usual_threads()) if optional.settings(problem.system).lanes else 1
        self._pool = ThreadPoolExecutor(self.threads, thread_name_prefix="simulate") if self.threads > 1 else None

    def __call__(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, dict[int, str]]:
        block = optional.settings(self.problem.system).lanes or 1
        if self._pool is None or len(points) <= block:
            return self.problem.evaluate(points, seeds)
        blocks = -(-len(points) // block)
        size = -(-blocks // self.threads) * block
        rows = [slice(i, i + size) for i in range(0, len(points), size)]
        drawn = [None if seeds is None else seeds[r] for r in rows]
        parts = list(self._pool.map(self.problem.evaluate, [points[r] for r in rows], drawn))
        reasons = {i * size + row: why for i, (_, whys) in enumerate(parts) for row, why in whys.items()}
        costs = np.concatenate([batch.costs for batch, _ in parts])
        return Batch(costs, np.concatenate([batch.status for batch, _ in parts])), reasons

    def close(self) -> None:
        """Stop the threads."""
        if self._pool is not None:
            self._pool.shutdown()
