"""The noise realisation of each evaluation, if a stage draws one per evaluation.

It is that of the baseline's finding, or computed from the seed of the sample and the evaluation's index
(`campaigns.results.draws`), so it is never stored with the evaluation.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from campaigns.results.draws import of_draws
from campaigns.stored.records import Columns
from worker.engine.stages.parts.base import all_columns
from worker.engine.stages.parts.context import Context
from worker.engine.systems.base import Seeds


def stated(context: Context, positions: Iterable[int]) -> list[tuple[int, Columns]]:
    """The evaluations of these stages under the realisations stated in the campaign."""
    found = [(at, some(columns, _drawn(context, at))) for at, columns in all_columns(context, [*positions])]
    return [(at, columns) for at, columns in found if len(columns.status)]


def drawn(context: Context, positions: Iterable[int]) -> list[tuple[int, Columns, Seeds]]:
    """The evaluations of these stages that drew their own realisation, with its seed."""
    found = [(at, columns, _drawn(context, at)) for at, columns in all_columns(context, [*positions])]
    return [(at, some(columns, 0, count), _seeds(context, at, count)) for at, columns, count in found if count]


def _seeds(context: Context, position: int, drawn: int) -> Seeds:
    """The seeds of a stage's first evaluations: its own ones, or drawn."""
    result = context.results.get(position)
    if result is not None and result.seeds is not None:
        return np.array(result.seeds, dtype=np.int64)
    return of_draws(context.sample_seed.value, 0, drawn)


def _drawn(context: Context, position: int) -> int:
    """The number of a stage's first evaluations that drew their own realisation."""
    result = context.results.get(position)
    return 0 if result is None else result.drawn


def some(columns: Columns, first: int, last: int | None = None) -> Columns:
    """Some evaluations of a stage, without the reasons of those that failed."""
    rows = slice(first, last)
    return Columns(columns.points[rows], columns.costs[rows], columns.status[rows], columns.seconds[rows], {})
