"""One loaded FMU in this process: instantiates, sets, steps, reads.

Every call that does not succeed ends the evaluation with a sentence. An instance that failed is never used again.
"""

from __future__ import annotations

import contextlib
import ctypes
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from worker.engine.systems.simulators.fmus.binding import addLoggerProxy, fmi1, fmi2, fmi3
from worker.engine.systems.simulators.fmus.job import Job
from worker.engine.systems.simulators.fmus.recorded import Record
from worker.engine.systems.simulators.fmus.taken import NotTaken, Taken

STATUS = ("ok", "warning", "discard", "error", "fatal", "pending")
DISCARD, FATAL = 2, 4


class Failed(RuntimeError):
    """An evaluation without a result; `retire`: the process must not evaluate again."""

    def __init__(self, sentence: str, retire: bool = False) -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.retire = retire


class Refused(Failed):
    """The FMU cannot be loaded or instantiated at all."""


class Unit:
    """A loaded FMU; `job` is what `simulator` wrote. reset: whether one instance serves all evaluations."""

    def __init__(self, job: Job, folder: Path, reset: bool) -> None:
        self.job, self.reset = job, reset
        self._time: float | None = None
        self._instance = self._used = False
        kinds: dict[int, Any] = {2: fmi2.FMU2Slave, 3: fmi3.FMU3Slave}
        try:
            self._fmu = kinds[job["fmi"]](
                guid=job["token"],
                modelIdentifier=job["identifier"],
                unzipDirectory=str(folder),
                instanceName=job["name"],
            )
        except Exception as error:  # FMPy raises Exception itself
            raise Refused(f"the FMU cannot be loaded: {' '.join(str(error).split())}") from None
        self._log = _logger()
        self._reference = (ctypes.c_uint * 1)(job["result"]["reference"])
        self._value = (ctypes.c_double * 1)()

    def run(self, values: Mapping[str, float], record: Record | None = None) -> dict[str, float]:
        """The results of one evaluation, which a record also sees; raises Failed."""
        self._time = None
        try:
            self._ready()
            self._set(values)
            self._initialise()
            results = self._simulate(record)
            self._fmu.terminate()
        except fmi1.FMICallException as error:
            self.drop(free=error.status != FATAL)
            raise Failed(self._sentence(error), retire=error.status == FATAL) from None
        except NotTaken as error:
            self.drop()
            raise Failed(str(error)) from None
        except Failed:
            self.drop()
            raise
        if not self.reset:
            self.drop()
        return results

    def instantiate(self) -> None:
        """Make an instance; raises Refused."""
        logger = {"callbacks": self._log[1]} if self.job["fmi"] == 2 else {"logMessage": self._log[0]}
        try:
            self._fmu.instantiate(loggingOn=True, **logger)
        except Exception as error:
            what = "GUID" if self.job["fmi"] == 2 else "instantiation token"
            raise Refused(
                f"the FMU refuses to be instantiated; check that its binary belongs to its modelDescription.xml, whose"
                f" {what} is {self.job['token']} ({' '.join(str(error).split())})",
                retire=True,
            ) from None
        self._instance, self._used = True, False
        if self.job["categories"]:
            # Without an effect it logs what it likes; no result depends on that.
            with contextlib.suppress(fmi1.FMICallException):
                self._fmu.setDebugLogging(True, self.job["categories"])

    def _ready(self) -> None:
        if not self._instance:
            self.instantiate()
        elif self._used:
            self._fmu.reset()
        self._used = True

    def _set(self, values: Mapping[str, float]) -> None:
        integer = "Integer" if self.job["fmi"] == 2 else "Int64"
        for kind, reference, value in self.job["set"]:
            getattr(self._fmu, f"set{integer if kind == 'Enumeration' else kind}")([reference], [value])
        setter = self._fmu.setReal if self.job["fmi"] == 2 else self._fmu.setFloat64
        setter([self.job["inputs"][name] for name in values], list(values.values()))

    def _initialise(self) -> None:
        times = {"tolerance": self.job["tolerance"], "startTime": self.job["start"], "stopTime": self.job["stop"]}
        if self.job["fmi"] == 2:
            self._fmu.setupExperiment(**times)
            self._fmu.enterInitializationMode()
        else:
            self._fmu.enterInitializationMode(**times)
        self._fmu.exitInitializationMode()

    def _simulate(self, record: Record | None) -> dict[str, float]:
        start, step = self.job["start"], self.job["step"]
        taken = Taken(self.job["result"])
        self._time = start
        for k in range(self.job["steps"] + 1):
            if k:
                self._step(start + (k - 1) * step, step)
                self._time = start + k * step
            self._read(self._reference, 1, self._value)
            taken.see(self._time, float(self._value[0]))
            if record is not None:
                record.see(k, self._time, self._read)
        return {self.job["result"]["name"]: taken.value()}

    def _step(self, time: float, step: float) -> None:
        if self.job["fmi"] == 2:
            self._fmu.doStep(time, step)
            return
        _, ends, early, reached = self._fmu.doStep(time, step)
        if ends or early:
            what = "ended the simulation" if ends else "returned early from a step"
            raise Failed(f"the model {what} at t = {reached:g} s, before {self.job['stop']:g} s")

    def _read(self, references: Any, count: int, values: Any) -> None:
        """Read variables by their references, as arrays of C."""
        fmu = self._fmu
        if self.job["fmi"] == 2:
            fmu.fmi2GetReal(fmu.component, references, count, values)
        else:
            fmu.fmi3GetFloat64(fmu.component, references, count, values, count)

    def _sentence(self, error: fmi1.FMICallException) -> str:
        if error.function == "fmi2DoStep" and error.status == DISCARD:
            with contextlib.suppress(fmi1.FMICallException):  # a model need not answer
                if self._fmu.getBooleanStatus(fmi2.fmi2Terminated):
                    reached = self._fmu.getRealStatus(fmi2.fmi2LastSuccessfulTime)
                    return f"the model ended the simulation at t = {reached:g} s, before {self.job['stop']:g} s"
        status = STATUS[error.status] if error.status < len(STATUS) else str(error.status)
        when = "" if self._time is None else f" at t = {self._time:g} s"
        return f"{error.function} returned {status}{when}"

    def drop(self, free: bool = True) -> None:
        """The next evaluation makes its own instance."""
        if self._instance and free:
            fmu = self._fmu
            (fmu.fmi2FreeInstance if self.job["fmi"] == 2 else fmu.fmi3FreeInstance)(fmu.component)
        self._instance = False


def _logger() -> tuple[Any, Any]:
    """Callbacks that print what a model reports, from warnings on, to the output of the slot."""

    def show(status: int, message: bytes | None) -> None:
        if status != 0:
            label = STATUS[status] if 0 <= status < len(STATUS) else str(status)
            print(f"[{label}] {(message or b'').decode(errors='replace')}", file=sys.stderr, flush=True)

    def of_fmi3(_environment: Any, status: int, _category: bytes, message: bytes) -> None:
        show(status, message)

    def of_fmi2(_environment: Any, _name: bytes, status: int, _category: bytes, message: bytes) -> None:
        show(status, message)

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(of_fmi2)
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
    addLoggerProxy(ctypes.byref(callbacks))
    return of_fmi3, callbacks
