"""Search: one method looks for the lowest cost within its budget.

For a random method the result holds the statement that its sample allows, for DIRECT an estimate of what it may have
missed. Start reading at `run`.
"""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from campaigns.asked.stages import Search as Asked
from worker.catalogue.installed import methods
from worker.search.base import Batch, Floats, Method, Minimum, Space
from worker.stages.parts import front, gap, sample
from worker.stages.parts.base import Context, Driven, drive
from worker.stages.parts.members import Members


def run(context: Context, position: int, index: int) -> dict[str, Any]:
    """Run search stage number `index` of the campaign, stored at `position`."""
    asked = context.campaign.stages.search[index]
    method = methods()[asked.method]
    minima: list[Minimum] = []
    members = Members()
    space = Space(
        dimension=context.problem.dimension,
        budget=asked.evaluations,
        random=stream(context.campaign.seed, index),
        starts=_starts(context, asked),
        quantile=context.problem.quantile,
        report=minima.append,
        attribute=members.attribute,
        threshold=context.problem.threshold,
        confidence=context.campaign.confidence,
    )
    options: Any = TypeAdapter(method.options).validate_python(asked.options)
    if method.compiles:
        _warm(method.name, space.dimension)
    search = members.listening(method.search(space, options))
    driven = drive(context, position, search, asked.evaluations, method.repeats)
    minima.sort(key=lambda m: _place(m, space.starts))
    told = _result(context, method, options, driven, minima)
    return told | {"members": members.told(driven.columns) if driven.columns else []}


@cache
def _warm(name: str, dimension: int) -> None:
    """Let a method compile what it compiles, on a bowl of its own: that is no time of the search, and done once."""
    method, budget = methods()[name], 100 * dimension
    bowl = Space(dimension, budget, np.random.default_rng(0), np.empty((0, dimension)), lambda u: u, lambda m: None)
    search = method.search(bowl, method.options())
    with suppress(StopIteration):
        points = next(search)
        while budget > 0:
            budget -= len(points)
            costs = ((points - 0.4) ** 2).sum(axis=1, keepdims=True)
            points = search.send(Batch(costs, np.zeros(len(points), dtype=np.uint8)))
    search.close()


def stream(seed: int, index: int) -> np.random.Generator:
    """The random numbers of search stage `index`: independent of every other stage and of who flies it."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))


def _starts(context: Context, asked: Asked) -> Floats:
    points = [context.problem.point(start) for start in asked.starts]
    return np.clip(np.array(points), 0.0, 1.0) if points else np.empty((0, context.problem.dimension))


def _place(minimum: Minimum, starts: Floats) -> int:
    """Minima are told in the order of the campaign's starts, not in the order in which the descents happened to end."""
    same = [i for i, start in enumerate(starts) if minimum.start is not None and np.array_equal(start, minimum.start)]
    return same[0] if same else len(starts)


def _result(context: Context, method: Method, options: Any, driven: Driven, minima: list[Minimum]) -> dict[str, Any]:
    problem, tally, columns = context.problem, driven.tally, driven.columns
    best = None
    if tally.best is not None and tally.best_point is not None:
        best = {
            "cost": tally.best,
            "margin": tally.best - problem.threshold,
            "parameters": problem.named(tally.best_point),
            "index": tally.best_index,
        }
    return {
        "method": method.name,
        "title": method.title,
        "kind": method.kind,
        "best": best,
        "evaluations": tally.evaluations,
        "failed": tally.failed,
        "excluded": tally.excluded,
        "seconds": tally.seconds,
        "stop": {"kind": driven.stop, "text": driven.text},
        "minima": [
            {
                "start": None if m.start is None else problem.named(m.start),
                "parameters": problem.named(m.point),
                "point": m.point.tolist(),
                "cost": m.cost,
                "evaluations": m.evaluations,
                "text": m.text,
            }
            for m in minima
        ],
        "sample": sample.of_search(context, options, columns) if method.kind == "random" and columns else None,
        "gap": gap.estimate(problem, method.name, options, columns) if columns else None,
    } | front.told(problem, columns)
