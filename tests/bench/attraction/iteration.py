"""Larger and larger regions of attraction: the V-s iteration of Tan, Packard (IEEE Trans. Autom. Control 53, 2008).

Every new V has to contain the last region enlarged by beta, as Khodadadi, Samadi, Khaloozadeh (2014) choose the shape.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.linalg

from tests.bench.attraction.polynomials import Monomial, Polynomial, added, along, degree, monomials, times
from tests.bench.attraction.program import Program, at, combined, fixed, product

MARGIN = 1e-6
"""Of positivity and of decrease, times |x|^2."""
LEAST = 1e-9
"""Least eigenvalue of a Gram matrix at which a program counts as feasible."""
HALVINGS = 10


@dataclass(frozen=True)
class Loop:
    """A polynomial closed loop with an attractive origin, and the degrees of V and of the multiplier."""

    field: list[Polynomial]
    degree: int
    half: int = 2
    """Half the degree of the multiplier."""

    @property
    def n(self) -> int:
        return len(self.field)

    @property
    def bases(self) -> dict[str, list[Monomial]]:
        n, flow = self.n, max(map(degree, self.field)) - 1
        most = max(self.degree + flow, 2 * self.half + self.degree)
        return {
            "square": [tuple(2 * (i == k) for i in range(n)) for k in range(n)],
            "positive": monomials(n, 1, self.degree // 2),
            "multiplier": monomials(n, 1, self.half),
            "decrease": monomials(n, 1, (most + 1) // 2),
        }

    @property
    def size(self) -> Polynomial:
        return dict.fromkeys(self.bases["square"], MARGIN)

    @property
    def one(self) -> Polynomial:
        return {(0,) * self.n: 1.0}


def linear(loop: Loop) -> Polynomial:
    """x' P x of the linearised loop, P A + A' P = -I."""
    n = loop.n
    unit = [tuple(int(i == k) for i in range(n)) for k in range(n)]
    a = np.array([[f.get(m, 0.0) for m in unit] for f in loop.field])
    p = scipy.linalg.solve_continuous_lyapunov(a.T, -np.eye(n))
    return added(*((p[i, j], times({unit[i]: 1.0}, {unit[j]: 1.0})) for i in range(n) for j in range(n)))


def largest(solved: Callable[[float], Any], low: float, high: float) -> tuple[float, Any]:
    """The largest level at which a program is feasible, and its solution there."""
    best = solved(low)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        found = solved(middle)
        low, high, best = (middle, high, found) if found is not None else (low, middle, best)
    return low, best


def multiplier(loop: Loop, v: Polynomial, level: float, least: float = LEAST) -> Any:
    """The program of a multiplier s with which V decreases in {V < level}; None if there is none."""
    program = Program()
    s = program.squares(loop.bases["multiplier"])
    inside = added((level, loop.one), (-1.0, v))
    known = fixed(added((-1.0, along(v, loop.field)), (-1.0, loop.size)))
    program.is_squares(combined((1.0, known), (-1.0, product(s, inside))), loop.bases["decrease"])
    return _feasible(program, s, least)


def function(loop: Loop, s: Polynomial, shape: Polynomial, beta: float) -> Any:
    """The program of a V that decreases with this multiplier and whose region contains {shape <= beta}."""
    program = Program()
    v = program.free(monomials(loop.n, 2, loop.degree))
    program.is_squares(combined((1.0, v), (-1.0, fixed(loop.size))), loop.bases["positive"])
    flow = {u: along(p, loop.field) for u, p in v.items()}
    inside = combined((1.0, fixed(loop.one)), (-1.0, v))
    decrease = combined((-1.0, flow), (-1.0, fixed(loop.size)), (-1.0, product(inside, s)))
    program.is_squares(decrease, loop.bases["decrease"])
    half = max(0, (loop.degree - degree(shape) + 1) // 2) + 1
    reach = product(program.squares(monomials(loop.n, 0, half)), added((beta, loop.one), (-1.0, shape)))
    program.is_squares(combined((1.0, inside), (-1.0, reach)), monomials(loop.n, 0, half + (degree(shape) + 1) // 2))
    return _feasible(program, v, LEAST)


def grown(loop: Loop, rounds: int, start: Polynomial) -> Iterator[Polynomial]:
    """V of regions {V < 1} that grow, each as large as its own multiplier permits."""
    v, high = start, 8.0
    for _ in range(rounds):
        # The first V is quadratic: with the products of a higher degree its Gram matrix would be singular.
        own = replace(loop, degree=degree(v))
        level, found = largest(lambda g, v=v, own=own: multiplier(own, v, g), 1e-3, high)
        if found is None:
            return
        v, high = {m: c / level for m, c in v.items()}, 1.5
        yield v
        s = at(found[1], found[2])
        _, fresh = largest(lambda b, v=v, s=s: function(loop, s, v, b), 0.98, 1.4)
        if fresh is None:
            return
        v = at(fresh[1], fresh[2])


def _feasible(program: Program, p: Any, least: float) -> Any:
    """The program, the polynomial that it was solved for, and the unknowns; None if it is not feasible."""
    found = program.solved()
    return None if found is None or found[0] < least else (program, p, found[1])
