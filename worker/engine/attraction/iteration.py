"""Larger and larger regions of attraction {V < 1}: V-s iteration of Tan, Packard (IEEE Trans. Autom. Control 53, 2008).

Their shape function is replaced by the volume itself: its first-order change, as boundary points have it, is linear in
the coefficients of V. Every V between the old and the new one is certified by the same multiplier; the best is taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from campaigns.certificates.exact import Bases
from campaigns.certificates.polynomials import Polynomial, added, along, degree, monomials, times
from campaigns.certificates.rays import Floats, directions, radii, volume
from worker.engine.attraction.program import Program, at, combined, fixed, product

MARGIN = 1e-6
"""Of positivity and of decrease, times |x|^2."""
LEAST = 1e-7
"""Least eigenvalue of the Gram matrices, so that they can be rounded."""
RAYS = 400
PARTS = (1.0, 0.5, 0.25, 0.1, 0.02)
"""Parts of the way to the new V that are tried."""
FINER = 1.01
SMALLER = (1.0, 0.9, 0.7)
"""Levels of the region whose multiplier is used: at its largest level it leaves V no room."""
GAIN = 1e-3
"""Relative growth of the volume below which a round is the last."""


@dataclass(frozen=True)
class Loop:
    """A polynomial closed loop with an attractive origin, and the degrees of V and of the multiplier."""

    flow: list[Polynomial]
    """dx/dt."""
    degree: int
    half: int = 2
    """Half the degree of the multiplier."""
    limits: list[Polynomial] = field(default_factory=list)
    """Squares q of which q < 1 must hold in the region."""

    @property
    def n(self) -> int:
        return len(self.flow)

    @property
    def bases(self) -> Bases:
        return Bases.of(self.flow, self.degree, self.half)

    @property
    def size(self) -> Polynomial:
        return {tuple(2 * (i == k) for i in range(self.n)): MARGIN for k in range(self.n)}

    @property
    def one(self) -> Polynomial:
        return {(0,) * self.n: 1.0}


def linearised(flow: list[Polynomial]) -> Floats:
    """The matrix A of dx/dt = A x near the origin."""
    n = len(flow)
    unit = [tuple(int(i == k) for i in range(n)) for k in range(n)]
    return np.array([[float(f.get(m, 0.0)) for m in unit] for f in flow])


def linear(a: Floats) -> Polynomial:
    """x' P x of a stable linear loop, P A + A' P = -I."""
    n = len(a)
    both = np.kron(a.T, np.eye(n)) + np.kron(np.eye(n), a.T)
    p = np.linalg.solve(both, -np.eye(n).ravel()).reshape(n, n)
    unit = [tuple(int(i == k) for i in range(n)) for k in range(n)]
    return added(*((p[i, j], times({unit[i]: 1.0}, {unit[j]: 1.0})) for i in range(n) for j in range(n)))


def as_form(v: Polynomial, n: int) -> Floats:
    """The matrix of a quadratic form."""
    found = np.zeros((n, n))
    for m, c in v.items():
        i, k = (index for index in range(n) for _ in range(m[index]))
        found[i, k] += float(c) / 2.0
        found[k, i] += float(c) / 2.0
    return found


def multiplier(loop: Loop, v: Polynomial) -> Any:
    """The program of a multiplier s with which V decreases in {V < 1}, within all limits; None if there is none."""
    program = Program()
    s = program.squares(loop.bases.multiplier)
    inside = added((1.0, loop.one), (-1.0, v))
    known = fixed(added((-1.0, along(v, loop.flow)), (-1.0, loop.size)))
    program.is_squares(combined((1.0, known), (-1.0, product(s, inside))), loop.bases.decrease)
    for margin in (loop.size, *loop.limits):
        program.is_squares(fixed(added((1.0, v), (-1.0, margin))), loop.bases.positive)
    found = program.solved()
    return None if found is None or found[0] < LEAST else (program, s, found[1])


def function(loop: Loop, s: Polynomial, v: Polynomial) -> Polynomial | None:
    """The V that decreases with this multiplier and, to first order, has the largest region."""
    program = Program()
    fresh = program.free(monomials(loop.n, 2, loop.degree))
    for margin in (loop.size, *loop.limits):
        program.is_squares(combined((1.0, fresh), (-1.0, fixed(margin))), loop.bases.positive)
    flow = {u: along(p, loop.flow) for u, p in fresh.items()}
    inside = combined((1.0, fixed(loop.one)), (-1.0, fresh))
    decrease = combined((-1.0, flow), (-1.0, fixed(loop.size)), (-1.0, product(inside, s)))
    program.is_squares(decrease, loop.bases.decrease)
    weights, points = _boundary(v, loop.n)
    costs = {u: float(np.mean(weights * values(p, points))) for u, p in fresh.items()}
    found = program.solved(costs, LEAST)
    return None if found is None else at(fresh, found[1])


def _boundary(v: Polynomial, n: int) -> tuple[Any, Any]:
    """Boundary points of the region, and by how much an increase of V there shrinks it."""
    rays = directions(n, RAYS)
    far = radii(v, rays)
    points = rays * far[:, None]
    rising = sum(sum(m) * float(c) * np.prod(points ** np.array(m), axis=1) for m, c in v.items())
    weights = far**n / np.maximum(rising, 1e-3)
    return weights / weights.mean(), points


def values(p: Polynomial, points: Any) -> Any:
    return sum(float(c) * np.prod(points ** np.array(m), axis=1) for m, c in p.items())


def measured(v: Polynomial, n: int) -> float:
    return volume(radii(v, directions(n, RAYS)), n)


def grown(loop: Loop, rounds: int, v: Polynomial) -> Iterator[Polynomial]:
    """V of regions {V < 1} that grow; the first must be certified with a multiplier."""
    if multiplier(replace(loop, degree=degree(v)), v) is None:
        return
    size = measured(v, loop.n)
    yield v
    for _ in range(rounds):
        best = max(_rounds(loop, v), key=lambda one: one[0], default=(0.0, v))
        if not size * (1.0 + GAIN) < best[0] < np.inf:
            return
        size, v = best
        yield v


def _rounds(loop: Loop, v: Polynomial) -> Iterator[tuple[float, Polynomial]]:
    """V between that of a smaller region and the best one with its multiplier, and their volumes."""
    for back in SMALLER:
        smaller = {m: c / back for m, c in v.items()}
        # A V of lower degree has no room in the Gram matrix of a higher one.
        found = multiplier(replace(loop, degree=degree(v)), smaller)
        fresh = None if found is None else function(loop, at(found[1], found[2]), smaller)
        if fresh is not None:
            for part in PARTS:
                one = added((part, fresh), (1.0 - part, smaller))
                yield measured(one, loop.n), one


def scaled(loop: Loop, v: Polynomial | None) -> Polynomial | None:
    """V divided by the largest level, to a hundredth, whose region is certified; None if none is."""
    level, low, high = 1.0, None, None
    while v is not None and (low is None or high is None or high > FINER * low):
        if low is not None and high is not None:
            level = (low * high) ** 0.5
        if multiplier(loop, {m: c / level for m, c in v.items()}) is None:
            high, level = level, level / 4.0
        else:
            low, level = level, level * 4.0
        if not 1e-9 < level < 1e9:
            return None
    return None if v is None else {m: c / low for m, c in v.items()}
