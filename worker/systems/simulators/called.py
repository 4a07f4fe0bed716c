"""A simulator as a campaign asks for it: several calls for each evaluation, and failed calls tried again.

Start reading at `Called.evaluate`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from campaigns.asked.spec import Simulator
from campaigns.claims.spans import Said
from campaigns.results.base import EXCLUDED, FAILED, FLAKY, OK, TIMEOUT
from worker.search.base import Batch
from worker.systems.base import Floats, Reasons, Scope, Seeds, System, Words
from worker.systems.simulators.simulated import Simulated


class Called(Simulated):
    """Evaluates by `calls` calls of a simulator, each tried again up to `retries` times, combined as the campaign
    states. One failed call makes the evaluation fail."""

    def __init__(self, inner: System, asked: Simulator, borrowed: bool = False) -> None:
        self.inner, self.asked, self._borrowed = inner, asked, borrowed
        self.parameters, self.nominal, self.results = inner.parameters, inner.nominal, inner.results
        self.repeatable, self.block, self.settings = inner.repeatable, inner.block, inner.settings
        self.step = inner.step if isinstance(inner, Simulated) else None

    def fresh(self) -> System:
        """Without any state of earlier calls; what is compared in fresh processes is not tried again."""
        fresh = self.inner.fresh()
        return Called(fresh, self.asked.model_copy(update={"retries": 0}), borrowed=fresh is self.inner)

    def halved(self) -> Simulated | None:
        halved = self.inner.halved() if isinstance(self.inner, Simulated) else None
        return None if halved is None else Called(halved, self.asked.model_copy(update={"retries": 0}))

    def single(self) -> System:
        """With one call for each evaluation; failed ones are still tried again."""
        once = self.asked.model_copy(update={"repeats": None})
        return Called(self.inner, once) if self.asked.retries else self.inner

    @property
    def digest(self) -> str:
        return self.inner.digest

    @property
    def scope(self) -> Scope:
        return self.inner.scope

    @property
    def words(self) -> Words:
        return self.inner.words

    @property
    def caveat(self) -> str:
        return self.inner.caveat

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        calls = self.asked.calls
        batch, reasons = self._tried(np.repeat(vectors, calls, axis=0))
        if calls == 1:
            return batch, reasons
        costs = np.full((len(vectors), batch.costs.shape[1]), np.nan)
        status = np.zeros(len(vectors), dtype=np.uint8)
        combined: Reasons = {}
        for k in range(len(vectors)):
            rows = slice(k * calls, (k + 1) * calls)
            lost = int(np.argmax(batch.status[rows] != OK))
            status[k] = batch.status[rows][lost]
            if status[k] == OK:
                costs[k] = self._combined(batch.costs[rows])
            if why := next(self._why(reasons, k * calls + lost, k * calls, status[k] == OK), ""):
                combined[k] = why
        return Batch(costs, status), combined

    def warm(self) -> None:
        self.inner.warm()

    def bars(self) -> list[tuple[str, Said]]:
        return self.inner.bars()

    def close(self) -> None:
        if not self._borrowed:
            self.inner.close()

    def _tried(self, vectors: Floats) -> tuple[Batch, Reasons]:
        """Each vector by one call; those that failed or timed out again, up to the number of retries."""
        batch, reasons = self.inner.evaluate(vectors)
        costs, status, first = batch.costs.copy(), batch.status.copy(), dict(reasons)
        for _ in range(self.asked.retries):
            lost = np.flatnonzero((status == FAILED) | (status == TIMEOUT))
            if not len(lost):
                break
            again, why = self.inner.evaluate(vectors[lost])
            costs[lost], status[lost] = again.costs, again.status
            for i, row in enumerate(lost.tolist()):
                if again.status[i] in (OK, EXCLUDED):
                    reasons[row] = FLAKY + first.get(row, "the call failed")
                else:
                    reasons[row] = why.get(i, "the call failed")
        return Batch(costs, status), reasons

    def _combined(self, costs: Floats) -> Floats:
        """The calls (calls, k) of one evaluation as one row; of the worst one all results, of others each by itself."""
        repeats = self.asked.repeats
        if repeats is None or repeats.combine == "worst":
            return np.asarray(costs[int(np.argmin(costs[:, 0]))])
        if repeats.combine == "mean":
            return np.asarray(costs.mean(axis=0))
        return np.asarray(np.quantile(costs, repeats.quantile or 0.0, axis=0, method="inverted_cdf"))

    def _why(self, reasons: Reasons, lost: int, first: int, ok: bool) -> Iterator[str]:
        """The reason of an evaluation: of its first call that failed, or that succeeded only when tried again."""
        calls = self.asked.calls
        for row in range(first, first + calls) if ok else (lost,):
            if row in reasons:
                number = f"call {row - first + 1} of {calls}"
                text = reasons[row]
                yield f"{FLAKY}{number}: {text.removeprefix(FLAKY)}" if text.startswith(FLAKY) else f"{number}: {text}"
