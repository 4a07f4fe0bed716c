"""The exact check of a certified region of attraction {V < 1}, in rational arithmetic: identities and L D L^T.

Sums of squares by Gram matrices (Parrilo, Math. Program. 96, 2003); V decreases in the region by a multiplier s:
-dV/dt - margin |x|^2 - s (1 - V) is a sum of squares (Tan, Packard, IEEE Trans. Autom. Control 53, 2008).
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil
from typing import NamedTuple

from campaigns.certificates.polynomials import Monomial, Polynomial, added, along, degree, monomials, of_gram, times

Exact = list[list[Fraction]]
MARGIN = Fraction(1, 2**24)
"""Of positivity and of decrease, times |x|^2."""
MOST = 8
"""Degree of V."""
SHAPE, SIZE = "it has not what a certificate has", "a Gram matrix has another size"
IDENTITY, NEGATIVE = "an identity does not hold", "a Gram matrix is not positive semidefinite"
"""What of a certificate may not hold."""


class Certificate(NamedTuple):
    """With these, {V < 1} is within all limits and every trajectory in it goes to the origin, as `wrong` checks."""

    v: Polynomial
    positive: list[Exact]
    """Gram matrices of V - margin |x|^2, and of V - q for every limit q < 1."""
    multiplier: Exact
    """Of s, on the monomials from degree 1 to its half."""
    decrease: Exact
    """Of -dV/dt - margin |x|^2 - s (1 - V)."""


class Bases(NamedTuple):
    """The monomials of the Gram matrices."""

    positive: list[Monomial]
    multiplier: list[Monomial]
    decrease: list[Monomial]

    @classmethod
    def of(cls, flow: list[Polynomial], of_v: int, half: int) -> Bases:
        """of_v: degree of V; half: of the multiplier's degree."""
        n, most = len(flow), max(of_v + max(map(degree, flow)) - 1, 2 * half + of_v)
        return cls(monomials(n, 1, of_v // 2), monomials(n, 1, half), monomials(n, 1, (most + 1) // 2))


def coefficient(limit: float) -> Fraction:
    """A multiple of 2^-40 that is not below 1 / limit^2."""
    return Fraction(ceil(2**40 / Fraction(limit) ** 2), 2**40)


def squares(n: int, margin: Fraction) -> Polynomial:
    """margin |x|^2."""
    return {tuple(2 * (i == k) for i in range(n)): margin for k in range(n)}


def decreasing(v: Polynomial, s: Polynomial, flow: list[Polynomial], margin: Fraction) -> Polynomial:
    """-dV/dt - margin |x|^2 - s (1 - V)."""
    n = len(flow)
    inside = added((1, {(0,) * n: Fraction(1)}), (-1, v))
    return added((-1, along(v, flow)), (-1, squares(n, margin)), (-1, times(s, inside)))


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


def wrong(found: Certificate, flow: list[Polynomial], limits: list[Polynomial], margin: Fraction = MARGIN) -> str:
    """What of a certificate does not hold, in a few words; empty if it proves the region."""
    proper = found.v and all(len(m) == len(flow) and sum(m) <= MOST for m in found.v) and any(found.v.values())
    if margin <= 0 or not proper or len(found.positive) != 1 + len(limits):
        return SHAPE
    sides = [len(one) for one in (*found.positive, found.multiplier, found.decrease)]
    half = next((h for h in range(1, 8) if len(monomials(len(flow), 1, h)) == sides[-2]), 0)
    bases = Bases.of(flow, degree(found.v), half)
    if sides != [len(bases.positive)] * len(found.positive) + [len(bases.multiplier), len(bases.decrease)]:
        return SIZE
    s = of_gram(bases.multiplier, found.multiplier)
    wanted = [added((1, found.v), (-1, q)) for q in (squares(len(flow), margin), *limits)]
    grams = [(p, bases.positive, gram) for p, gram in zip(wanted, found.positive, strict=True)]
    grams.append((decreasing(found.v, s, flow, margin), bases.decrease, found.decrease))
    for p, basis, gram in grams:
        if any(added((1, p), (-1, of_gram(basis, gram))).values()):
            return IDENTITY
    if not all(map(semidefinite, (*found.positive, found.multiplier, found.decrease))):
        return NEGATIVE
    return ""
