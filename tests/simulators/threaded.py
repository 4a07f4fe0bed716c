"""Two basins in slots that end in any order: a thread completes one of the running evaluations, chosen at random."""

from __future__ import annotations

import queue
import random
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager

import numpy as np

from campaigns.asked.load import load_document
from tests.simulators import package, two_basins
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import Evaluated, Floats
from worker.engine.systems.simulators.declared.simulator import Opening

OPENING = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")


class Threaded(two_basins.TwoBasins):
    """Evaluations end in a random order; `most` counts how many ran at the same time, `begun` how many were started."""

    slots = 3

    def __init__(self, seed: int) -> None:
        super().__init__(two_basins.ENTRY, OPENING)
        self.most = self.begun = 0
        self._random = random.Random(seed)
        self._given: queue.SimpleQueue[tuple[Future[Evaluated], Floats] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def submit(self, vector: Floats, seed: int | None = None) -> Future[Evaluated]:
        future: Future[Evaluated] = Future()
        self.begun += 1
        self._given.put((future, vector))
        return future

    def close(self) -> None:
        self._given.put(None)
        self._thread.join()

    def _work(self) -> None:
        running: list[tuple[Future[Evaluated], Floats]] = []
        while True:
            while not running or not self._given.empty():
                given = self._given.get()
                if given is None:
                    return
                running.append(given)
            self.most = max(self.most, len(running))
            future, vector = running.pop(self._random.randrange(len(running)))
            batch, reasons = self.evaluate(vector[None, :])
            future.set_result(Evaluated(batch.costs[0], int(batch.status[0]), reasons.get(0, "")))


@contextmanager
def threaded(seed: int) -> Iterator[Problem]:
    """The problem of the two basins on such a system."""
    system = Threaded(seed)
    try:
        yield Problem(load_document(package.campaign()), system)
    finally:
        system.close()


def grid(count: int) -> Floats:
    """Points (count, 2), of which the last ones have no value."""
    return np.column_stack([np.linspace(0.1, 0.9, count), np.linspace(0.0, 1.0, count)])
