"""The context of a run in progress, a stage's counts, and the requests that stages make."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple, TypeVar

from campaigns import Campaign
from campaigns.results import SearchResult, StageResult
from campaigns.results.base import Stop
from campaigns.sample_seed import SampleSeed
from campaigns.stored.records import Columns, StagePlan
from worker.engine.problem.evaluate import Evaluate
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch, Method, Several
from worker.engine.stages.parts.store import Store
from worker.engine.systems.base import Floats, Seeds, System

Result = TypeVar("Result")


class Seeded(NamedTuple):
    """A request of a stage: points (m, n), each with the noise realisation of its own seed (m,)."""

    points: Floats
    seeds: Seeds


class Through(NamedTuple):
    """A request of a stage: points (m, n), evaluated through another form of the system, such as a fresh one."""

    points: Floats
    system: System


Request = Floats | Seeded | Through | Several
Asking = Generator[Request, Batch, Result]
"""Yields requests, receives batches; a `Search` is one that returns a sentence and draws no seeds."""


class Cancelled(Exception):
    """The run was cancelled."""


class ReplayMismatch(RuntimeError):
    """A resumed stage requests different points from the stored ones: the code or the machine changed during the run.

    The campaign must be started again as a new run.
    """

    def __init__(self, position: int, index: int) -> None:
        super().__init__(
            f"stage {position} was resumed, but its method no longer requests the point stored as evaluation {index}: "
            "the code or the machine changed in between; start the campaign again as a new run"
        )


@dataclass
class Context:
    """One run in progress: its campaign, the system that evaluates it, its store, and the results of finished
    stages."""

    campaign: Campaign
    problem: Problem
    evaluate: Evaluate
    store: Store
    cancelled: Callable[[], bool] = lambda: False
    progress: Callable[[int, Tally], None] = lambda position, tally: None
    columns: dict[int, Columns] = field(default_factory=dict)
    results: dict[int, StageResult] = field(default_factory=dict)
    plan: Sequence[StagePlan] = ()
    methods: Mapping[str, Method] = field(default_factory=dict)
    """The installed search methods by name."""

    @property
    def sample_seed(self) -> SampleSeed:
        """The seed of the independent sample; of a run of an earlier version the campaign's."""
        return self.store.sample_seed or SampleSeed(self.campaign.seed)

    @property
    def nominal_cost(self) -> float | None:
        """The cost at the nominal values; None until they are evaluated."""
        return next((r.at_nominal.cost for r in self.results.values() if r.at_nominal is not None), None)

    @property
    def searched(self) -> dict[int, SearchResult]:
        """The results of the search stages by position."""
        return {at: r for at, r in sorted(self.results.items()) if isinstance(r, SearchResult)}


@dataclass
class Tally:
    """A stage's counts and best evaluation so far."""

    evaluations: int = 0
    failed: int = 0
    excluded: int = 0
    best: float | None = None
    best_index: int | None = None
    best_point: Floats | None = None
    seconds: float = 0.0


@dataclass(frozen=True)
class Driven:
    """A driven stage: tally, all its evaluations, and how it stopped."""

    tally: Tally
    columns: Columns | None
    how: Stop

    @property
    def stop(self) -> Literal["rule", "budget"]:
        """How the search ended: by its own rule or by the budget."""
        return self.how.kind
