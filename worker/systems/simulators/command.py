"""A simulator that is any program: processes in slots, which read parameters and return results as JSON.

Whatever an evaluation does is a status with a reason: a crash, a hang, a missing or non-finite result. Start reading at
`CommandSimulator.evaluate`.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import Future
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from campaigns.results.base import FAILED, OK, TIMEOUT
from worker.catalogue.descriptor import Described
from worker.catalogue.simulator import Opening
from worker.search.base import Batch
from worker.systems.base import Evaluated, Floats, Reasons, Seeds
from worker.systems.simulators.cluster.address import chosen
from worker.systems.simulators.simulated import Simulated
from worker.systems.simulators.slots import files
from worker.systems.simulators.slots.outcome import Limits, Outcome
from worker.systems.simulators.slots.pool import SlotPool
from worker.systems.simulators.slots.program import Program
from worker.systems.threads import usual_threads

if TYPE_CHECKING:
    from worker.systems.simulators.cluster.pool import DaskPool


class CommandSimulator(Simulated):
    """Evaluates a described program, here or on the evaluator of this process; `fresh`: every evaluation in a process
    of its own.
    """

    def __init__(self, described: Described, opening: Opening, fresh: bool = False) -> None:
        super().__init__(described.entry, opening)
        self.described = described
        self._fresh = fresh
        self._result = self.results[0]
        self.evaluator = chosen()
        self.elsewhere = "dask.distributed" if self.evaluator and self.evaluator.scheduler else ""
        self._pool: SlotPool | DaskPool | None = None
        self._work: tempfile.TemporaryDirectory[str] | None = None

    def fresh(self) -> CommandSimulator:
        return CommandSimulator(self.described, self.opening, fresh=True)

    @cached_property
    def digest(self) -> str:
        """Over all files in the folder of the descriptor, when the simulator was opened."""
        return self.described.digest

    @property
    def slots(self) -> int:  # type: ignore[override]
        if self._fresh:
            return 1
        return self.described.descriptor.slots or usual_threads() if self.evaluator is None else self._opened().size

    def submit(self, vector: Floats, seed: int | None = None) -> Future[Evaluated]:
        names = [p.path.removeprefix("simulator.") for p in self.parameters]
        request = {"parameters": dict(zip(names, vector[: len(names)].tolist(), strict=True))}
        return then(self._opened().submit(request), self._evaluated)

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        found = [future.result() for future in [self.submit(vector) for vector in vectors]]
        costs = np.array([one.costs for one in found]).reshape(len(found), 1)
        reasons = {k: one.reason for k, one in enumerate(found) if one.reason}
        return Batch(costs, np.array([one.status for one in found], dtype=np.uint8)), reasons

    def _evaluated(self, outcome: Outcome) -> Evaluated:
        value, reason = self._read(outcome)
        if reason:
            return Evaluated(np.array([np.nan]), TIMEOUT if outcome.kind == "timeout" else FAILED, reason)
        return Evaluated(np.array([value if self._result.worse == "low" else -value]), OK, "")

    def warm(self) -> None:
        """Connect to the evaluator."""
        if self.evaluator is not None:
            self._opened()

    def close(self) -> None:
        """Kill its processes; they start again with the next evaluation."""
        if self._pool is not None:
            self._pool.close()
            self._pool = None
        if self._work is not None:
            self._work.cleanup()
            self._work = None

    def _opened(self) -> SlotPool | DaskPool:
        if self._pool is None:
            d = self.described.descriptor
            limits = Limits(d.timeout, d.start, d.memory, recycle=1 if self._fresh else d.recycle)
            if self.evaluator is not None:
                from worker.systems.simulators.cluster.pool import WORK, DaskPool

                program, folder = self._program(Path(WORK)), self.described.folder
                self._pool = DaskPool(self.evaluator, program, limits, folder, self.digest)
                return self._pool
            self._work = tempfile.TemporaryDirectory(prefix=f"clearance-{d.name}-", ignore_cleanup_errors=True)
            self._pool = SlotPool(self._program(Path(self._work.name)), self.slots, limits)
        return self._pool

    def _program(self, work: Path) -> Program:
        d, folder = self.described.descriptor, str(work / "{slot}")
        command = [word.replace("{folder}", str(self.described.folder)) for word in d.command]
        if d.protocol == "lines":
            return Program(command, "lines", d.environment, folder)
        child = [sys.executable, str(files.CHILD), f"{files.__file__}:evaluate"]
        return Program(child, "framed", {**d.environment, files.COMMAND: files.packed(command)}, folder)

    def _read(self, outcome: Outcome) -> tuple[float, str]:
        """The result that decides, or why there is none."""
        if outcome.kind != "ok":
            return math.nan, outcome.sentence
        return number(_results(outcome.answer), self._result.name)


def then(future: Future[Outcome], read: Callable[[Outcome], Evaluated]) -> Future[Evaluated]:
    """The evaluation that an outcome will be read as."""
    read_later: Future[Evaluated] = Future()

    def done(ended: Future[Outcome]) -> None:
        try:
            read_later.set_result(read(ended.result()))
        except Exception as error:  # reaches whoever waits for it, not the thread that ended the evaluation
            read_later.set_exception(error)

    future.add_done_callback(done)
    return read_later


def _results(answer: Any) -> Any:
    return answer.get("results") if isinstance(answer, dict) else None


def number(results: Any, name: str) -> tuple[float, str]:
    """One result as a finite number, or what is wrong with it."""
    if not isinstance(results, dict):
        return math.nan, f"its answer has no object `results`, in which {name} is expected"
    if name not in results:
        given = ", ".join(map(str, results)) or "none"
        return math.nan, f"its results lack {name}; it returned {given}"
    value = results[name]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return math.nan, f"its result {name} is {value!r:.60}, not a number"
    try:
        value = float(value)
    except OverflowError:
        value = math.inf
    return (value, "") if math.isfinite(value) else (math.nan, f"its result {name} is {value}, not a finite number")
