"""Linear changes of coordinates x = T y of polynomial systems, in exact arithmetic."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from campaigns.certificates.polynomials import Polynomial, added, substituted, times

Matrix = list[list[Fraction]]


def inverted(matrix: Matrix) -> Matrix:
    """The inverse, by Gauss and Jordan."""
    n = len(matrix)
    both = [row[:] + [Fraction(int(i == k)) for k in range(n)] for i, row in enumerate(matrix)]
    for k in range(n):
        pivot = next(i for i in range(k, n) if both[i][k] != 0)
        both[k], both[pivot] = both[pivot], both[k]
        both[k] = [c / both[k][k] for c in both[k]]
        for i in range(n):
            if i != k and both[i][k] != 0:
                both[i] = [a - both[i][k] * b for a, b in zip(both[i], both[k], strict=True)]
    return [row[n:] for row in both]


def product(left: Matrix, right: Matrix) -> Matrix:
    columns = [*zip(*right, strict=True)]
    return [[sum((a * b for a, b in zip(row, c, strict=True)), Fraction(0)) for c in columns] for row in left]


def rows(matrix: Matrix) -> list[Polynomial]:
    """x as linear polynomials of y."""
    n = len(matrix)
    return [{tuple(int(i == k) for i in range(n)): c for k, c in enumerate(row)} for row in matrix]


def transformed(
    flow: list[Polynomial], limits: Mapping[int, Fraction], matrix: Matrix
) -> tuple[list[Polynomial], list[Polynomial]]:
    """dy/dt, and the squares of the limited states relative to their limits, c x^2, in these coordinates."""
    states = rows(matrix)
    inside = [substituted(p, states) for p in flow]
    fresh = [added(*zip(row, inside, strict=True)) for row in inverted(matrix)]
    squared = [added((c, times(states[k], states[k]))) for k, c in limits.items()]
    return [{m: c for m, c in p.items() if c != 0} for p in fresh], squared
