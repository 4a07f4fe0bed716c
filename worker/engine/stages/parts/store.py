"""The interface of the storage for results of a run, from which a resumed run reads them.

`Store` is the interface: the database behind a lease (`backend.db.store`) or memory (`worker.running.runs.store`).
Every write of a store that has lost its lease raises, so a stale worker never overwrites anything. The data passed are
plain records (`campaigns.stored.records`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Protocol

from campaigns.capsules.sources import Sources
from campaigns.results import Finding, StageResult, Verdict
from campaigns.sample_seed import SampleSeed
from campaigns.stored.blocks import Block
from campaigns.stored.records import Ahead, Cited, Columns, StagePlan, StageRecord, Trace
from campaigns.versions import Code, Versions


class Store(Protocol):
    """The storage that a runner needs. Positions are those of the plan; indices count from 0 within a stage."""

    @property
    def sample_seed(self) -> SampleSeed | None:
        """The seed of the run's independent sample; None for a run of an earlier version, which has the campaign's."""

    def plan(self, stages: Sequence[StagePlan]) -> list[StageRecord]:
        """Write the plan of a new run; return the state of every stage (a resumed run finds its earlier state)."""

    def record_versions(self, versions: Versions, code: Code) -> None:
        """Store the versions of the code when the first stage begins; raises `OtherCode` if other code has run
        already."""

    def record_sources(self, files: Sources, texts: Mapping[str, bytes]) -> None:
        """Store the sources of the run's components that are not shipped, with their texts by module."""

    def cited(self) -> Cited | None:
        """The run whose evaluations this one begins with; None if it begins without any, or has begun."""

    def begin(self, position: int) -> None:
        """Mark a stage running."""

    def evaluations(self, position: int) -> Columns | None:
        """All stored evaluations of a stage, in order; None if there are none."""

    def ahead(self, position: int) -> Ahead | None:
        """The stored evaluations of a stage that an earlier one is missing for; None if there are none."""

    def append(self, position: int, first: int, columns: Columns, ahead: Ahead | None = None) -> None:
        """Store evaluations from index `first` on, and update the counts and best of the stage and the run.

        ahead: further ones, not stored before, which an earlier one is missing for; None for a stage without them.
        """

    def blocks(self, position: int, known: Collection[int] = ()) -> list[Block]:
        """The counted blocks of a stage of which only a part is stored, in any order; known: first draws of those that
        are left out."""

    def take(self, position: int, firsts: Sequence[int], most: int, others: bool) -> list[int]:
        """Take at most `most` blocks with these first draws that are neither stored nor taken, and return their first
        draws; others: if there are none, those that other workers have taken."""

    def count(self, position: int, blocks: Sequence[Block]) -> None:
        """Store counted blocks, and update the counts and best of the stage and the run."""

    def beat(self) -> None:
        """Say that something was computed that is not stored yet."""

    def keep(self, position: int, columns: Columns) -> None:
        """Store the lowest evaluations of a counted stage in place of its blocks; they are counted already."""

    def finish(
        self,
        position: int,
        result: StageResult,
        seconds: float,
        findings: Sequence[Finding] = (),
        traces: Sequence[Trace] = (),
    ) -> None:
        """Store a stage's result, findings and traces, and mark it done, atomically."""

    def found(self) -> list[Finding]:
        """The findings stored so far, the worst first."""

    def conclude(self, verdict: Verdict) -> None:
        """Store the verdict; the run is done."""
