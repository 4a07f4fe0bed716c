"""A simulator as a campaign asks for it: several calls for each evaluation, and failed calls tried again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from functools import partial
from typing import Any

import numpy as np

from campaigns.asked.spec import Simulator
from campaigns.results.base import EXCLUDED, FAILED, FLAKY, OK, TIMEOUT
from worker.engine.search.base import Batch
from worker.engine.systems.base import Evaluated, Floats, Realised, Reasons, Seeds, Slotted, System, Trace, slotted
from worker.engine.systems.simulators.pooled import batch_of, gathered
from worker.engine.systems.simulators.simulated import Simulated

LOST = "the call failed"
UNLIKE = "excluded ({reason}), other calls of the same case are not: a case must be excluded by its parameters alone"
AGAIN = "{before}; tried again, it was excluded ({reason}), which does not replace a failure"


class Called(Simulated):
    """Evaluates by `calls` calls of a simulator, each tried again up to `retries` times, combined as the campaign
    states. One failed call makes the evaluation fail; so does one that is excluded while others are not. Only a case
    that all calls exclude is excluded, and never one of which a call failed before."""

    def __init__(self, inner: System, request: Simulator, borrowed: bool = False) -> None:
        inner = slotted(inner)
        self.inner, self.request, self._borrowed = inner, request, borrowed
        self.parameters, self.nominal, self.results = inner.parameters, inner.nominal, inner.results
        self.repeatable, self.settings = inner.repeatable, inner.settings
        self.elsewhere, self.campaign_command = inner.elsewhere, inner.campaign_command
        self.step = inner.step if isinstance(inner, Simulated) else None

    @property
    def realisations(self) -> Realised:
        return self.inner.realisations if isinstance(self.inner, Simulated) else Realised()

    def fresh(self) -> Slotted:
        """This system without any state of earlier calls; what is compared in fresh processes is not tried again."""
        fresh = self.inner.fresh()
        return Called(fresh, self.request.model_copy(update={"retries": 0}), borrowed=fresh is self.inner)

    def halved(self) -> Simulated | None:
        halved = self.inner.halved() if isinstance(self.inner, Simulated) else None
        return None if halved is None else Called(halved, self.request.model_copy(update={"retries": 0}))

    def single(self) -> Slotted:
        """This system with one call for each evaluation; failed ones are still tried again."""
        once = self.request.model_copy(update={"repeats": None})
        return Called(self.inner, once) if self.request.retries else self.inner

    def changed(self, now: bool = False, everywhere: bool = False) -> str:
        return self.inner.changed(now, everywhere) if isinstance(self.inner, Simulated) else ""

    @property
    def digest(self) -> str:
        return self.inner.digest

    @property
    def slots(self) -> int:
        return self.inner.slots

    @property
    def recycle(self) -> int:
        return self.inner.recycle

    def submit(self, vector: Floats, seed: int | None = None) -> Future[Evaluated]:
        return gathered([self._attempt(vector) for _ in range(self.request.calls)], self._combined)

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        if self.slots:
            return batch_of([future.result() for future in [self.submit(vector) for vector in vectors]])
        calls = self.request.calls
        batch, reasons = self._tried(np.repeat(vectors, calls, axis=0))
        rows = [Evaluated(batch.costs[k], int(s), reasons.get(k, "")) for k, s in enumerate(batch.status)]
        return batch_of([self._combined(rows[k : k + calls]) for k in range(0, len(rows), calls)])

    def trace(self, name: str, values: Mapping[str, float], seed: int | None = None) -> Trace | None:
        """The trace of one further call, which is not tried again."""
        return self.inner.trace(name, values, seed)

    def warm(self) -> None:
        self.inner.warm()

    def close(self) -> None:
        if not self._borrowed:
            self.inner.close()

    def _tried(self, vectors: Floats) -> tuple[Batch, Reasons]:
        """Evaluate each vector by one call; what failed or timed out is tried again, up to the number of retries."""
        batch, reasons = self.inner.evaluate(vectors)
        costs, status, first = batch.costs.copy(), batch.status.copy(), dict(reasons)
        left = np.flatnonzero(_lost(status))
        for _ in range(self.request.retries):
            if not len(left):
                break
            again, why = self.inner.evaluate(vectors[left])
            for i, row in enumerate(left.tolist()):
                one = Evaluated(again.costs[i], int(again.status[i]), why.get(i, LOST))
                costs[row], status[row], reasons[row] = _again(one, first.get(row, LOST))
            left = left[_lost(again.status)]
        return Batch(costs, status), reasons

    def _attempt(self, vector: Floats) -> Future[Evaluated]:
        """Evaluate by one call in a slot; what failed or timed out is tried again, up to the number of retries."""
        found: Future[Evaluated] = Future()

        def ended(future: Future[Evaluated], left: int, before: str) -> None:
            try:
                one = future.result()
                if left and _lost(one.status):
                    again = self.inner.submit(vector)
                    again.add_done_callback(partial(ended, left=left - 1, before=before or one.reason or LOST))
                    return
                found.set_result(_again(one, before) if before else one)
            except Exception as error:  # such as of closed slots: reaches whoever waits for this evaluation
                found.set_exception(error)

        self.inner.submit(vector).add_done_callback(partial(ended, left=self.request.retries, before=""))
        return found

    def _combined(self, calls: Sequence[Evaluated]) -> Evaluated:
        """The calls of one evaluation as one: of the worst call all results, else each result on its own.

        The reason is that of the first call that failed, that was excluded, or that succeeded only when tried again.
        """
        if len(calls) == 1:
            return calls[0]
        status = np.array([one.status for one in calls])
        found = [*np.flatnonzero(_lost(status)), *np.flatnonzero(status == EXCLUDED)]
        if not found:
            marked = next((k for k, one in enumerate(calls) if one.reason), None)
            reason = "" if marked is None else _numbered(calls[marked].reason, marked + 1, len(calls))
            return Evaluated(self._cost(np.array([one.costs for one in calls])), OK, reason)
        first = int(found[0])
        one, nothing = calls[first], np.full_like(calls[0].costs, np.nan)
        if (status == EXCLUDED).all():
            return Evaluated(nothing, EXCLUDED, one.reason)
        why, lost = one.reason or LOST, one.status
        if one.status == EXCLUDED:
            why, lost = UNLIKE.format(reason=why), FAILED
        return Evaluated(nothing, lost, _numbered(why, first + 1, len(calls)))

    def _cost(self, costs: Floats) -> Floats:
        """The costs (calls, k) of one evaluation as one row (k,)."""
        repeats = self.request.repeats
        if repeats is None or repeats.combine == "worst":
            return np.asarray(costs[int(np.argmin(costs[:, 0]))])
        if repeats.combine == "mean":
            return np.asarray(costs.mean(axis=0))
        return np.asarray(np.quantile(costs, repeats.quantile or 0.0, axis=0, method="inverted_cdf"))


def _numbered(reason: str, call: int, calls: int) -> str:
    text = f"call {call} of {calls}: {reason.removeprefix(FLAKY)}"
    return FLAKY + text if reason.startswith(FLAKY) else text


def _lost(status: Any) -> Any:
    """What is tried again: an excluded evaluation is not."""
    return (status == FAILED) | (status == TIMEOUT)


def _again(one: Evaluated, before: str) -> Evaluated:
    """An evaluation after a failure, which another value only marks, and which its exclusion does not undo."""
    if one.status == EXCLUDED:
        return Evaluated(one.costs, FAILED, AGAIN.format(before=before, reason=one.reason))
    return one._replace(reason=FLAKY + before) if one.status == OK else one
