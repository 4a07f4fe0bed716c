"""A simulator that is an FMU: the described file, evaluated in slots by `process`."""

from __future__ import annotations

import json
import sys
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from worker.engine.systems.base import Settings
from worker.engine.systems.simulators.cluster.work import WORK
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.fmu import DescribedFmu
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.unchanged import Unchanged
from worker.engine.systems.simulators.fmus import JOB
from worker.engine.systems.simulators.fmus.job import Job
from worker.engine.systems.simulators.slots import files
from worker.engine.systems.simulators.slots.outcome import Limits
from worker.engine.systems.simulators.slots.places import Place
from worker.engine.systems.simulators.slots.pool import SlotPool
from worker.engine.systems.simulators.slots.program import Program

ENTRY = "worker.engine.systems.simulators.fmus.process"
SHARES = {
    "reset": "one instance for all evaluations of a process, reset before each",
    "instance": "a new instance for each evaluation",
    "process": "a new process for each evaluation",
}
LOGGED = ("logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal")
OTHERS = (0.5, 0.1, 0.01)
"""The probe evaluates cases so far from the nominal one to the farther limits, until one does not fail."""
EVALUATIONS = 3 + 2 * len(OTHERS)


class FmuUnusable(ValueError):
    """The FMU cannot be instantiated; the message gives the reason."""


@dataclass(frozen=True)
class Reuse:
    """How evaluations share a process, a key of SHARES, and why it is not less."""

    how: str
    why: str = ""

    def __str__(self) -> str:
        return SHARES[self.how] + (f" ({self.why})" if self.why else "")


class FmuSimulator(CommandSimulator):
    """Evaluates a described FMU. Its step is the communication step, at which its variables are read."""

    described: DescribedFmu

    def __init__(
        self, described: DescribedFmu, opening: Opening, reuse: Reuse, fresh: bool = False, halvings: int = 0,
        unchanged: Unchanged | None = None,
    ) -> None:  # fmt: skip
        super().__init__(described, opening, fresh, halvings, unchanged)
        self.reuse = reuse
        self.step = described.step / 2**halvings
        self.settings = Settings(step=described.step)

    def fresh(self) -> FmuSimulator:
        return FmuSimulator(self.described, self.opening, self.reuse, True, self._halvings, self.unchanged)

    def halved(self) -> FmuSimulator:
        return FmuSimulator(self.described, self.opening, self.reuse, True, self._halvings + 1, self.unchanged)

    @property
    def _limits(self) -> Limits:
        """Twice the steps may take twice the time."""
        limits = super()._limits
        return replace(limits, timeout=limits.timeout * 2**self._halvings)

    @property
    def _recycle(self) -> int:
        return 1 if self.reuse.how == "process" else super()._recycle

    def _program(self, work: Path) -> Program:
        return program(self.described, self.opening.result, self.reuse.how, "evaluate", work, self._halvings)


def opened(described: DescribedFmu, opening: Opening, unchanged: Unchanged | None = None) -> FmuSimulator:
    """The simulator of a described FMU, which can be instantiated here; raises FmuUnusable.

    unchanged: its files as they were before they were read."""
    nominal = {i.entry.name: opening.nominal[f"simulator.{i.entry.name}"] for i in described.inputs}
    key = (described.digest, opening.result, *nominal.items())
    if key not in _PROBED:
        _PROBED[key] = _probed(described, opening.result, nominal)
    return FmuSimulator(described, opening, _PROBED[key], unchanged=unchanged)


_PROBED: dict[tuple[object, ...], Reuse] = {}
"""By digest, result and nominal case: a probe evaluates the FMU several times."""


def _probed(described: DescribedFmu, result: str, nominal: dict[str, float]) -> Reuse:
    """Compare evaluations in one process of its own; whatever goes wrong there leaves a process for each evaluation."""
    d = described.descriptor
    limits = Limits(EVALUATIONS * d.timeout, d.start, d.memory)
    limit = {i.entry.name: _farther(nominal[i.entry.name], i.entry.low, i.entry.high) for i in described.inputs}
    others = [{name: value + far * (limit[name] - value) for name, value in nominal.items()} for far in OTHERS]
    with (
        closing(Place(d.name)) as work,
        SlotPool(program(described, result, "reset", "probe", work.path), 1, limits) as pool,
    ):
        outcome = pool.evaluate([{"parameters": {"nominal": nominal, "others": others}}])[0]
    if outcome.kind == "not started":
        raise FmuUnusable(outcome.sentence)
    if outcome.kind != "ok":
        return Reuse("process", f"the probe failed: {outcome.reason}")
    found = outcome.answer["results"]
    if "refused" in found:
        raise FmuUnusable(found["refused"])
    return Reuse(found["reuse"], found["why"])


def _farther(nominal: float, low: float, high: float) -> float:
    return low if nominal - low > high - nominal else high


def program(
    described: DescribedFmu, result: str, reuse: str, function: str, work: Path, halvings: int = 0
) -> Program:  # fmt: skip
    """The process of a slot, and its job as a file; on another machine the job itself, which is some kilobytes.

    halvings: of the communication step."""
    job = json.dumps(_job(described, result, reuse, halvings))
    if work != Path(WORK):
        file = work / "job.json"
        file.write_text(job, encoding="utf-8")
        job = str(file)
    command = [sys.executable, str(files.CHILD), f"{ENTRY}:{function}"]
    environment = {**described.descriptor.environment, JOB: job}
    return Program(command, "framed", environment, str(work / "{slot}"))


def _job(described: DescribedFmu, result: str, reuse: str, halvings: int) -> Job:
    """The request to the process; it computes only the result that the campaign names."""
    d, m = described.descriptor, described.model
    fixed = [(m.variables[name], value) for name, value in d.fixed.items()]
    taken = d.results[result]
    return {
        "file": str(described.file),
        "sha256": described.sha256,
        "fmi": m.fmi,
        "identifier": m.identifier,
        "token": m.token,
        "name": d.name,
        "categories": [c for c in LOGGED if c in m.categories],
        "start": m.start,
        "stop": described.stop,
        "step": described.step / 2**halvings,
        "steps": described.steps * 2**halvings,
        "tolerance": m.tolerance,
        "reuse": reuse,
        "set": [(v.type, v.reference, value) for v, value in fixed],
        "inputs": {i.entry.name: i.variable.reference for i in described.inputs},
        "trace": {
            "every": described.every,
            "columns": {name: v.reference for name, v in described.recorded.items()},
        },
        "result": {
            "name": result,
            "variable": taken.variable,
            "reference": m.variables[taken.variable].reference,
            "take": taken.take,
            "level": taken.level,
            "direction": taken.direction,
        },
    }
