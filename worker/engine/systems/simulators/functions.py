"""A Python function as a system: called in this process (`InProcess`) or in processes of its own (`Isolated`).

Whatever an evaluation does is a status with a reason; only an interrupt ends the search.
"""

from __future__ import annotations

import sys
import uuid
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from campaigns.catalogue import SimulatorEntry
from campaigns.identity.identity import unread as unidentified
from campaigns.results.base import EXCLUDED, FAILED, FLAKY, OK
from worker.engine.search.base import Batch
from worker.engine.systems.base import Floats, NoResult, Reasons, Seeds, Trace
from worker.engine.systems.simulators import calling, traced
from worker.engine.systems.simulators.called import AGAIN
from worker.engine.systems.simulators.cluster.address import chosen
from worker.engine.systems.simulators.cluster.work import Files
from worker.engine.systems.simulators.declared.folder import files_of_place
from worker.engine.systems.simulators.declared.function import Declaration
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.stores import stores
from worker.engine.systems.simulators.declared.unchanged import Unchanged
from worker.engine.systems.simulators.identity import identified
from worker.engine.systems.simulators.pooled import Pooled
from worker.engine.systems.simulators.simulated import Simulated
from worker.engine.systems.simulators.slots import child, files
from worker.engine.systems.simulators.slots.outcome import Limits, Outcome
from worker.engine.systems.simulators.slots.program import Program
from worker.engine.systems.threads import usual_threads


class _OfFunction(Simulated):
    """What both have in common: the names, the deciding result, and where the digest comes from.

    unread: what cannot be read of the code that the function uses, so that nothing identifies it; usually empty.
    """

    def __init__(
        self, entry: SimulatorEntry, opening: Opening, declaration: Declaration, files_digest: str, unread: str
    ) -> None:
        super().__init__(entry, opening)
        self.declaration, self.of = declaration, declaration.settings
        self.columns, self.scene = declaration.trace, declaration.drawn
        self.files_digest, self.unread = files_digest, unread
        self.names_given = [p.path.removeprefix("simulator.") for p in self.parameters]
        self.every = [r.name for r in entry.results]

    @property
    def digest(self) -> str:
        return self.files_digest

    def _batch(self, values: ArrayLike, failed: Reasons, excluded: Reasons | None = None) -> tuple[Batch, Reasons]:
        costs = np.array(values, dtype=np.float64)[:, None]
        status = np.full(len(costs), OK, dtype=np.uint8)
        for code, reasons in ((FAILED, failed), (EXCLUDED, excluded or {})):
            if reasons:
                rows = list(reasons)
                status[rows] = code
                costs[rows] = np.nan
        return Batch(costs if self.results[0].worse == "low" else -costs, status), {**failed, **(excluded or {})}


class InProcess(_OfFunction):
    """Calls the function in this process: once for each evaluation, or once for each batch.

    What the function uses identifies it, unless it comes from files, whose digest is given.
    """

    def __init__(
        self, call: Callable[..., Any], entry: SimulatorEntry, opening: Opening, declaration: Declaration,
        digest: str = "", unread: str = "", unchanged: Unchanged | None = None,
    ) -> None:  # fmt: skip
        self.from_files = bool(digest)
        if not digest:
            identity = identified(call, declaration.reads)
            digest = unidentified(uuid.uuid4().hex) if identity.unknown else identity.digest
            unread = identity.unknown
        super().__init__(entry, opening, declaration, digest, unread)
        self.call, self.unchanged = call, unchanged
        self._stores: list[Callable[[], object]] = []
        self._answered: set[bytes] | None = None

    def fresh(self) -> InProcess:
        """This function, of which each call is made: no store of results answers it."""
        basics = self.entry, self.opening, self.declaration, self.files_digest, self.unread
        made = InProcess(self.call, *basics, self.unchanged)
        made._stores = stores(self.call)
        return made

    def _forget(self, points: Floats) -> None:
        """Clear the stores of a fresh system where one may have the result of a point: before its first call, and where
        it had that point. Not before every call, so that a table that a store has is not read for each."""
        if not self._stores:
            return
        rows = {row.tobytes() for row in points}
        if self._answered is None or rows & self._answered:
            for clear in self._stores:
                clear()
            self._answered = set()
        self._answered |= rows

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        if self.of.vectorized:
            return self._together(vectors)
        return self._each(vectors)

    def trace(self, name: str, values: Mapping[str, float], seed: int | None = None) -> Trace | None:
        if not self.columns:
            return None
        parameters = self._by_path(self._vector(values))
        own = dict(zip(self.names_given, parameters.values(), strict=True))
        answer = calling.traced(self.call, own, self.every, self.of.vectorized)
        results = answer["results"]
        if "results" not in results:
            raise NoResult(results.get("failed") or results["excluded"], timeout=False)
        head = traced.head(self.results[0], results["results"][self.results[0].name], parameters, self.scene)
        return traced.read(name, self.columns, child.plain(answer), head)

    def _each(self, vectors: Floats) -> tuple[Batch, Reasons]:
        names, every, result, call = self.names_given, self.every, self.results[0].name, self.call
        values, failed, excluded = [np.nan] * len(vectors), Reasons(), Reasons()
        for k, row in enumerate(vectors.tolist()):
            self._forget(vectors[k : k + 1])
            answer = calling.called(call, dict(zip(names, row, strict=True)), every)
            if "failed" in answer:
                failed[k] = answer["failed"]
            elif "excluded" in answer:
                excluded[k] = answer["excluded"]
            else:
                values[k] = answer["results"][result]
        return self._batch(values, failed, excluded)

    def _together(self, vectors: Floats) -> tuple[Batch, Reasons]:
        """Evaluate all rows by one call, or one by one if that raises, so that only the rows at fault fail or are
        excluded. If none of them is, that call has failed and was tried again."""
        m = len(vectors)
        self._forget(vectors)
        columns = {name: np.array(column) for name, column in zip(self.names_given, vectors.T, strict=True)}
        try:
            returned = self._columns(self.call(**columns), m)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            returned, why = calling.failure(error, self.call), calling.excluded(error)
            if m > 1:
                return self._one_by_one(vectors, why or returned, EXCLUDED if why else FAILED)
            if why:
                return self._batch([np.nan], {}, {0: why})
        if isinstance(returned, str):
            return self._batch([np.nan] * m, dict.fromkeys(range(m), returned))
        costs, reasons = returned
        return self._batch(costs, reasons)

    def _one_by_one(self, vectors: Floats, raised: str, as_status: int) -> tuple[Batch, Reasons]:
        """Evaluate the rows of a call that raised, so that together they had this status with this reason."""
        parts = [self._together(row[None]) for row in vectors]
        costs = np.concatenate([batch.costs for batch, _ in parts])
        status = np.concatenate([batch.status for batch, _ in parts])
        reasons = {k: reasons[0] for k, (_, reasons) in enumerate(parts) if reasons}
        if not ((status == FAILED) | (status == as_status)).any():
            excluded = {k: AGAIN.format(before=raised, reason=why) for k, why in reasons.items()}
            status[status == EXCLUDED] = FAILED
            reasons = {k: excluded.get(k, FLAKY + raised) for k in range(len(status))}
        return Batch(costs, status), reasons

    def _columns(self, value: Any, m: int) -> tuple[Floats, Reasons] | str:
        """The deciding result (m,), and why a row has no value, for whichever of its results; or why none has."""
        if not isinstance(value, Mapping):
            if len(self.every) > 1:
                return f"it returned {calling.described(value)}; return a dict with {', '.join(self.every)}"
            return _column(value, m, "it returned")
        reasons, decides = Reasons(), np.empty(0)
        for name in (self.results[0].name, *(name for name in self.every if name != self.results[0].name)):
            if name not in value:
                listed = ", ".join(str(k)[:40] for k in list(value)[:8]) or "nothing"
                return f"its results lack {name}; it returned {listed}"
            found = _column(value[name], m, f"its result {name} is")
            if isinstance(found, str):
                return found
            decides = decides if len(decides) else found[0]
            reasons = {**found[1], **reasons}
        return decides, reasons


