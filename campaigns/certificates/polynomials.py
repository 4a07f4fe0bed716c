"""Polynomials as {exponents: coefficient}, with floats or fractions."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

Monomial = tuple[int, ...]
Polynomial = dict[Monomial, Any]


def monomials(n: int, low: int, high: int) -> list[Monomial]:
    """The monomials of `n` variables with degrees from low to high, by degree."""
    every = [m for m in itertools.product(range(high + 1), repeat=n) if low <= sum(m) <= high]
    return sorted(every, key=lambda m: (sum(m), m))


def degree(p: Polynomial) -> int:
    return max(sum(m) for m, c in p.items() if c != 0)


def added(*terms: tuple[Any, Polynomial]) -> Polynomial:
    """The sum of factor times polynomial."""
    found: Polynomial = defaultdict(int)
    for factor, p in terms:
        for m, c in p.items():
            found[m] += factor * c
    return dict(found)


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    found: Polynomial = defaultdict(int)
    for (m, c), (k, d) in itertools.product(p.items(), q.items()):
        found[tuple(map(sum, zip(m, k, strict=True)))] += c * d
    return dict(found)


def derivative(p: Polynomial, k: int) -> Polynomial:
    return {(*m[:k], m[k] - 1, *m[k + 1 :]): m[k] * c for m, c in p.items() if m[k] > 0}


def along(p: Polynomial, field: list[Polynomial]) -> Polynomial:
    """The derivative of p along a vector field."""
    return added(*((1, times(derivative(p, k), f)) for k, f in enumerate(field)))


def of_gram(basis: list[Monomial], gram: Any) -> Polynomial:
    """z' G z."""
    found: Polynomial = defaultdict(int)
    for (i, m), (j, k) in itertools.product(enumerate(basis), repeat=2):
        found[tuple(map(sum, zip(m, k, strict=True)))] += gram[i][j]
    return dict(found)


def dyadic(p: Mapping[Monomial, float], bits: int) -> Polynomial:
    """Coefficients rounded to multiples of 2^-bits."""
    return {m: Fraction(round(float(c) * 2**bits), 2**bits) for m, c in p.items()}


def substituted(p: Polynomial, rows: Sequence[Polynomial]) -> Polynomial:
    """p with a polynomial in place of each variable."""
    n, terms = len(next(iter(rows[0]))), []
    for m, c in p.items():
        term: Polynomial = {(0,) * n: c}
        for row, power in zip(rows, m, strict=True):
            for _ in range(power):
                term = times(term, row)
        terms.append((1, term))
    return added(*terms)
