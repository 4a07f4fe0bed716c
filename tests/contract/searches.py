"""What the contract tests of search methods share: awkward functions and a method under the real driver."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import product
from typing import Any

import numpy as np
import pytest

from tests.unit.cases import campaign, case1
from tests.unit.searching import Function, batch, space
from worker.engine.search.base import Batch, Floats, Method, Minimum
from worker.engine.stages.parts.base import Context, Driven, drive
from worker.engine.stages.parts.store import StagePlan
from worker.running.catalogue.installed import methods
from worker.running.runs.store import MemoryStore

EACH = pytest.mark.parametrize("method", methods().values(), ids=lambda m: m.name)

BUDGET, COSTLY = 400, 24
"""Evaluations of a search; a costly method has at most the second number, and the full one in `make nightly`."""


def at_most(method: Method, budget: int) -> int:
    """The budget, or less for a method whose own time is milliseconds per evaluation."""
    return min(budget, COSTLY) if method.costly else budget


def with_each(names: Iterable[str], values: Sequence[int]) -> list[Any]:
    """(method, name, value) as parameters of a test: by day every pair of two of them once, at night all three."""
    return [
        pytest.param(method, name, value, id=f"{name}-{value}-{method.name}", marks=() if day else pytest.mark.nightly)
        for (i, method), (j, name), (k, value) in product(*map(enumerate, (methods().values(), names, values)))
        for day in [(i + j + k) % len(values) == 0]
    ]


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
    context = Context(campaign(), case1(), evaluate, store)
    search = method.search(space(dimension, budget, minima), options or method.options())
    return drive(context, 0, search, budget, method.repeats)


def answering(function: Function, status: int) -> Callable[[Floats], Answer]:
    return lambda points: (batch(function(points), status), {})
