"""Runs a search method on a plain function, without a campaign."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from campaigns.results.base import OK
from worker.engine.search.base import Batch, Floats, Method, Minimum, Search, Space

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


def run(
    method: Method,
    function: Function,
    dimension: int,
    budget: int,
    starts: Floats | None = None,
    seed: int = 1,
    status: int = 1,
    until: Callable[[Searched], bool] = lambda found: False,
    options: dict[str, Any] | None = None,
) -> Searched:
    """Run a method until it ends, its budget is reached or `until` is true; NaN values have `status`."""
    found = Searched()
    search: Search = method.search(
        space(dimension, budget, found.minima, starts, seed), method.options(**options or {})
    )
    asked = 0
    try:
        points = next(search)
        while True:
            found.batches.append(points.copy())
            asked += len(points)
            values = function(points)
            found.values.append(values)
            if asked >= budget or until(found):
                return found
            points = search.send(batch(values, status))
    except StopIteration as stopped:
        found.text = stopped.value
        return found
    finally:
        search.close()
