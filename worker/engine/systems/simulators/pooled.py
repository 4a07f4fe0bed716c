"""The base of simulators that evaluate in slots: processes that start with the first evaluation and end with `close`.

The slots are here or, if this process has an evaluator, on the nodes of a cluster. A derived class gives the program,
the limits and the number of its slots, and reads an outcome. Start reading at `Pooled.submit`.
"""

from __future__ import annotations

import threading
from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from worker.engine.search.base import Batch
from worker.engine.systems.base import Evaluated, Floats, NoResult, Reasons, Seeds, Trace
from worker.engine.systems.simulators import ours, traced
from worker.engine.systems.simulators.cluster.address import Evaluator
from worker.engine.systems.simulators.cluster.work import WORK, Files
from worker.engine.systems.simulators.simulated import Simulated
from worker.engine.systems.simulators.slots.outcome import Limits, Outcome
from worker.engine.systems.simulators.slots.places import Place
from worker.engine.systems.simulators.slots.pool import SlotPool
from worker.engine.systems.simulators.slots.program import Program

if TYPE_CHECKING:
    from worker.engine.systems.simulators.cluster.pool import DaskPool

WITHOUT_VALUE = {"timeout": TIMEOUT, "excluded": EXCLUDED}
"""The status of an evaluation without a value by the kind of its outcome; of all others it is failed."""

One = TypeVar("One")


class Pooled(Simulated):
    """A simulator of which each evaluation is one request to a slot of this machine or of a node."""

    evaluator: Evaluator | None = None
    _pool: SlotPool | DaskPool | None = None
    _work: Place | None = None
    most_slots: int | None = None
    """Fewer processes side by side than `slots`, set before the first evaluation."""
    most_seconds: float | None = None
    """A shorter time limit of an evaluation [s], set likewise."""

    def _spread_over(self, evaluator: Evaluator | None) -> None:
        """Evaluate there; None: here."""
        self.evaluator = evaluator
        self.elsewhere = "dask.distributed" if evaluator and evaluator.scheduler else ""

    @property
    @abstractmethod
    def _slots_here(self) -> int:
        """Processes side by side on this machine."""

    @property
    @abstractmethod
    def _files(self) -> Files:
        """What every node must have as it is here."""

    @property
    def slots(self) -> int:
        return self._slots_here if self.evaluator is None else self._opened().size

    @property
    def recycle(self) -> int:
        return self._limits.recycle

    @property
    def longest(self) -> float:
        """Time that one evaluation may take [s], with the start of a process for it and the patience for a cluster."""
        waiting = 0.0 if self.evaluator is None else self.evaluator.patience
        return self._limits.start + self._limits.timeout + waiting

    @property
    @abstractmethod
    def _limits(self) -> Limits: ...

    @abstractmethod
    def _program(self, work: Path) -> Program:
        """What a slot runs; each may use a folder below `work`, which is removed at the end."""

    @abstractmethod
    def _read(self, outcome: Outcome) -> tuple[float, str]:
        """The result that decides, or NaN and why there is none."""

    def _request(self, vector: Floats) -> dict[str, float]:
        """The parameters of one vector by the simulator's own names."""
        names = [p.path.removeprefix("simulator.") for p in self.parameters]
        return dict(zip(names, vector[: len(names)].tolist(), strict=True))

    def changed(self, now: bool = False, everywhere: bool = False) -> str:
        found = super().changed(now) or ours.changed(now)
        return found or (self._pool.changed() if everywhere and self._pool is not None else "")

    def warm(self) -> None:
        """Connect to the evaluator."""
        if self.evaluator is not None:
            self._opened()

    def submit(self, vector: Floats, seed: int | None = None) -> Future[Evaluated]:
        if changed := self.changed():
            ended: Future[Evaluated] = Future()
            ended.set_result(Evaluated(np.array([np.nan]), FAILED, changed))
            return ended
        return gathered([self._opened().submit({"parameters": self._request(vector)})], self._evaluated)

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        return batch_of([future.result() for future in [self.submit(vector) for vector in vectors]])

    def trace(self, name: str, values: Mapping[str, float], seed: int | None = None) -> Trace | None:
        if not self.columns:
            return None
        vector = self._vector(values)
        if changed := self.changed():
            raise NoResult(changed, timeout=False)
        outcome = self._opened().submit({"parameters": self._request(vector), "trace": True}).result()
        value, reason = self._read(outcome)
        if reason:
            raise NoResult(reason, outcome.kind == "timeout")
        head = traced.head(self.results[0], value, self._by_path(vector), self.scene)
        return traced.read(name, self.columns, outcome.answer, head)

    def close(self) -> None:
        """Kill its processes; they start again with the next evaluation."""
        if self._pool is not None:
            self._pool.close()
            self._pool = None
        if self._work is not None:
            self._work.close()
            self._work = None

    def _opened(self) -> SlotPool | DaskPool:
        if self._pool is None and self.evaluator is not None:
            from worker.engine.systems.simulators.cluster.pool import DaskPool

            self._pool = DaskPool(self.evaluator, self._program(Path(WORK)), self._limits, self._files)
        elif self._pool is None:
            self._work = Place(self.entry.name)
            slots = min(self._slots_here, self.most_slots or self._slots_here)
            limits = self._limits
            if self.most_seconds is not None:
                limits = replace(limits, timeout=min(limits.timeout, self.most_seconds))
            self._pool = SlotPool(self._program(self._work.path), slots, limits)
        return self._pool

    def _evaluated(self, outcomes: Sequence[Outcome]) -> Evaluated:
        (outcome,) = outcomes
        value, reason = self._read(outcome)
        if reason:
            return Evaluated(np.array([np.nan]), WITHOUT_VALUE.get(outcome.kind, FAILED), reason)
        return Evaluated(np.array([value if self.results[0].worse == "low" else -value]), OK, "")


def gathered(futures: Sequence[Future[One]], read: Callable[[Sequence[One]], Evaluated]) -> Future[Evaluated]:
    """The evaluation that the results of these futures, all of them, are read as."""
    found: Future[Evaluated] = Future()
    left, counting = len(futures), threading.Lock()

    def done(_: Future[One]) -> None:
        nonlocal left
        with counting:
            left -= 1
            last = left == 0
        if last:
            try:
                found.set_result(read([future.result() for future in futures]))
            except Exception as error:  # reaches whoever waits for it, not the thread that ended the evaluation
                found.set_exception(error)

    for future in futures:
        future.add_done_callback(done)
    return found


def batch_of(found: Sequence[Evaluated]) -> tuple[Batch, Reasons]:
    """The evaluations as a batch."""
    costs = np.array([one.costs for one in found]).reshape(len(found), -1 if found else 1)
    reasons = {k: one.reason for k, one in enumerate(found) if one.reason}
    return Batch(costs, np.array([one.status for one in found], dtype=np.uint8)), reasons
