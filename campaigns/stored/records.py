"""The stored results of a run as plain data: evaluations in columns, stages, traces.

The runner writes them through `worker.running.runs.store.Store`; `backend.db.store` maps them to tables.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns.cube import Floats
from campaigns.results import StageResult, TraceHead
from campaigns.results.base import OK
from campaigns.results.trace import TraceColumn
from campaigns.runs import StageState
from campaigns.stages.plan import StagePlan as StagePlan
from campaigns.versions import Versions


class Columns(NamedTuple):
    """Consecutive evaluations of one stage, one row each.

    points (m, n) on the unit cube; costs (m, k), NaN where not ok; status (m,) uint8 as `campaigns.results.base`
    numbers it; seconds (m,) working time of the stage when each was completed; reasons {index in the stage: sentence}.
    """

    points: Floats
    costs: Floats
    status: NDArray[np.uint8]
    seconds: Floats
    reasons: dict[int, str]

    def ranked(self) -> Floats:
        """The first criterion's costs (m,) with infinity where not ok: for comparisons only, it is not a value."""
        return np.where(self.status == OK, self.costs[:, 0], np.inf)


class Ahead(NamedTuple):
    """Evaluations of one stage that were completed before an earlier one: indices in the stage (m,), and their rows."""

    indices: NDArray[np.int64]
    columns: Columns


@dataclass(frozen=True)
class StageRecord:
    """The stored state of a stage; `seconds` is its working time so far."""

    plan: StagePlan
    state: StageState = StageState.WAITING
    seconds: float = 0.0
    result: StageResult | None = None


@dataclass(frozen=True)
class Trace:
    """A flight as columns: data (rows, columns)."""

    name: str
    columns: list[TraceColumn]
    data: Floats
    meta: TraceHead


class Begun(NamedTuple):
    """The versions behind the evaluations of a run, and the digests of its modules, as far as they are stored."""

    versions: Versions
    modules: dict[str, str]


class Cited(NamedTuple):
    """The run whose evaluations another one begins with: its stages, and their evaluations by position; ahead: those
    that an earlier one of their stage is missing for."""

    begun: Begun
    stages: list[StageRecord]
    evaluations: dict[int, Columns]
    ahead: dict[int, Ahead]


def join(chunks: Sequence[Columns]) -> Columns | None:
    """Concatenate consecutive columns; None if there are none."""
    if not chunks:
        return None
    reasons = {index: why for chunk in chunks for index, why in chunk.reasons.items()}
    points, costs, status, seconds = (np.concatenate([c[k] for c in chunks]) for k in range(4))
    return Columns(points, costs, status, seconds, reasons)
