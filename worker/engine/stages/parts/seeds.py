"""The noise realisation of each evaluation, if a stage draws one per evaluation.

It is stated by the stage's result, or computed from the campaign's seed and the evaluation's index, so it is never
stored with the evaluation: the highest bits of
SplitMix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.spec import MAX_SEED
from worker.engine.stages.parts.base import Context, all_columns
from worker.engine.stages.parts.store import Columns
from worker.engine.systems.base import Seeds

_GAMMA = 0x9E3779B97F4A7C15
_BITS = MAX_SEED.bit_length() - 1
assert 1 << _BITS == MAX_SEED


def of_draws(seed: int, first: int, count: int) -> Seeds:
    """The realisations of the draws `first`, first + 1, ... of the certify stage of a campaign with this seed."""
    index = np.arange(first, first + count, dtype=np.uint64)
    stream = _mixed(np.array([seed + 1], dtype=np.uint64) * np.uint64(_GAMMA))
    mixed = _mixed(stream + (index + np.uint64(1)) * np.uint64(_GAMMA))
    return (mixed >> np.uint64(64 - _BITS)).astype(np.int64)


def stated(context: Context, positions: Iterable[int]) -> list[tuple[int, Columns]]:
    """The evaluations of these stages under the realisations stated in the campaign."""
    found = [(at, _rows(columns, _drawn(context, at), None)) for at, columns in all_columns(context, [*positions])]
    return [(at, columns) for at, columns in found if len(columns.status)]


def drawn(context: Context, positions: Iterable[int]) -> list[tuple[int, Columns, Seeds]]:
    """The evaluations of these stages that drew their own realisation, with its seed."""
    found = [(at, columns, _drawn(context, at)) for at, columns in all_columns(context, [*positions])]
    return [(at, _rows(columns, 0, count), _seeds(context, at, count)) for at, columns, count in found if count]


def _seeds(context: Context, position: int, drawn: int) -> Seeds:
    """The seeds of a stage's first evaluations: its own ones, or drawn."""
    result = context.results.get(position)
    if result is not None and result.seeds is not None:
        return np.array(result.seeds, dtype=np.int64)
    return of_draws(context.campaign.seed, 0, drawn)


def _drawn(context: Context, position: int) -> int:
    """The number of a stage's first evaluations that drew their own realisation."""
    result = context.results.get(position)
    return 0 if result is None else result.drawn


def _rows(columns: Columns, first: int, last: int | None) -> Columns:
    rows = slice(first, last)
    return Columns(columns.points[rows], columns.costs[rows], columns.status[rows], columns.seconds[rows], {})


def _mixed(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
