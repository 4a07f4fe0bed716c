"""The largest certified region of attraction {V < 1} of a polynomial loop about its origin that is found.

A quadratic V grows first, in coordinates in which it becomes round; then one of each higher degree, from the last.
What is returned was accepted by `campaigns.certificates.exact`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, Literal, NamedTuple

import numpy as np

from campaigns.certificates import exact
from campaigns.certificates.coordinates import Matrix, product, rows, transformed
from campaigns.certificates.exact import Bases, Certificate
from campaigns.certificates.polynomials import Polynomial, substituted
from worker.engine.attraction.iteration import Loop, as_form, grown, linear, linearised, multiplier, scaled
from worker.engine.attraction.rounding import certificate

DEGREES = {1: 6, 2: 6, 3: 4, 4: 2}
"""Of V by the number of states: with four states, degree 4 takes minutes."""
ROUNDS, PHASES = 15, 8
BACK = (1.0, 0.9999, 0.999, 0.99, 0.95)
"""Fractions of the level that are tried, because rounding needs room."""
FINENESS = 64
"""Of the entries of the triangular matrix of coordinates."""
Why = Literal["unstable", "no_region", "rounding"]
Stopping = Callable[[], bool]


class Region(NamedTuple):
    """{V < 1} in coordinates y, where x = matrix y."""

    matrix: Matrix
    certificate: Certificate


def found(
    flow: list[Polynomial], limits: Mapping[int, float], degree: int, stopping: Stopping = lambda: False
) -> Region | Why:
    """The region of an exact flow, within the limits of its states."""
    n, bounds = len(flow), {k: exact.coefficient(limit) for k, limit in limits.items()}
    if np.linalg.eigvals(linearised(flow)).real.max() >= 0.0:
        return "unstable"
    matrix = scaling(_scales(flow, bounds))
    loop, v = _loop(flow, bounds, matrix, 2), None
    for _ in range(PHASES):
        first = scaled(loop, linear(linearised(loop.flow)) if v is None else v)
        v = _grown(loop, first, stopping)
        if v is None:
            return "no_region"
        if v is first:
            break
        turned = rounding(as_form(v, n))
        matrix = product(matrix, turned)
        v = substituted(v, _floats(rows(turned)))
        loop = _loop(flow, bounds, matrix, 2)
    for higher in range(4, degree + 1, 2):
        loop = _loop(flow, bounds, matrix, higher)
        v = _grown(loop, v, stopping)
    return "no_region" if v is None else _exactly(flow, bounds, matrix, loop, v)


# Coordinates x = T y in which a quadratic form is nearly |y|^2, exactly: T and its inverse are multiples of 2^-k. A
# unit triangular matrix of such numbers has an inverse of such numbers, and so has a power of two.


def scaling(scales: Any) -> Matrix:
    """Diagonal, of powers of two."""
    return [
        [Fraction(2) ** round(float(np.log2(s))) if i == k else Fraction(0) for k in range(len(scales))]
        for i, s in enumerate(scales)
    ]


def rounding(form: Any) -> Matrix:
    """The coordinates y = D U x, from the rounded Cholesky factor, in which x' form x is nearly |y|^2."""
    factor = np.linalg.cholesky(form).T
    size = np.diag(factor)
    upper = np.rint(factor / size[:, None] * FINENESS)
    n = len(form)
    inverse: Matrix = [[Fraction(int(i == k)) for k in range(n)] for i in range(n)]
    for i in reversed(range(n)):
        for j in range(i + 1, n):
            u = Fraction(int(upper[i, j]), FINENESS)
            inverse[i] = [a - u * b for a, b in zip(inverse[i], inverse[j], strict=True)]
    powers = [Fraction(2) ** -round(float(np.log2(d))) for d in size]
    return [[a * p for a, p in zip(row, powers, strict=True)] for row in inverse]


def _loop(flow: list[Polynomial], bounds: Mapping[int, Fraction], matrix: Matrix, degree: int) -> Loop:
    """The loop in these coordinates, in floats; of four states, a multiplier of degree 2 is what time permits."""
    half = degree // 2 if len(flow) < 3 else 1
    inside, limits = transformed(flow, bounds, matrix)
    return Loop(_floats(inside), degree, half, _floats(limits))


def _floats(polynomials: list[Polynomial]) -> list[Polynomial]:
    return [{m: float(c) for m, c in p.items()} for p in polynomials]


def _scales(flow: list[Polynomial], bounds: Mapping[int, Fraction]) -> Any:
    """Powers of two near the extents of the ellipsoid of the linearised loop within the limits; ones without limits."""
    n = len(flow)
    scales = np.ones(n)
    for _ in range(6 if bounds else 0):
        a = linearised(flow) * scales / scales[:, None]
        spread = np.linalg.inv(as_form(linear(a), n))
        level = min(1.0 / (float(c) * scales[k] ** 2 * spread[k, k]) for k, c in bounds.items())
        scales = 2.0 ** np.rint(np.log2(scales * np.sqrt(level * np.diag(spread))))
    return scales


def _grown(loop: Loop, v: Polynomial | None, stopping: Stopping) -> Polynomial | None:
    """The last V of the rounds; None if the first is not certified."""
    last = None
    for one in grown(loop, ROUNDS, v) if v is not None else ():
        last = one
        if stopping():
            break
    return last


def _exactly(
    flow: list[Polynomial], bounds: Mapping[int, Fraction], matrix: Matrix, loop: Loop, v: Polynomial
) -> Region | Why:
    """The largest region of V whose certificate holds in rational arithmetic."""
    true, limits = transformed(flow, bounds, matrix)
    for back in BACK:
        smaller = {m: c / back for m, c in v.items()}
        solved = multiplier(loop, smaller)
        if solved is None:
            continue
        program, _, x = solved
        # in the order of the program: the multiplier, the decrease, positivity, the limits
        s, decrease, *positive = (program.gram(x, k) for k in range(len(program.grams)))
        bases = Bases.of(true, loop.degree, loop.half)
        rounded = certificate(smaller, [*positive, decrease], s, true, limits, bases)
        if not exact.wrong(rounded, true, limits):
            return Region(matrix, rounded)
    return "rounding"
