"""The exact check of a certificate: rational coefficients, Gram matrices projected onto the identities, L D L^T.

Peyrl, Parrilo (Theor. Comput. Sci. 409, 2008): a solution inside is rounded, and its residual spread over the entries.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from tests.bench.attraction.polynomials import Monomial, Polynomial, added, along, of_gram, rational, times

BITS = 44
Exact = list[list[Fraction]]


class Certificate(NamedTuple):
    """With these, {V < 1} is invariant and every trajectory in it goes to the origin, as `proved` checks."""

    v: Polynomial
    positive: Exact
    """Gram matrix of V - margin |x|^2."""
    multiplier: Exact
    """Of s, on the basis of degree 1 to its half."""
    decrease: Exact
    """Of -dV/dt - margin |x|^2 - s (1 - V)."""


def rounded(gram: np.ndarray) -> Exact:
    return [[Fraction(round(float(c) * 2**BITS), 2**BITS) for c in row] for row in (gram + gram.T) / 2]


def projected(target: Polynomial, basis: list[Monomial], gram: np.ndarray) -> Exact:
    """The rounded Gram matrix with z' G z equal to `target`, exactly."""
    found = rounded(gram)
    both = [[tuple(map(sum, zip(m, k, strict=True))) for k in basis] for m in basis]
    entries = Counter(m for row in both for m in row)
    residual = added((1, target), (-1, of_gram(basis, found)))
    if any(c != 0 and m not in entries for m, c in residual.items()):
        raise ValueError("the target has monomials that no product of the basis has")
    return [
        [c + residual.get(m, Fraction(0)) / entries[m] for c, m in zip(row, ms, strict=True)]
        for row, ms in zip(found, both, strict=True)
    ]


def semidefinite(matrix: Exact) -> bool:
    """Whether a symmetric matrix of fractions is positive semidefinite, by exact elimination."""
    a = [row[:] for row in matrix]
    for k in range(len(a)):
        if a[k][k] < 0 or (a[k][k] == 0 and any(a[i][k] != 0 for i in range(k + 1, len(a)))):
            return False
        if a[k][k] > 0:
            for i in range(k + 1, len(a)):
                factor = a[i][k] / a[k][k]
                for j in range(k + 1, len(a)):
                    a[i][j] -= factor * a[k][j]
    return True


def proved(found: Certificate, field: list[Polynomial], margin: Fraction, bases: dict[str, list[Monomial]]) -> bool:
    """Whether the identities hold and all Gram matrices are positive semidefinite, in rational arithmetic."""
    n = len(field)
    size = dict.fromkeys(bases["square"], margin)
    s = of_gram(bases["multiplier"], found.multiplier)
    inside = added((1, {(0,) * n: Fraction(1)}), (-1, found.v))
    identities = (
        added((1, found.v), (-1, size), (-1, of_gram(bases["positive"], found.positive))),
        added(
            (-1, along(found.v, field)),
            (-1, size),
            (-1, times(s, inside)),
            (-1, of_gram(bases["decrease"], found.decrease)),
        ),
    )
    grams = (found.positive, found.multiplier, found.decrease)
    return all(c == 0 for p in identities for c in p.values()) and all(map(semidefinite, grams))


def certificate(
    v: Polynomial,
    grams: dict[str, np.ndarray],
    field: list[Polynomial],
    margin: Fraction,
    bases: dict[str, list[Monomial]],
) -> Certificate:
    """The rounded certificate; whether it holds is decided by `proved` alone."""
    exact, size = rational(v, BITS), dict.fromkeys(bases["square"], margin)
    multiplier = rounded(grams["multiplier"])
    s = of_gram(bases["multiplier"], multiplier)
    inside = added((1, {(0,) * len(field): Fraction(1)}), (-1, exact))
    decrease = added((-1, along(exact, field)), (-1, size), (-1, times(s, inside)))
    return Certificate(
        exact,
        projected(added((1, exact), (-1, size)), bases["positive"], grams["positive"]),
        multiplier,
        projected(decrease, bases["decrease"], grams["decrease"]),
    )
