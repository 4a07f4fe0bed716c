"""A population with several costs, as in NSGA-II: its fronts, crowding distances, survivors and tournaments.

Deb, Pratap, Agarwal and Meyarivan (IEEE Transactions on Evolutionary Computation 6, 2002), sections III A to C, and the
paper's rule for constraints: a point without costs ranks behind all others.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from worker.engine.kernels.cached import compiled
from worker.engine.search.base import Floats
from worker.engine.search.racing.state import Ints, inner

Rows = NDArray[np.intp]
Flags = NDArray[np.bool_]


class Population(NamedTuple):
    """Points (m, n), costs (m, k), whether they have any (m,), and, if so, front and crowding distance (m,)."""

    points: Floats
    costs: Floats
    valued: Flags
    front: Ints
    crowding: Floats


def survivors(random: np.random.Generator, points: Floats, costs: Floats, valued: Flags, count: int) -> Population:
    """The best of the points, at most so many: front by front, of the last one the least crowded."""
    rows = np.flatnonzero(valued)
    front, crowding = np.zeros(len(points), dtype=np.int64), np.zeros(len(points))
    front[rows] = _ranks(costs[rows], np.lexsort(costs[rows].T[::-1]))
    chosen: list[Rows] = []
    left = min(count, len(rows))
    order = rows[np.argsort(front[rows], kind="stable")]
    for members in np.split(order, np.flatnonzero(np.diff(front[order])) + 1):
        if left == 0:
            break
        crowding[members] = _crowding(costs[members])
        if len(members) > left:
            shuffled = members[random.permutation(len(members))]
            members = shuffled[np.argsort(crowding[shuffled])[::-1][:left]]
        chosen.append(members)
        left -= len(members)
    lost = np.flatnonzero(~valued)
    last = lost[np.argsort(np.ones(len(lost)))]  # not stable, as pymoo sorts equal violations
    best = np.concatenate([*chosen, last])[:count]
    return Population(points[best], costs[best], valued[best], front[best], crowding[best])


@compiled
def _ranks(costs: Floats, order: Rows) -> Ints:
    """The number of the front of each row of costs (m, k), given their lexicographic order.

    Zhang, Tian, Cheng and Jin, An efficient approach to nondominated sorting (IEEE Trans. Evol. Comput. 19, 2015).
    """
    rank = np.zeros(len(costs), np.int64)
    last = np.full(len(costs) + 1, -1)
    before = np.full(len(costs), -1)
    for i in order:
        while True:
            other = last[rank[i]]
            while other >= 0 and not _dominates(costs[other], costs[i]):
                other = before[other]
            if other < 0:
                break
            rank[i] += 1
        before[i] = last[rank[i]]
        last[rank[i]] = i
    return rank


@inner
def _dominates(one: Floats, other: Floats) -> bool:
    """Whether the first is nowhere higher and somewhere lower."""
    lower = False
    for a, b in zip(one, other):  # noqa: B905  numba has no strict
        if a > b:
            return False
        lower = lower or a < b
    return lower


def _crowding(costs: Floats) -> Floats:
    """The crowding distance of each point of a front by its costs (m, k), infinite at the ends."""
    m, k = costs.shape
    if m <= 2:
        return np.full(m, np.inf)
    order = np.argsort(costs, axis=0, kind="stable")
    columns = np.arange(k)
    ordered = costs[order, columns]
    steps = np.concatenate([ordered, np.full((1, k), np.inf)]) - np.concatenate([np.full((1, k), -np.inf), ordered])
    extent = ordered[-1] - ordered[0]
    parts = np.divide(steps, extent, out=np.zeros_like(steps), where=extent != 0.0)
    place = np.argsort(order, axis=0)
    distances: Floats = (parts[:-1][place, columns] + parts[1:][place, columns]).sum(axis=1) / k
    return distances


def tournaments(random: np.random.Generator, population: Population, count: int) -> Rows:
    """The winners (count,) of tournaments of two: by front, then by crowding distance, then by chance."""
    size = len(population.points)
    drawn = np.concatenate([random.permutation(size) for _ in range(-(-2 * count // size))])
    one, other = drawn[: 2 * count].reshape(count, 2).T
    valued, crowding = population.valued, population.crowding
    rank = np.where(valued, population.front, size)
    spread = np.where(valued, crowding, 0.0)
    better = (rank[one] < rank[other]) | ((rank[one] == rank[other]) & (spread[one] > spread[other]))
    equal = (rank[one] == rank[other]) & (spread[one] == spread[other])
    better[equal] = random.integers(2, size=int(equal.sum())) == 0
    return np.where(better, one, other)