class Isolated(_OfFunction, Pooled):
    """Calls the function in slots: limits of time and memory, and no crash reaches this process.

    place: where a slot finds it, its `name` and its `file` or `module`.
    """

    def __init__(
        self, place: Mapping[str, str], entry: SimulatorEntry, opening: Opening, declaration: Declaration, digest: str,
        unread: str = "", unchanged: Unchanged | None = None, alone: bool = False,
    ) -> None:  # fmt: skip
        super().__init__(entry, opening, declaration, digest, unread)
        self.place, self.unchanged = place, unchanged or Unchanged(files_of_place(place))
        self._alone = alone
        self._spread_over(chosen())

    def fresh(self) -> Isolated:
        basics = self.entry, self.opening, self.declaration, self.files_digest, self.unread
        return Isolated(self.place, *basics, self.unchanged, alone=True)

    @property
    def _slots_here(self) -> int:
        return self.of.slots or usual_threads()

    @property
    def _files(self) -> Files:
        return Files(str(Path(self.place.get("file", "")).parent), self.digest, dict(self.place))

    @property
    def _limits(self) -> Limits:
        return Limits(self.of.timeout, memory=self.of.memory, recycle=1 if self._alone else self.of.recycle)

    def _program(self, work: Path) -> Program:
        named = {calling.FUNCTION: calling.packed(self.place, self.every, self.of.vectorized)}
        command = [sys.executable, str(files.CHILD), f"{calling.__file__}:evaluate"]
        return Program(command, "framed", named, str(work / "{slot}"))

    def _read(self, outcome: Outcome) -> tuple[float, str]:
        if outcome.kind != "ok":
            return np.nan, outcome.sentence
        answer = outcome.answer["results"]
        return (np.nan, answer["failed"]) if "failed" in answer else (answer["results"][self.results[0].name], "")


def _column(value: Any, m: int, begun: str) -> tuple[Floats, Reasons] | str:
    """One result of a batch as numbers (m,), with the reasons of those that are none; or why it is no such array."""
    if isinstance(value, (str, bytes)) or value is None:
        return f"{begun} {calling.described(value)}; an array of shape ({m},) is expected"
    found = value if isinstance(value, np.ma.MaskedArray) else np.asarray(value)
    if found.shape != (m,):
        return f"{begun} an array of shape {found.shape}; given arrays of shape ({m},), ({m},) is expected"
    if found.dtype.kind not in "fiuO":
        return f"{begun} an array of {found.dtype}, not of numbers"
    if found.dtype.kind == "O":
        return _each(found, begun)
    reasons = {int(k): f"{begun} masked" for k in np.flatnonzero(np.ma.getmaskarray(found))}
    plain = np.ma.getdata(found).astype(np.float64)
    lost = np.flatnonzero(~np.isfinite(plain))
    return plain, {int(k): f"{begun} {plain[k]}, not a finite number" for k in lost} | reasons


def _each(values: Any, begun: str) -> tuple[Floats, Reasons]:
    numbers, reasons = np.full(len(values), np.nan), Reasons()
    for k, value in enumerate(values):
        try:
            numbers[k] = calling.number(value, begun)
        except calling.Wrong as wrong:
            reasons[k] = str(wrong)
    return numbers, reasons
