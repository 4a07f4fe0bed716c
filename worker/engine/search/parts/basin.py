"""A basin, the lowest point known of a valley, and the descents that lower it; when two of them count as one."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from worker.engine.search.base import Batch, Floats, Search, side_by_side
from worker.engine.search.parts.descent import Settings, descend

ROUGH = Settings(differences="forward", iterations=25, apart=True)
"""Settings of the descents that assign points to basins."""
GAIN, SMALL = 0.02, 1e-9
"""Fractions of the barrier: by less, two steps of a descent together no longer count when it assigns points to basins,
and when it polishes."""


@dataclass(frozen=True)
class Rules:
    """Two minima are merged if they are closer than `distance` (largest fraction of any range) or have no barrier above
    `barrier` (in the cost's unit) between them; at most `at_most` are retained, and those of the candidates
    `followed` (by index). Those that are `alone` have nothing lower near: they may be of valleys of their own.
    Where a compass search still gains more than `rugged` (in the cost's unit), evolution strategies may follow.
    Costs are the same that differ by less than `same`.
    Two minima at or below the `ceiling` are not merged if a point between them is above it."""

    distance: float
    barrier: float
    at_most: int
    followed: frozenset[int] = frozenset()
    alone: frozenset[int] = frozenset()
    rugged: float = 0.0
    same: float = 0.0
    ceiling: float = np.inf


@dataclass
class Basin:
    """A distinct minimum: its lowest point (n,) and cost, and the candidates (by index) that ended in it."""

    point: Floats
    cost: float
    members: list[int]


def close(basins: list[Basin], distance: float) -> list[Basin]:
    """The basins, lowest first; those closer than `distance` to a lower one are merged into it."""
    kept: list[Basin] = []
    for basin in sorted(basins, key=lambda b: b.cost):
        near = next((k for k in kept if np.abs(k.point - basin.point).max() < distance), None)
        if near is None:
            kept.append(basin)
        else:
            near.members += basin.members
    return kept


def lower(basins: list[Basin], settings: Settings) -> Generator[Floats, Batch, None]:
    """SQP from every basin in parallel; a descent that ends no lower than it started changes nothing."""
    if basins:
        yield from side_by_side([lowered(basin, settings) for basin in basins])
    basins.sort(key=lambda b: b.cost)


def lowered(basin: Basin, settings: Settings) -> Search:
    """SQP from one basin."""
    end = yield from descend(basin.point, settings)
    if end.cost < basin.cost:
        basin.point, basin.cost = end.point.copy(), end.cost
    return end.text
