"""Where a run's results go as they arise, and where a resumed run finds them.

`Store` is the seam: the database behind a lease (`backend.db.store`) or memory (`worker.runs.store`).
Every write of a store that has lost its lease raises; nothing is ever overwritten by a stale worker. What is handed
over is plain data, in `backend.db.records`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from backend.db.records import (
    Columns,
    Floats,
    StagePlan,
    StageRecord,
    Trace,
    join,
)
from campaigns.flown import Code, Flown
from campaigns.results import Finding, StageResult, Verdict

__all__ = [
    "Columns",
    "Floats",
    "StagePlan",
    "StageRecord",
    "Store",
    "Trace",
    "join",
]


class Store(Protocol):
    """What a runner needs of storage. Positions are those of the plan; indices count from 0 within a stage."""

    def plan(self, stages: Sequence[StagePlan]) -> list[StageRecord]:
        """Write the plan of a new run; return every stage as it stands (a resumed run finds its earlier state)."""

    def flies(self, flown: Flown, code: Code) -> None:
        """Store what flies as the first stage begins; raises `OtherCode` where other code has flown already."""

    def begin(self, position: int) -> None:
        """Mark a stage running."""

    def evaluations(self, position: int) -> Columns | None:
        """All evaluations stored for a stage, in order; None when there are none."""

    def append(self, position: int, first: int, columns: Columns) -> None:
        """Store evaluations from index `first` on, and bring the stage's and the run's counts and best up to date."""

    def finish(
        self,
        position: int,
        result: StageResult,
        seconds: float,
        findings: Sequence[Finding] = (),
        traces: Sequence[Trace] = (),
    ) -> None:
        """Store a stage's result and what it found, and mark it done: all or nothing."""

    def found(self) -> list[Finding]:
        """The findings stored so far, the worst first."""

    def conclude(self, verdict: Verdict) -> None:
        """Store the verdict; the run is done."""
