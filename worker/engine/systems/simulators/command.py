"""A simulator that is any program: processes in slots, which read parameters and return results as JSON.

Whatever an evaluation does is a status with a reason: a crash, a hang, a missing or non-finite result.
"""

from __future__ import annotations

import json
import math
import sys
from functools import cached_property
from pathlib import Path
from typing import Any

from worker.engine.systems.base import Floats
from worker.engine.systems.simulators.cluster.address import chosen
from worker.engine.systems.simulators.cluster.work import Files
from worker.engine.systems.simulators.declared.described import Described
from worker.engine.systems.simulators.declared.descriptor import DescribedProgram
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.unchanged import Unchanged
from worker.engine.systems.simulators.pooled import Pooled
from worker.engine.systems.simulators.slots import files
from worker.engine.systems.simulators.slots.outcome import Limits, Outcome
from worker.engine.systems.simulators.slots.program import Program
from worker.engine.systems.threads import usual_threads


class CommandSimulator(Pooled):
    """Evaluates a described program; `fresh`: every evaluation in a process of its own; halvings of its step, if it
    declares one."""

    def __init__(
        self, described: Described, opening: Opening, fresh: bool = False, halvings: int = 0,
        unchanged: Unchanged | None = None,
    ) -> None:  # fmt: skip
        super().__init__(described.entry, opening)
        self.unchanged = unchanged or Unchanged(described.covered)
        if isinstance(described, DescribedProgram) and described.descriptor.step is not None:
            self.step = described.descriptor.parameters[described.descriptor.step].nominal / 2**halvings
        self._halvings = halvings
        self.described = described
        self.columns, self.scene = described.columns, described.drawn
        self._fresh = fresh
        self.campaign_command = described.campaign_command
        self._spread_over(None if self.campaign_command else chosen())

    def fresh(self) -> CommandSimulator:
        return CommandSimulator(self.described, self.opening, True, self._halvings, self.unchanged)

    def halved(self) -> CommandSimulator | None:
        if self.step is None:
            return None
        return CommandSimulator(self.described, self.opening, True, self._halvings + 1, self.unchanged)

    @cached_property
    def digest(self) -> str:
        """Over all files in the folder of the descriptor, when the simulator was opened."""
        return self.described.digest

    @property
    def _slots_here(self) -> int:
        return self.described.descriptor.slots or usual_threads()

    @property
    def _files(self) -> Files:
        return Files(str(self.described.folder), self.digest)

    @property
    def _limits(self) -> Limits:
        d = self.described.descriptor
        return Limits(d.timeout, d.start, d.memory, recycle=1 if self._fresh else self._recycle)

    @property
    def _recycle(self) -> int:
        return self.described.descriptor.recycle

    def _request(self, vector: Floats) -> dict[str, float]:
        parameters = super()._request(vector)
        if self.step is not None and isinstance(self.described, DescribedProgram):
            parameters[str(self.described.descriptor.step)] = self.step
        return parameters

    def _program(self, work: Path) -> Program:
        assert isinstance(self.described, DescribedProgram)
        d, folder = self.described.descriptor, str(work / "{slot}")
        words = [word.replace("{python}", sys.executable) for word in d.command]
        command = [word.replace("{folder}", str(self.described.folder)) for word in words]
        if d.protocol == "lines":
            return Program(command, "lines", d.environment, folder, d.ids)
        child = [sys.executable, str(files.CHILD), f"{files.__file__}:evaluate"]
        return Program(child, "framed", {**d.environment, files.COMMAND: json.dumps(command)}, folder)

    def _read(self, outcome: Outcome) -> tuple[float, str]:
        if outcome.kind != "ok":
            return math.nan, outcome.sentence
        return number(_results(outcome.answer), self.results[0].name)


def _results(answer: Any) -> Any:
    return answer.get("results") if isinstance(answer, dict) else None


def number(results: Any, name: str) -> tuple[float, str]:
    """One result as a finite number, or what is wrong with it."""
    if not isinstance(results, dict):
        return math.nan, f"its answer has no object `results`, in which {name} is expected"
    if name not in results:
        listed = ", ".join(map(str, results)) or "none"
        return math.nan, f"its results lack {name}; it returned {listed}"
    value = results[name]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return math.nan, f"its result {name} is {value!r:.60}, not a number"
    try:
        value = float(value)
    except OverflowError:
        value = math.inf
    return (value, "") if math.isfinite(value) else (math.nan, f"its result {name} is {value}, not a finite number")
