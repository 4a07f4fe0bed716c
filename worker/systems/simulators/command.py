"""A simulator that is any program: processes in slots, which read parameters and return results as JSON.

Whatever an evaluation does is a status with a reason: a crash, a hang, a missing or non-finite result. Start reading at
`CommandSimulator.evaluate`.
"""

from __future__ import annotations

import math
import sys
import tempfile
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from campaigns.results.base import FAILED, OK, TIMEOUT
from worker.catalogue.descriptor import Described
from worker.catalogue.simulator import Opening
from worker.search.base import Batch
from worker.systems.base import Floats, Reasons, Seeds
from worker.systems.simulators.simulated import Simulated
from worker.systems.simulators.slots import files
from worker.systems.simulators.slots.outcome import Limits, Outcome
from worker.systems.simulators.slots.pool import SlotPool
from worker.systems.simulators.slots.program import Program
from worker.systems.threads import usual_threads


class CommandSimulator(Simulated):
    """Evaluates a described program; `fresh`: every evaluation in a process of its own; halvings of its step, if it
    declares one."""

    def __init__(self, described: Described, opening: Opening, fresh: bool = False, halvings: int = 0) -> None:
        super().__init__(described.entry, opening)
        declared = described.descriptor
        if declared.step is not None:
            self.step = declared.parameters[declared.step].nominal / 2**halvings
        self._halvings = halvings
        self.described = described
        self._fresh = fresh
        self._result = self.results[0]
        self._pool: SlotPool | None = None
        self._work: tempfile.TemporaryDirectory[str] | None = None

    def fresh(self) -> CommandSimulator:
        return CommandSimulator(self.described, self.opening, True, self._halvings)

    def halved(self) -> CommandSimulator | None:
        if self.step is None:
            return None
        return CommandSimulator(self.described, self.opening, True, self._halvings + 1)

    @cached_property
    def digest(self) -> str:
        """Over all files in the folder of the descriptor, when the simulator was opened."""
        return self.described.digest

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        names = [p.path.removeprefix("simulator.") for p in self.parameters]
        pool = self._opened()
        step = {} if self.step is None else {str(self.described.descriptor.step): self.step}
        requests = [{"parameters": dict(zip(names, v[: len(names)].tolist(), strict=True)) | step} for v in vectors]
        outcomes = pool.evaluate(requests)
        if outcomes:
            self.cost = sum(o.duration for o in outcomes) / len(outcomes) / pool.size
        costs = np.full((len(vectors), 1), np.nan)
        status = np.zeros(len(vectors), dtype=np.uint8)
        reasons: Reasons = {}
        for k, outcome in enumerate(outcomes):
            value, reason = self._read(outcome)
            if reason:
                status[k], reasons[k] = TIMEOUT if outcome.kind == "timeout" else FAILED, reason
            else:
                status[k], costs[k, 0] = OK, value if self._result.worse == "low" else -value
        return Batch(costs, status), reasons

    def close(self) -> None:
        """Kill its processes; they start again with the next evaluation."""
        if self._pool is not None:
            self._pool.close()
            self._pool = None
        if self._work is not None:
            self._work.cleanup()
            self._work = None

    def _opened(self) -> SlotPool:
        if self._pool is None:
            d = self.described.descriptor
            limits = Limits(d.timeout, d.start, d.memory, recycle=1 if self._fresh else d.recycle)
            slots = 1 if self._fresh else d.slots or usual_threads()
            self._work = tempfile.TemporaryDirectory(prefix=f"clearance-{d.name}-", ignore_cleanup_errors=True)
            self._pool = SlotPool(self._program(Path(self._work.name)), slots, limits)
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
