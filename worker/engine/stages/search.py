"""Search: one method looks for the lowest cost within its budget.

For a random method the result contains the statement that its sample allows, for DIRECT an estimate of the possible
improvement below its best.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from campaigns.asked.stages import Search as SearchRequest
from campaigns.results import SearchResult
from campaigns.results.search import Best
from campaigns.results.search import Minimum as MinimumFound
from worker.engine.search.base import Batch, Floats, Method, Minimum, Space
from worker.engine.stages.parts import front, gap, sample
from worker.engine.stages.parts.base import drive, stream
from worker.engine.stages.parts.context import Context, Driven
from worker.engine.stages.parts.ended import spoken
from worker.engine.stages.parts.members import Members
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.systems.base import slots

WARM = 2
"""Parameters of the function on which kernels are compiled."""


def run(context: Context, position: int) -> Outcome[SearchResult]:
    """Run the search stage that is planned at this position."""
    index = sum(planned.kind == "search" for planned in context.plan[:position])
    request = context.campaign.stages.search[index]
    method = context.methods[request.method]
    minima: list[Minimum] = []
    members = Members()
    space = Space(
        dimension=context.problem.dimension,
        budget=request.evaluations,
        random=stream(context.campaign.seed, index),
        starts=_starts(context, request),
        quantile=context.problem.quantile,
        report=minima.append,
        attribute=members.attribute,
        threshold=context.problem.threshold,
        confidence=context.campaign.confidence,
        slots=slots(context.problem.system),
    )
    options: Any = TypeAdapter(method.options).validate_python(request.options)
    if method.compiles:
        _warm(method, context.methods)
    search = members.listening(method.search(space, options))
    driven = drive(context, position, search, request.evaluations, method.repeats)
    minima.sort(key=lambda m: _place(m, space.starts))
    result = _result(context, method, options, driven, minima)
    rows = members.rows(driven.columns, context.methods, method.apart) if driven.columns else []
    leading = members.leading(driven.columns) if driven.columns else None
    known = None if leading is None else context.methods.get(leading)
    family = method.family_with(options) if known is None else known.family_with(known.options())
    apart = members.apart(driven.columns, context.methods, method.apart) if driven.columns else []
    return Outcome(result.model_copy(update={"members": rows, "family": family, "apart": apart}))


def _warm(method: Method, methods: Mapping[str, Method]) -> None:
    """Compile a method's kernels, so that compilation does not count as search time; those of a method with members
    are the kernels of any other."""
    if _with_members(method):
        for other in methods.values():
            if other.compiles:
                _with_members(other)


@cache
def _with_members(method: Method) -> bool:
    """Whether a method gives its evaluations to members, from a short search that compiles its kernels: on a bowl of
    few parameters, since what is compiled does not depend on their number."""
    members: list[str] = []
    left, starts = 100 * WARM, np.empty((0, WARM))
    bowl = Space(
        WARM, left, np.random.default_rng(0), starts, lambda u: u, lambda m: None, lambda m, k: members.append(m)
    )
    search = method.search(bowl, method.options())
    with suppress(StopIteration):
        points = next(search)
        while left > 0 and isinstance(points, np.ndarray):
            left -= len(points)
            costs = ((points - 0.4) ** 2).sum(axis=1, keepdims=True)
            points = search.send(Batch(costs, np.zeros(len(points), dtype=np.uint8)))
    search.close()
    return bool(members)


def _starts(context: Context, request: SearchRequest) -> Floats:
    points = [context.problem.point(start) for start in request.starts]
    return np.clip(np.array(points), 0.0, 1.0) if points else np.empty((0, context.problem.dimension))


def _place(minimum: Minimum, starts: Floats) -> int:
    """Minima are listed in the order of the campaign's starts, not in the order in which the descents ended."""
    same = [i for i, start in enumerate(starts) if minimum.start is not None and np.array_equal(start, minimum.start)]
    return same[0] if same else len(starts)


def _result(context: Context, method: Method, options: Any, driven: Driven, minima: list[Minimum]) -> SearchResult:
    problem, tally, columns = context.problem, driven.tally, driven.columns
    front_points, front_size = front.of_stage(problem, columns)
    return SearchResult(
        method=method.name,
        title=method.title,
        kind=method.kind,
        best=_best(context, driven),
        evaluations=tally.evaluations,
        failed=tally.failed,
        excluded=tally.excluded,
        seconds=tally.seconds,
        stop=driven.how,
        minima=[
            MinimumFound(
                start=None if m.start is None else problem.named(m.start),
                parameters=problem.named(m.point),
                point=m.point.tolist(),
                cost=m.cost,
                evaluations=m.evaluations,
                statement=spoken(m.text),
            )
            for m in minima
        ],
        sample=sample.of_search(context, method, options, columns) if method.kind == "random" and columns else None,
        gap=gap.estimate(problem, method, options, columns) if columns else None,
        criteria=front.criteria(problem),
        front=front_points,
        front_size=front_size,
    )


def _best(context: Context, driven: Driven) -> Best | None:
    problem, tally = context.problem, driven.tally
    if tally.best is None or tally.best_point is None:
        return None
    return Best(
        cost=tally.best,
        margin=tally.best - problem.threshold,
        parameters=problem.named(tally.best_point),
        index=tally.best_index,
    )


stage = Stage("search", run)
