"""A store in memory for local runs of the command line; its interface is `worker.engine.stages.parts.store`."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from campaigns.capsules.sources import Sources
from campaigns.results import Finding, StageResult, Verdict
from campaigns.runs import StageState
from campaigns.sample_seed import SampleSeed
from campaigns.stored.blocks import Block
from campaigns.stored.records import Ahead, Columns, StagePlan, StageRecord, Trace, join
from campaigns.versions import Code, Versions


@dataclass
class MemoryStore:
    """Everything in memory; what the command line writes out at the end."""

    stages: list[StageRecord] = field(default_factory=list)
    chunks: dict[int, list[Columns]] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    traces: dict[str, Trace] = field(default_factory=dict)
    verdict: Verdict | None = None
    versions: Versions | None = None
    sources: tuple[Sources, dict[str, bytes]] | None = None
    waiting: dict[int, list[Ahead]] = field(default_factory=dict)
    counted: dict[int, list[Block]] = field(default_factory=dict)
    sample_seed: SampleSeed | None = field(default_factory=SampleSeed.drawn)

    def plan(self, stages: Sequence[StagePlan]) -> list[StageRecord]:
        if not self.stages:
            self.stages = [StageRecord(plan) for plan in stages]
        return list(self.stages)

    def cited(self) -> None:
        return None

    def record_versions(self, versions: Versions, code: Code) -> None:
        self.versions = versions

    def record_sources(self, files: Sources, texts: Mapping[str, bytes]) -> None:
        self.sources = files, dict(texts)

    def begin(self, position: int) -> None:
        stage = self.stages[position]
        self.stages[position] = StageRecord(stage.plan, StageState.RUNNING, stage.seconds)

    def evaluations(self, position: int) -> Columns | None:
        return join(self.chunks.get(position, []))

    def ahead(self, position: int) -> Ahead | None:
        waiting = [a for a in self.waiting.get(position, []) if len(a.indices)]
        columns = join([a.columns for a in waiting])
        return None if columns is None else Ahead(np.concatenate([a.indices for a in waiting]), columns)

    def append(self, position: int, first: int, columns: Columns, ahead: Ahead | None = None) -> None:
        stored = sum(len(c.status) for c in self.chunks.get(position, []))
        if first != stored:
            raise ValueError(f"stage {position} holds {stored} evaluations, given some from index {first} on")
        self.chunks.setdefault(position, []).append(columns)
        if ahead is not None:
            waiting = [*self.waiting.get(position, []), ahead]
            self.waiting[position] = [_behind(a, first + len(columns.status)) for a in waiting]

    def blocks(self, position: int, known: Collection[int] = ()) -> list[Block]:
        return [block for block in self.counted.get(position, []) if block.first not in known]

    def take(self, position: int, firsts: Sequence[int], most: int, others: bool) -> list[int]:
        return list(firsts[:most])

    def count(self, position: int, blocks: Sequence[Block]) -> None:
        self.counted.setdefault(position, []).extend(blocks)

    def beat(self) -> None:
        pass

    def keep(self, position: int, columns: Columns) -> None:
        self.chunks[position] = [columns]

    def finish(
        self,
        position: int,
        result: StageResult,
        seconds: float,
        findings: Sequence[Finding] = (),
        traces: Sequence[Trace] = (),
    ) -> None:
        self.stages[position] = StageRecord(self.stages[position].plan, StageState.DONE, seconds, result)
        self.findings.extend(findings)
        self.traces.update({t.name: t for t in traces})

    def found(self) -> list[Finding]:
        return sorted(self.findings, key=lambda f: f.cost)

    def conclude(self, verdict: Verdict) -> None:
        self.verdict = verdict


def _behind(ahead: Ahead, done: int) -> Ahead:
    """The evaluations whose index is not among the first `done`."""
    kept, columns = ahead.indices >= done, ahead.columns
    rows = Columns(
        columns.points[kept], columns.costs[kept], columns.status[kept], columns.seconds[kept], columns.reasons
    )
    return Ahead(ahead.indices[kept], rows)
