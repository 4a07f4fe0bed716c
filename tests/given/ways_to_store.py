"""The ways in which a store gets evaluations: in order, ahead of an earlier one, or counted.

What a run without a verdict found is stated by whichever of them it was stored. Start reading at `WAYS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from campaigns.stored.blocks import Block, Scale, counted
from campaigns.stored.records import Ahead, Columns
from worker.engine.stages.parts.store import Store


def made(costs: Sequence[float]) -> Columns:
    """Evaluations of two parameters with these costs."""
    many = len(costs)
    first = np.array(costs, dtype=np.float64).reshape(many, 1)
    return Columns(np.full((many, 2), 0.5), first, np.zeros(many, dtype=np.uint8), 0.1 + np.arange(many), {})


def block(first: int, costs: Sequence[float]) -> Block:
    """Draws of a sample from this index on with these costs."""
    rows = made(costs)
    return counted(first, rows.points, rows.costs, rows.status, {}, Scale.over(rows.costs, 0.5), 0.5, 1.0)


def in_order(store: Store, position: int, costs: Sequence[float]) -> None:
    store.append(position, 0, made(costs[:1]))
    store.append(position, 1, made(costs[1:]))


def ahead(store: Store, position: int, costs: Sequence[float]) -> None:
    """The first of the stage has not ended."""
    store.append(position, 0, made([]), Ahead(1 + np.arange(len(costs)), made(costs)))


def in_blocks(store: Store, position: int, costs: Sequence[float]) -> None:
    store.count(position, [block(0, costs[:1]), block(1, costs[1:])])


def kept(store: Store, position: int, costs: Sequence[float]) -> None:
    """Counted, and the lowest of them stored."""
    in_blocks(store, position, costs)
    store.keep(position, made([min(costs)]))


WAYS: dict[str, Callable[[Store, int, Sequence[float]], None]] = {
    "in order": in_order,
    "ahead": ahead,
    "counted": in_blocks,
    "kept": kept,
}
