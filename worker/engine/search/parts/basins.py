"""Which local minima are distinct: descents from many points, then a test for a barrier between their ends.

Ursem, Multinational evolutionary algorithms (CEC 1999), for the hill-valley test; Preuss, Niching the CMA-ES via
nearest-better clustering (GECCO 2010), for the choice of points to descend from.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from worker.engine.search.base import Batch, Floats
from worker.engine.search.parts.basin import GAIN, ROUGH, Basin, Rules, close, lower
from worker.engine.search.parts.polish import Polish, polished

BETWEEN = np.array([0.5, 0.25, 0.75])
"""Positions on the straight line between two minima at which a barrier is tested."""
WAVE = 4
"""Descents side by side from candidates that are alone; half as many as are listed, if that is more."""
NEAREST = 3
"""Number of nearest minima that each minimum is compared with."""
LOOKED_AT = 2000
"""The lowest evaluations among which points to descend from are chosen: the choice compares every pair."""


def promising(points: Floats, ranked: Floats, at_most: int, further: float = np.inf) -> NDArray[np.int64]:
    """Rows of points (m, n) to descend from: low, and far from anything lower (nearest-better distance).

    ranked (m,): costs, infinite if there is no cost. The lowest comes first; returns at most `at_most` rows, of which
    up to a quarter are the lowest that are `further` than this from anything lower.
    """
    order = np.argsort(ranked, kind="stable")[:LOOKED_AT]
    order = order[np.isfinite(ranked[order])]
    if len(order) <= 1:
        return order
    low = points[order]
    nearest = np.empty(len(order))
    nearest[0] = np.inf
    for first in range(1, len(order), 256):
        rows = np.arange(first, min(first + 256, len(order)))
        apart = np.abs(low[rows, None, :] - low[None, : rows[-1] + 1, :]).max(axis=2)
        apart[np.arange(rows[-1] + 1)[None, :] >= rows[:, None]] = np.inf
        nearest[rows] = apart.min(axis=1)
    lowest = np.flatnonzero(nearest > further)[: at_most // 4]
    furthest = np.argsort(-nearest, kind="stable")
    others = furthest[~np.isin(furthest, lowest)][: at_most - len(lowest)]
    return np.asarray(order[np.sort(np.concatenate([lowest, others]))])


def spread(points: Floats, ranked: Floats, cell: float) -> NDArray[np.int64]:
    """Rows of points (m, n): the lowest in every cell of this size, so that no valley hides the others."""
    order = np.argsort(ranked, kind="stable")
    order = order[np.isfinite(ranked[order])]
    _, first = np.unique(np.floor(points[order] / cell).astype(np.int64), axis=0, return_index=True)
    return order[np.sort(first)]


def downhill(basin: Basin, points: Floats, ranked: Floats, distance: float) -> float:
    """Move a basin along evaluated points (m, n): to the lowest within a third of `distance`, or else to the nearest
    lower one within it, until none is lower there. Returns how far the nearest lower one is, infinity if none is."""
    while True:
        apart = np.abs(points - basin.point).max(axis=1, initial=0.0)
        lower = np.where(ranked < basin.cost, apart, np.inf)
        nearest = float(lower.min(initial=np.inf))
        if nearest >= distance:
            return nearest
        low = int(np.argmin(np.where(apart < distance / 3, ranked, np.inf) if nearest < distance / 3 else lower))
        basin.point, basin.cost = points[low].copy(), float(ranked[low])


def distinct(
    points: Floats, costs: Floats, rules: Rules, found: list[Basin], polish: Polish
) -> Generator[Floats, Batch, str]:
    """Descend from candidate points (c, n) of known costs (c,), merge ends in the same basin, and polish each basin.

    `found` contains the current basins after every step, lowest first, so that none is lost when the budget ends.
    """
    ends = [Basin(p.copy(), float(c), [i]) for i, (p, c) in enumerate(zip(points, costs, strict=True))]
    found[:] = close(ends, rules.distance / 3)
    yield from _assigned(found, rules)
    found[rules.at_most :] = [b for b in found[rules.at_most :] if not rules.followed.isdisjoint(b.members)]
    yield from polished(found, rules, polish)
    yield from _merge(found, list(found), [], rules)
    return "polished every distinct minimum"


def added(found: list[Basin], fresh: list[Basin], rules: Rules) -> Generator[Floats, Batch, None]:
    """Add fresh basins, polished ones, that are of no valley known."""
    yield from _merge(found, [*found, *fresh], [], rules)


def _assigned(found: list[Basin], rules: Rules) -> Generator[Floats, Batch, None]:
    """Leave one basin for each valley. A candidate that a line connects with a lower one needs no descent; from those
    that are alone descents begin, a few at a time, the lowest first, until they find no further valley to list."""
    alone = [b for b in found[1:] if rules.followed.isdisjoint(b.members) and not rules.alone.isdisjoint(b.members)]
    settled: list[Basin] = []
    yield from _settled(found, settled, [b for b in found if not any(b is a for a in alone)], rules)
    wave = max(WAVE, rules.at_most // 2)
    while alone:
        some, before = alone[:wave], len(settled)
        del alone[:wave]
        yield from _settled(found, settled, some, rules, descents=True)
        if len(settled) == before or not any(b is s for b in settled[: rules.at_most] for s in some):
            yield from _settled(found, settled, alone, rules)
            return


def _settled(
    found: list[Basin], settled: list[Basin], fresh: list[Basin], rules: Rules, descents: bool = False
) -> Generator[Floats, Batch, None]:
    """Add `fresh` candidates to the `settled` minima: joined along lines, unless all are to descend, or descended from
    and merged. `found` has both and the others at any time."""
    if not descents:
        yield from _joined(found, settled, fresh, rules)
    yield from lower(fresh, replace(ROUGH, gain=GAIN * rules.barrier))
    settled += fresh
    rest = [b for b in found if not any(b is s for s in settled)]
    yield from _merge(found, settled, rest, rules)


def _joined(
    found: list[Basin], settled: list[Basin], fresh: list[Basin], rules: Rules
) -> Generator[Floats, Batch, None]:
    """Candidates whose line to the nearest lower one has no rise above the barrier join it.

    The middle of all lines comes first, then the quarters of those that are longer than `distance`.
    """
    known = sorted([*settled, *fresh], key=lambda b: b.cost)
    pairs = []
    for i, basin in enumerate(known[1:], 1):
        if any(basin is b for b in fresh) and rules.followed.isdisjoint(basin.members):
            pairs.append((basin, min(known[:i], key=lambda k: float(np.abs(k.point - basin.point).max()))))
    if not pairs:
        return
    starts, ends = (np.array([pair[side].point for pair in pairs]) for side in (0, 1))
    values = np.full((len(pairs), 5), np.nan)
    values[:, 0], values[:, 4] = np.array([[basin.cost, lower.cost] for basin, lower in pairs]).T
    rows = np.arange(len(pairs))
    for columns in ([2], [1, 3]):
        if len(columns) > 1:
            rows = rows[np.abs(ends[rows] - starts[rows]).max(axis=1, initial=0.0) > rules.distance]
        if not len(rows):
            break
        at = np.array(columns)
        lines = starts[rows, None, :] + (at / 4)[None, :, None] * (ends - starts)[rows, None, :]
        batch = yield lines.reshape(-1, starts.shape[1])
        values[rows[:, None], at[None, :]] = batch.ranked().reshape(len(rows), -1)
        rows = rows[_joins(values[rows], rules)]
    for row in reversed(np.flatnonzero(_joins(values, rules)).tolist()):  # the highest first
        basin, lower = pairs[row]
        lower.members += basin.members
        for basins in (found, fresh):
            basins[:] = [b for b in basins if b is not basin]


def _joins(values: Floats, rules: Rules) -> NDArray[np.bool_]:
    """Whether each line has no barrier: it neither rises by more than one nor, between ends at or below the
    ceiling, above that."""
    below = (values[:, 0] <= rules.ceiling) & (np.fmax.reduce(values, axis=1) > rules.ceiling)
    return np.asarray((_rise(values) <= rules.barrier) & ~below)


def _rise(values: Floats) -> Floats:
    """The largest rise along each line above the lowest value before it; NaN is not evaluated."""
    lowest = np.fmin.accumulate(values, axis=1)
    return np.asarray(np.nan_to_num(values - lowest, nan=0.0, posinf=np.inf).max(axis=1, initial=0.0))


def _merge(found: list[Basin], ends: list[Basin], rest: list[Basin], rules: Rules) -> Generator[Floats, Batch, None]:
    """Merge the ends of descents, lowest first: each joins one of the nearest lower ones unless there is a barrier in
    between. `found` has them, and the rest."""
    waiting = close(ends, rules.distance)
    kept: list[Basin] = []
    while waiting:
        basin = waiting.pop(0)
        near = sorted(kept, key=lambda k: float(np.abs(k.point - basin.point).max()))[:NEAREST]
        joined = None
        if near:
            line = BETWEEN[None, :, None]
            others = np.array([k.point for k in near])[:, None, :]
            batch = yield (others + line * (basin.point - others)).reshape(-1, len(basin.point))
            heights = batch.ranked().reshape(len(near), len(BETWEEN))
            most = basin.cost + rules.barrier
            most = min(most, rules.ceiling) if basin.cost <= rules.ceiling else most
            connected = (heights <= most).all(axis=1)
            joined = near[int(np.argmax(connected))] if connected.any() else None
        if joined is None:
            kept.append(basin)
        else:
            joined.members += basin.members
        ends[:] = sorted(kept + waiting, key=lambda b: b.cost)
        found[:] = sorted(ends + rest, key=lambda b: b.cost)
