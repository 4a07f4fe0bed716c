"""A store in memory for local runs of the command line; its interface is `worker.stages.parts.store`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from campaigns.flown import Code, Flown
from campaigns.results import Finding, StageResult, Verdict
from campaigns.runs import StageState
from worker.stages.parts.store import Columns, StagePlan, StageRecord, Trace, join


@dataclass
class MemoryStore:
    """Everything in memory; what the command line writes out at the end."""

    stages: list[StageRecord] = field(default_factory=list)
    chunks: dict[int, list[Columns]] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    traces: dict[str, Trace] = field(default_factory=dict)
    verdict: Verdict | None = None
    flown: Flown | None = None

    def plan(self, stages: Sequence[StagePlan]) -> list[StageRecord]:
        if not self.stages:
            self.stages = [StageRecord(plan) for plan in stages]
        return list(self.stages)

    def flies(self, flown: Flown, code: Code) -> None:
        self.flown = flown

    def begin(self, position: int) -> None:
        stage = self.stages[position]
        self.stages[position] = StageRecord(stage.plan, StageState.RUNNING, stage.seconds)

    def evaluations(self, position: int) -> Columns | None:
        return join(self.chunks.get(position, []))

    def append(self, position: int, first: int, columns: Columns) -> None:
        held = sum(len(c.status) for c in self.chunks.get(position, []))
        if first != held:
            raise ValueError(f"stage {position} holds {held} evaluations, given some from index {first} on")
        self.chunks.setdefault(position, []).append(columns)

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
