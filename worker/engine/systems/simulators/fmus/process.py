"""The functions that the process of a slot executes for an FMU: `evaluate`, and `probe` before the first evaluation."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import struct
import sys
import time
import zipfile
from collections.abc import Mapping
from pathlib import Path

from worker.engine.systems.simulators.fmus import JOB
from worker.engine.systems.simulators.fmus.job import Job
from worker.engine.systems.simulators.fmus.recorded import Record
from worker.engine.systems.simulators.fmus.unit import Failed, Refused, Unit

EXTRACTED = Path("fmu")
LONG = 5.0
"""Above this time of an evaluation [s], a new process for each one costs little, and the probe ends."""


class Evaluate:
    """Evaluates in the slot's folder; `prepare` extracts and loads the FMU before the slot reports that it is ready."""

    def __init__(self) -> None:
        self._unit: Unit | None = None

    def prepare(self) -> None:
        try:
            self._unit = loaded()
        except Failed as error:
            sys.exit(error.sentence)

    def __call__(self, /, **values: float) -> dict[str, float]:
        assert self._unit is not None
        return self._unit.run(values)

    def traced(self, /, **values: float) -> dict[str, object]:
        assert self._unit is not None
        record = Record(self._unit.job["trace"], self._unit.job["steps"])
        return {"results": self._unit.run(values, record), "trace": record.columns}


evaluate = Evaluate()


def loaded() -> Unit:
    """The FMU of the job, extracted again into the folder of the slot; raises Refused."""
    setting = os.environ[JOB]
    job: Job = json.loads(setting if setting.startswith("{") else Path(setting).read_text(encoding="utf-8"))
    file = Path(job["file"])
    try:
        if hashlib.sha256(file.read_bytes()).hexdigest() != job["sha256"]:
            raise Refused(f"{file.name} has changed since this run opened it; start the run again")
        shutil.rmtree(EXTRACTED, ignore_errors=True)
        with zipfile.ZipFile(file) as archive:
            kept = [n for n in archive.namelist() if n.startswith(("binaries/", "resources/")) or n.endswith(".xml")]
            archive.extractall(EXTRACTED, members=kept)
    except (OSError, zipfile.BadZipFile) as error:
        raise Refused(f"{file.name} cannot be extracted: {error}") from None
    (EXTRACTED / "resources").mkdir(exist_ok=True)
    return Unit(job, EXTRACTED.resolve(), reset=job["reuse"] == "reset")


def probe(nominal: Mapping[str, float], others: list[dict[str, float]]) -> dict[str, str]:
    """How evaluations may share a process: `reset`, `instance` or `process`, and why it is not less.

    The nominal case is evaluated first in a new process, then again after the first of `others` that does not fail: on
    the same instance after a reset, then on a new instance. The first of the two that gives the same bits is used.
    """
    try:
        unit = loaded()
        unit.reset = True
        unit.instantiate()
    except Refused as error:
        return {"refused": error.sentence}
    began = time.monotonic()
    try:
        first = unit.run(nominal)
    except Failed as error:
        return {"reuse": "process", "why": f"the nominal case failed: {error.sentence}"}
    if time.monotonic() - began > LONG:
        return {"reuse": "process", "why": f"an evaluation takes longer than {LONG:g} s"}
    if _same(first, _after(unit, others, nominal)):
        return {"reuse": "reset", "why": ""}
    unit.drop()
    unit.reset = False
    if _same(first, _after(unit, others, nominal)):
        return {"reuse": "instance", "why": "after a reset the nominal case gives other results"}
    return {"reuse": "process", "why": "a new instance in the same process gives other results for the nominal case"}


def _after(unit: Unit, others: list[dict[str, float]], nominal: Mapping[str, float]) -> dict[str, float] | None:
    """The nominal case after another one, or after itself if all others fail; None if it fails.

    A failed case does not count: its instance is dropped, so the next case would not follow a reset.
    """
    for other in [*others, nominal]:
        try:
            unit.run(other)
            return unit.run(nominal)
        except Failed as error:
            if error.retire:
                return None
    return None


def _same(first: Mapping[str, float], second: Mapping[str, float] | None) -> bool:
    return second is not None and _bits(first) == _bits(second)


def _bits(results: Mapping[str, float]) -> list[bytes]:
    return [struct.pack("<d", value) for value in results.values()]
