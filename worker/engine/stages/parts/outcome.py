"""The types of a stage and its outcome; stages are discovered, one file each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from campaigns.asked.problem import Problem as Wrong
from campaigns.results import Finding, StageResult
from campaigns.stored.records import Trace
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.context import Context

R = TypeVar("R", bound=StageResult, covariant=True)


@dataclass(frozen=True)
class Outcome(Generic[R]):
    """The outcome of a stage: its result, and the findings and traces that are stored with it."""

    result: R
    findings: tuple[Finding, ...] = ()
    traces: tuple[Trace, ...] = ()


@dataclass(frozen=True)
class Stage:
    """A kind of stage, as `campaigns.stages` declares it; what runs it at a position, and a share of it while another
    worker runs it."""

    kind: str
    run: Callable[[Context, int], Outcome[StageResult]]
    assist: Callable[[Context, int], None] | None = None
    wrong: Callable[[Problem], Sequence[Wrong]] = lambda problem: ()
    """What of the campaign cannot be carried out, known before anything is evaluated."""
