"""DIRECT: divides the box into ever smaller rectangles, wherever some Lipschitz constant makes one promising.

Jones, Perttunen, Stuckman, Lipschitzian optimization without the Lipschitz constant (JOTA 79, 1993), sections 4-6:
size from centre to vertex, every tie divided, eps = 1e-4. All potentially optimal rectangles of an iteration are
evaluated as one batch. Deterministic; converges to the global minimum of a continuous function, at no known rate.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from campaigns.effort import Iterations
from worker.engine.search.base import Ended, Floats, Method, MethodLook, Search, Space

Ints = NDArray[np.int64]

DEEPEST = 30
"""The largest number of divisions per side: 3^-30 is 5e-15, below which centres are no longer distinct."""

MOST = 10_000_000
"""The largest number of iterations; each makes at least two evaluations."""

TIE = 1e-12
"""Values this close, relatively, are ties: otherwise rounding would distinguish mirrored rectangles."""


@dataclass(frozen=True)
class Options:
    """Stops at the first of: iterations, smallest size, budget."""

    iterations: Annotated[int, Field(ge=1, le=MOST, description="Maximum number of iterations")] = 10_000
    epsilon: Annotated[float, Field(ge=0, le=1, description="Jones' eps: smallest improvement worth a division")] = 1e-4
    smallest: Annotated[
        float, Field(ge=0, lt=1, description="Stop when the best rectangle's half diagonal is below this")
    ] = 0.0


class Boxes:
    """The rectangles: centre (n,), divisions of each side (n,), the value at the centre, whether it has none."""

    def __init__(self, dimension: int, capacity: int = 1024) -> None:
        self.count = 0
        self.centre: Floats = np.empty((capacity, dimension))
        self.depth: Ints = np.empty((capacity, dimension), dtype=np.int64)
        self.level: Ints = np.empty(capacity, dtype=np.int64)
        self.value: Floats = np.empty(capacity)
        self.lost: NDArray[np.bool_] = np.empty(capacity, dtype=np.bool_)
        self.near: Floats = np.empty(capacity)
        """For rectangles without a value: the lowest value nearby, infinity if there is none."""

    def add(self, centre: Floats, depth: Ints, value: Floats) -> None:
        """Append m rectangles."""
        last = self.count + len(value)
        while last > len(self.value):
            for name in ("centre", "depth", "level", "value", "lost", "near"):
                column = getattr(self, name)
                setattr(self, name, np.concatenate([column, np.empty_like(column)]))
        self.centre[self.count : last] = centre
        self.depth[self.count : last] = depth
        self.level[self.count : last] = depth.sum(axis=1)
        self.value[self.count : last] = value
        self.lost[self.count : last] = ~np.isfinite(value)
        self.count = last


def sizes(levels: Ints, dimension: int) -> Floats:
    """Half diagonals of rectangles by their level, the number of divisions summed over the sides.

    Sides of one rectangle differ by at most one division, so the level determines all sides.
    """
    whole, extra = np.divmod(levels, dimension)
    return 0.5 * np.sqrt((dimension - extra) * 9.0**-whole + extra * 9.0 ** -(whole + 1.0))


def promising(boxes: Boxes, epsilon: float, biased: bool = False) -> Ints:
    """Indices of the potentially optimal rectangles (definition 4.1), smallest first, including all ties.

    biased: the size is the longest side, and only the oldest of ties is included (Gablonsky, Kelley 2001).
    """
    n = boxes.count
    dimension = boxes.centre.shape[1]
    level, value = boxes.level[:n], boxes.value[:n]
    if biased:
        level = level // dimension
    lowest = np.full(int(level.max()) + 1, np.inf)
    np.minimum.at(lowest, level, value)
    present = np.flatnonzero(np.isfinite(lowest))[::-1]
    present = present[present < DEEPEST * (1 if biased else dimension)]
    size = 3.0 ** -present.astype(np.float64) if biased else sizes(present, dimension)
    chosen = present[_hull(size.tolist(), lowest[present].tolist(), epsilon)]
    limit = np.full(len(lowest), -np.inf)
    limit[chosen] = lowest[chosen] + TIE * np.abs(lowest[chosen])
    found = np.flatnonzero(value <= limit[level])
    found = found[np.argsort(-level[found], kind="stable")]
    return found[np.diff(level[found], prepend=-1) != 0] if biased else found


def _hull(size: list[float], lowest: list[float], epsilon: float) -> list[int]:
    """The points (size, lowest), in ascending size, that are on the lower right convex hull and pass the eps test."""
    if len(size) == 0:
        return []
    best = min(lowest)
    bottom = max(i for i, value in enumerate(lowest) if value == best)
    hull: list[int] = []
    slopes: list[float] = []  # from each point of the hull to the next
    for i in range(bottom, len(size)):
        slope = _slope(size, lowest, hull[-1], i) if hull else 0.0
        while slopes and slope < slopes[-1]:
            hull.pop()
            slopes.pop()
            slope = _slope(size, lowest, hull[-1], i)
        if hull:
            slopes.append(slope)
        hull.append(i)
    target = best - epsilon * abs(best)
    kept = [i for i, slope in zip(hull, slopes, strict=False) if lowest[i] - slope * size[i] <= target]
    return [*kept, hull[-1]]


def _slope(size: list[float], lowest: list[float], a: int, b: int) -> float:
    return (lowest[b] - lowest[a]) / (size[b] - size[a])


def search(space: Space, options: Options) -> Search:
    return divide(space.dimension, options)[1]


def divide(dimension: int, options: Options, biased: bool = False) -> tuple[Boxes, Search]:
    """The rectangles, none at first, and the search that adds them. biased: as in `promising`."""
    boxes = Boxes(dimension)
    return boxes, divided(boxes, options, biased)


def divided(boxes: Boxes, options: Options, biased: bool = False) -> Search:
    """One iteration is one request: the new centres of every potentially optimal rectangle. `boxes` is empty at
    first; the caller can read the division of the box from it. biased: as in `promising`."""
    n = boxes.centre.shape[1]
    centre = np.full((1, n), 0.5)
    batch = yield centre
    boxes.add(centre, np.zeros((1, n), dtype=np.int64), batch.ranked())
    _rescue(boxes, np.empty(0, dtype=np.int64), 0)
    for done in range(1, options.iterations + 1):
        parents = promising(boxes, options.epsilon, biased)
        if len(parents) == 0:
            return Ended(
                "resolution",
                "every rectangle is as small as floating-point numbers allow after {iterations} iterations",
                iterations=done - 1,
            )
        points, owners, sides = _new_centres(boxes, parents)
        batch = yield points
        first = boxes.count
        _divide(boxes, parents, points, owners, sides, batch.ranked())
        _rescue(boxes, parents, first)
        if options.smallest > 0.0:
            best = int(np.argmin(boxes.value[: boxes.count]))
            if float(sizes(boxes.level[best : best + 1], n)[0]) < options.smallest:
                return Ended(
                    "resolution",
                    "the best rectangle is smaller than {smallest:g} after {iterations} iterations",
                    smallest=options.smallest,
                    iterations=done,
                )
    return Ended("iterations", "completed the {iterations} iterations", iterations=options.iterations)


def _new_centres(boxes: Boxes, parents: Ints) -> tuple[Floats, Ints, Ints]:
    """Two new centres per longest side of every parent: points (2 k, n); which parent and which side (k,)."""
    depth = boxes.depth[parents]
    owners, sides = np.nonzero(depth == depth.min(axis=1, keepdims=True))
    step = 3.0 ** -(depth[owners, sides] + 1.0)
    points = np.repeat(boxes.centre[parents[owners]], 2, axis=0)
    k = np.arange(len(owners))
    points[2 * k, sides] -= step
    points[2 * k + 1, sides] += step
    return points, owners, sides


def _divide(boxes: Boxes, parents: Ints, points: Floats, owners: Ints, sides: Ints, values: Floats) -> None:
    """Divide every parent along its longest sides, the side with the lowest new value first: it keeps most volume."""
    mantissa, exponent = np.frexp(np.minimum(values[0::2], values[1::2]))
    lower = np.ldexp(np.round(mantissa / TIE) * TIE, exponent)
    order = np.lexsort((sides, lower, owners))
    owners, sides = owners[order], sides[order]
    first = np.flatnonzero(np.diff(owners, prepend=-1))
    alone = np.zeros((len(owners), boxes.centre.shape[1]), dtype=np.int64)
    alone[np.arange(len(owners)), sides] = 1
    so_far = np.cumsum(alone, axis=0)
    before = np.repeat(so_far[first] - alone[first], np.diff(first, append=len(owners)), axis=0)
    divided = so_far - before
    depth = boxes.depth[parents[owners]] + divided
    last = np.append(first[1:], len(owners)) - 1
    boxes.depth[parents[owners[last]]] = depth[last]
    boxes.level[parents[owners[last]]] = depth[last].sum(axis=1)
    children = np.repeat(2 * order, 2)
    children[1::2] += 1
    boxes.add(points[children], np.repeat(depth, 2, axis=0), values[children])


def _rescue(boxes: Boxes, divided: Ints, first: int) -> None:
    """Rank the rectangles whose centre has no value, after Gablonsky (2001, section 3.4.3).

    Such a rectangle takes the lowest value among the feasible centres inside it at twice its size, slightly raised: it
    is divided in turn but never before that neighbour. If there is none, it takes more than the highest value so far.
    `divided` have shrunk and those from `first` on are new since the last call; neighbours of the others are unchanged.
    """
    lost = np.flatnonzero(boxes.lost[: boxes.count])
    if len(lost) == 0:
        return
    feasible = np.flatnonzero(~boxes.lost[: boxes.count])
    changed = np.concatenate([divided[boxes.lost[divided]], lost[lost >= first]])
    same = lost[lost < first]
    boxes.near[same] = np.minimum(boxes.near[same], _lowest_near(boxes, same, feasible[feasible >= first]))
    boxes.near[changed] = _lowest_near(boxes, changed, feasible)
    highest = float(boxes.value[feasible].max()) if len(feasible) else 0.0
    near = boxes.near[lost]
    value = np.where(np.isfinite(near), near, highest + max(abs(highest), 1.0))
    boxes.value[lost] = value + 1e-6 * np.abs(value)


def _lowest_near(boxes: Boxes, rows: Ints, feasible: Ints) -> Floats:
    """The lowest value of these feasible centres within each rectangle at twice its size; infinity for none."""
    found = np.full(len(rows), np.inf)
    if len(feasible) == 0:
        return found
    centre, value = boxes.centre[feasible], boxes.value[feasible]
    for some in np.array_split(np.arange(len(rows)), -(-len(rows) * len(feasible) // 1_000_000) or 1):
        # Centres of equal rectangles are exactly one reach apart, except for rounding.
        reach = 3.0 ** -boxes.depth[rows[some]].astype(np.float64) * (1.0 + 1e-9)
        inside = np.ones((len(some), len(feasible)), dtype=np.bool_)
        for k in range(centre.shape[1]):
            inside &= np.abs(boxes.centre[rows[some], k, None] - centre[None, :, k]) <= reach[:, k, None]
        found[some] = np.where(inside, value, np.inf).min(axis=1)
    return found


def extend(options: Options, more: int) -> Options:
    """Enough iterations for `more` further evaluations, and no smallest size."""
    return replace(options, iterations=min(options.iterations + more, MOST), smallest=0.0)


method = Method(
    name="direct",
    title="DIRECT",
    kind="global",
    how="Global, deterministic. Divides the box",
    source="Jones, Perttunen, Stuckman 1993",
    evaluations=2000,
    options=Options,
    search=search,
    extend=extend,
    family="division of the box",
    whole_budget=True,
    effort=Iterations("iterations", each=5.6, growth=0.25, spread=(0.55, 1.6)),  # 0.60 to 1.47 in the library
    parallel="an iteration",
    suits="a first search that can be repeated exactly, few parameters",
    proposed=2,
    divide=divide,
    look=MethodLook(colour="#0072b2", dark="#3f9bdb", marker="square"),
)
