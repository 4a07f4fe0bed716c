"""What a run hands to its storage, as plain data: evaluations in columns, stages, findings, traces, the conclusion.

The runner writes them through `worker.runs.store.Store`; `backend.db.store` puts them into the tables. Start reading at
`Columns`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
StageKind = Literal["nominal", "sensitivity", "search", "certify", "validate"]


class Columns(NamedTuple):
    """Consecutive evaluations of one stage, a row each.

    points (m, n) on the unit cube; costs (m, k), NaN where not ok; status (m,) uint8 as
    `worker.search.base` numbers it; seconds (m,) working time of the stage when each was known; reasons {index in the
    stage: sentence}.
    """

    points: Floats
    costs: Floats
    status: NDArray[np.uint8]
    seconds: Floats
    reasons: dict[int, str]


@dataclass(frozen=True)
class StagePlan:
    """A stage before it is begun: `planned` evaluations are its budget."""

    kind: StageKind
    method: str | None
    planned: int


@dataclass(frozen=True)
class StageRecord:
    """A stage as it stands in the store; `seconds` is the working time so far."""

    plan: StagePlan
    state: Literal["waiting", "running", "done"] = "waiting"
    seconds: float = 0.0
    result: dict[str, Any] | None = None


@dataclass(frozen=True)
class Finding:
    """One distinct worst case; columns as in `backend.db.tables.Finding`."""

    label: str
    cost: float
    margin: float
    parameters: dict[str, float]
    point: list[float]
    methods: list[str]
    at_bounds: dict[str, str]
    validation: dict[str, Any]
    found: list[dict[str, Any]] = field(default_factory=list)


@dataclass(frozen=True)
class Trace:
    """A flight as columns; `columns` and `meta` as in `backend.db.tables.Trace`, data (rows, columns)."""

    name: str
    columns: list[dict[str, str]]
    data: Floats
    meta: dict[str, Any]


@dataclass(frozen=True)
class Conclusion:
    """The end of a run: verdict, its sentence, and all that stands behind it."""

    verdict: Literal["cleared", "violated", "inconclusive"]
    reason: str
    nominal_cost: float | None
    worst_cost: float | None
    worst_method: str | None
    summary: dict[str, Any]


def join(chunks: Sequence[Columns]) -> Columns | None:
    """Consecutive columns as one; None for none."""
    if not chunks:
        return None
    reasons: dict[int, str] = {}
    for chunk in chunks:
        reasons.update(chunk.reasons)
    points, costs, status, seconds = (np.concatenate([c[k] for c in chunks]) for k in range(4))
    return Columns(points, costs, status, seconds, reasons)
