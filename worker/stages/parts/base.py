"""Shared by the stages: the context of a run, and the driver between a method and the system that evaluates.

The driver counts evaluations, answers repeated points from memory, stores results, stops at the budget or when the run
is cancelled, tracks the best point, and replays the stored evaluations of a resumed stage. Start reading at `drive`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from campaigns import Campaign
from campaigns.results import NominalResult, SearchResult, StageResult
from campaigns.results.base import EXCLUDED, OK, Stop
from worker.problem.evaluate import Evaluate
from worker.problem.problem import Problem
from worker.search.base import Batch, Ended, Search
from worker.stages.parts.ended import stop
from worker.stages.parts.store import Columns, StagePlan, Store, join
from worker.systems.base import Floats, Seeds, System

Result = TypeVar("Result")

FLUSH_SECONDS = 0.2
FLUSH_ROWS = 4096
FULL_BLOCKS = 16
"""Minimum number of points per call for a system that evaluates in blocks."""


class Seeded(NamedTuple):
    """A request of a stage: points (m, n), each with the noise realisation of its own seed (m,)."""

    points: Floats
    seeds: Seeds


class Through(NamedTuple):
    """A request of a stage: points (m, n), evaluated through another form of the system, such as a fresh one."""

    points: Floats
    system: System


Request = Floats | Seeded | Through
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

    @property
    def nominal_cost(self) -> float | None:
        """Result of the nominal stage; None until it is done."""
        nominal = self.results.get(0)
        return nominal.cost if isinstance(nominal, NominalResult) else None

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
        """By its own rule or by the budget."""
        return self.how.kind

    @property
    def text(self) -> str:
        """The same in words."""
        return self.how.text


def drive(context: Context, position: int, search: Search | Asking[str], budget: int, repeats: bool = False) -> Driven:
    """Evaluate what a search requests until its own rule or the budget ends it; raises `Cancelled`."""
    driver = _Driver(context, position, budget, repeats)
    try:
        points = next(search)
        while True:
            if context.cancelled():
                raise Cancelled
            batch, spent = driver.answer(points)
            if spent:
                return driver.end(
                    stop("budget", Ended("budget", "used its budget of {budget} evaluations", budget=budget))
                )
            points = search.send(batch)
    except StopIteration as stopped:
        return driver.end(stop("rule", stopped.value))
    finally:
        search.close()
        driver.flush()


class _Driver:
    def __init__(self, context: Context, position: int, budget: int, repeats: bool) -> None:
        self.context, self.position, self.budget = context, position, budget
        self.tally = Tally()
        self.known: dict[bytes, tuple[Floats, int]] | None = {} if repeats else None
        self.through: System | None = None
        self.held: list[Columns] = []
        self.unsaved: list[Columns] = []
        self.stored = context.store.evaluations(position)
        earlier = self.stored.seconds if self.stored is not None else np.empty(0)
        self.offset = float(earlier[-1]) if len(earlier) else 0.0
        self.began = self.saved = time.perf_counter()

    def answer(self, request: Request) -> tuple[Batch, bool]:
        """The batch for these points, and whether the budget ended before all were evaluated."""
        if isinstance(request, Through):
            self.through = request.system
            try:
                return self._fresh(request.points)
            finally:
                self.through = None
        points, seeds = request if isinstance(request, Seeded) else (request, None)
        if self.known is None:
            return self._fresh(points, seeds)
        keys = [p.tobytes() for p in points]
        if seeds is not None:
            keys = [key + seed.tobytes() for key, seed in zip(keys, seeds, strict=True)]
        distinct = list({key: i for i, key in reversed([*enumerate(keys)]) if key not in self.known}.values())
        if distinct:
            distinct.sort()
            batch, spent = self._fresh(points[distinct], None if seeds is None else seeds[distinct])
            for i, cost, status in zip(distinct, batch.costs, batch.status, strict=False):
                self.known[keys[i]] = (cost, int(status))
            if spent:
                return batch, True
        rows = [self.known[key] for key in keys]
        return Batch(np.array([r[0] for r in rows]), np.array([r[1] for r in rows], dtype=np.uint8)), False

    def end(self, how: Stop) -> Driven:
        if self.stored is not None and self.tally.evaluations < len(self.stored.status):
            raise ReplayMismatch(self.position, self.tally.evaluations)
        self.flush()
        self.tally.seconds = self._seconds()
        columns = join(self.held)
        if columns is not None:
            self.context.columns[self.position] = columns
        return Driven(self.tally, columns, how)

    def flush(self) -> None:
        columns = join(self.unsaved)
        if columns is not None:
            first = self.tally.evaluations - len(columns.status)
            self.unsaved = []  # even on error: the store may have written them before it raised
            self.context.store.append(self.position, first, columns)
        self.saved = time.perf_counter()
        self.context.progress(self.position, self.tally)

    def _fresh(self, points: Floats, seeds: Seeds | None = None) -> tuple[Batch, bool]:
        room = self.budget - self.tally.evaluations
        spent = len(points) >= room and len(points) > 0
        points = points[:room]
        costs: list[Floats] = []
        status: list[NDArray[np.uint8]] = []
        done = 0
        while done < len(points):
            if self.context.cancelled():
                raise Cancelled
            piece = slice(done, done + self._piece())
            columns = self._stored(points[done:]) or self._flown(points[piece], None if seeds is None else seeds[piece])
            costs.append(columns.costs)
            status.append(columns.status)
            done += len(columns.status)
        batch = Batch(np.concatenate(costs), np.concatenate(status)) if costs else Batch(np.empty((0, 1)), _no_status())
        return batch, spent

    def _stored(self, points: Floats) -> Columns | None:
        """The next evaluations as stored by an earlier attempt, if any are left."""
        index = self.tally.evaluations
        if self.stored is None or index >= len(self.stored.status):
            return None
        count = min(len(points), len(self.stored.status) - index)
        rows = slice(index, index + count)
        if not np.array_equal(self.stored.points[rows], points[:count]):
            raise ReplayMismatch(self.position, index)
        reasons = {i: why for i, why in self.stored.reasons.items() if index <= i < index + count}
        stored = self.stored
        columns = Columns(stored.points[rows], stored.costs[rows], stored.status[rows], stored.seconds[rows], reasons)
        self._count(columns)
        return columns

    def _flown(self, points: Floats, seeds: Seeds | None) -> Columns:
        began = time.perf_counter()
        evaluate = self.context.evaluate
        if self.through is not None:
            batch, reasons = self.through.evaluate(self.context.problem.vectors(points))
        else:
            batch, reasons = evaluate(points) if seeds is None else evaluate(points, seeds)
        self.context.problem.system.cost = max(time.perf_counter() - began, 1e-6) / len(points)
        first = self.tally.evaluations
        seconds = np.full(len(points), self._seconds())
        columns = Columns(points, batch.costs, batch.status, seconds, {first + i: why for i, why in reasons.items()})
        self.unsaved.append(columns)
        self._count(columns)
        rows = sum(len(c.status) for c in self.unsaved)
        if rows >= FLUSH_ROWS or time.perf_counter() - self.saved >= FLUSH_SECONDS:
            self.flush()
        return columns

    def _piece(self) -> int:
        """Points per call, so that cancellation is checked and results are stored at the interval for storing."""
        system = self.context.problem.system
        least = max(FULL_BLOCKS * system.block, 1)
        return (
            least if system.cost is None else int(np.clip(FLUSH_SECONDS / system.cost, least, FULL_BLOCKS * FLUSH_ROWS))
        )

    def _count(self, columns: Columns) -> None:
        tally, first = self.tally, self.tally.evaluations
        self.held.append(columns)
        tally.evaluations += len(columns.status)
        tally.failed += int(np.count_nonzero((columns.status != OK) & (columns.status != EXCLUDED)))
        tally.excluded += int(np.count_nonzero(columns.status == EXCLUDED))
        tally.seconds = self._seconds()
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        row = int(np.argmin(ranked))
        if np.isfinite(ranked[row]) and (tally.best is None or ranked[row] < tally.best):
            tally.best, tally.best_index = float(ranked[row]), first + row
            tally.best_point = columns.points[row].copy()

    def _seconds(self) -> float:
        return self.offset + time.perf_counter() - self.began


def _no_status() -> NDArray[np.uint8]:
    return np.empty(0, dtype=np.uint8)


def once(points: Floats, text: str) -> Search:
    """A search that requests these points and ends."""
    yield points
    return text


def all_columns(context: Context, positions: list[int]) -> list[tuple[int, Columns]]:
    """The evaluations of these stages, from memory or from the store."""
    found = []
    for position in positions:
        if position not in context.columns:
            stored = context.store.evaluations(position)
            if stored is None:
                continue
            context.columns[position] = stored
        found.append((position, context.columns[position]))
    return found
