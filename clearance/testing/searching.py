"""Runs a search method: on a plain function, or under the driver of a run. Start reading at `run`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, cast

import numpy as np

from campaigns import library, load_file
from campaigns.results.base import OK
from campaigns.stored.records import StagePlan
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch, Floats, Method, Minimum, Parallel, Search, Space
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Context, Driven
from worker.running.opening.opened import closed_loop
from worker.running.runs.store import MemoryStore

Function = Callable[[Floats], Floats]
"""Maps points (m, n) to values (m,), NaN if excluded."""


@dataclass
class Searched:
    """All batches that a method requested, and its messages."""

    batches: list[Floats] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)
    minima: list[Minimum] = field(default_factory=list)
    text: str | None = None

    @property
    def points(self) -> Floats:
        return np.concatenate(self.batches)

    @property
    def lowest(self) -> float:
        return float(np.nanmin(np.concatenate(self.values)))


def space(
    dimension: int, budget: int, minima: list[Minimum] | None = None, starts: Floats | None = None, seed: int = 1
) -> Space:
    """What a method is given."""
    return Space(
        dimension=dimension,
        budget=budget,
        random=np.random.default_rng(seed),
        starts=np.empty((0, dimension)) if starts is None else starts,
        quantile=lambda uniform: uniform,
        report=([] if minima is None else minima).append,
    )


def batch(values: Floats, status: int = 1) -> Batch:
    """The batch of these values; those that are NaN have the given status."""
    return Batch(values[:, None], np.where(np.isnan(values), status, OK).astype(np.uint8))


def plain(search: Parallel) -> Search:
    """The search as one that requests points only, which it does without slots."""
    return cast("Search", search)


def run(
    method: Method,
    function: Function,
    dimension: int,
    budget: int,
    starts: Floats | None = None,
    seed: int = 1,
    status: int = 1,
    until: Callable[[Searched], bool] = lambda found: False,
    options: Mapping[str, object] | None = None,
) -> Searched:
    """Run a method until it ends, its budget is reached or `until` is true; NaN values have `status`."""
    found = Searched()
    search = plain(method.search(space(dimension, budget, found.minima, starts, seed), method.options(**options or {})))
    evaluations = 0
    try:
        points = next(search)
        while True:
            found.batches.append(points.copy())
            evaluations += len(points)
            values = function(points)
            found.values.append(values)
            if evaluations >= budget or until(found):
                return found
            points = search.send(batch(values, status))
    except StopIteration as stopped:
        found.text = stopped.value
        return found
    finally:
        search.close()


BUDGET, COSTLY = 400, 24
"""Evaluations of a search; a costly method has at most the second number, and the full one in `make nightly`."""


def at_most(method: Method, budget: int) -> int:
    """The budget, or less for a method whose own time is milliseconds per evaluation."""
    return min(budget, COSTLY) if method.costly else budget


def smooth(x: Floats) -> Floats:
    return np.asarray(((x - 0.3) ** 2).sum(axis=1))


def rough(x: Floats) -> Floats:
    return np.asarray((np.abs(x - 0.7)).sum(axis=1) + 0.3 * np.cos(40 * x).prod(axis=1))


def flat(x: Floats) -> Floats:
    return np.zeros(len(x))


def steps(x: Floats) -> Floats:
    return np.asarray(np.floor(4 * x).sum(axis=1))


def huge(x: Floats) -> Floats:
    return np.asarray(1e11 * (x - 0.5).sum(axis=1))


def failing(where: Callable[[Floats], Any]) -> Function:
    return lambda x: np.where(where(x), np.nan, smooth(x))


FUNCTIONS: dict[str, Function] = {
    "smooth": smooth, "rough": rough, "flat": flat, "steps": steps, "huge": huge,
    "half of it fails": failing(lambda x: x[:, 0] > 0.5),
    "what is best fails": failing(lambda x: np.abs(x - 0.3).max(axis=1) < 0.2),
    "the middle fails": failing(lambda x: np.abs(x - 0.5).max(axis=1) < 0.2),
    "some fail here and there": failing(lambda x: np.sin(1e4 * x[:, 0]) > 0.5),
    "everything fails": failing(lambda x: np.ones(len(x), dtype=bool)),
}  # fmt: skip


@cache
def _case() -> Problem:
    """A problem that the driver needs besides a method; nothing of it is simulated."""
    campaign = load_file(next(iter(library().values())))
    return Problem(campaign, closed_loop(campaign, compiled=False, lanes=1))


Answer = tuple[Batch, dict[int, str]]


def driven(
    method: Method,
    evaluate: Callable[[Floats], Answer],
    budget: int,
    dimension: int = 2,
    minima: list[Minimum] | None = None,
    options: Any = None,
) -> Driven:
    """The method under the real driver."""
    store = MemoryStore()
    store.plan([StagePlan("search", method.name, budget)])
    context = Context(_case().campaign, _case(), cast("Any", evaluate), store)
    search = method.search(space(dimension, budget, minima), options or method.options())
    return drive(context, 0, search, budget, method.repeats)


def answering(function: Function, status: int) -> Callable[[Floats], Answer]:
    return lambda points: (batch(function(points), status), {})
