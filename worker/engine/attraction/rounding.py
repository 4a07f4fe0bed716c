"""A certificate in rational numbers from a numerical one: Gram matrices projected onto the identities.

Peyrl, Parrilo (Theor. Comput. Sci. 409, 2008): a solution inside is rounded, and its residual spread over the entries.
All numbers remain multiples of a power of two, so that they are stored as integers.
"""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction
from math import floor
from typing import Any

import numpy as np

from campaigns.certificates.exact import MARGIN, Bases, Certificate, Exact, decreasing, squares
from campaigns.certificates.polynomials import Monomial, Polynomial, added, dyadic, of_gram

BITS, SPREAD = 40, 60
"""Of the rounded numbers, and of the equal parts of a residual."""


def rounded(gram: Any) -> Exact:
    return [[Fraction(round(float(c) * 2**BITS), 2**BITS) for c in row] for row in (gram + gram.T) / 2]


def projected(target: Polynomial, basis: list[Monomial], gram: Any) -> Exact:
    """The rounded Gram matrix with z' G z equal to `target`, exactly."""
    found = rounded(gram)
    entries: dict[Monomial, list[tuple[int, int]]] = defaultdict(list)
    for i, m in enumerate(basis):
        for j, k in enumerate(basis):
            entries[tuple(map(sum, zip(m, k, strict=True)))].append((i, j))
    residual = added((1, target), (-1, of_gram(basis, found)))
    if any(c != 0 and m not in entries for m, c in residual.items()):
        raise ValueError("the target has monomials that no product of the basis has")
    for m, places in entries.items():
        missing = residual.get(m, Fraction(0))
        part = Fraction(floor(missing * 2**SPREAD / len(places)), 2**SPREAD)
        for i, j in places:
            found[i][j] += part
        i, j = places[0]
        rest = missing - part * len(places)
        for a, b in {(i, j), (j, i)}:
            found[a][b] += rest if i == j else rest / 2
    return found


def certificate(
    v: Polynomial, grams: list[Any], multiplier: Any, flow: list[Polynomial], limits: list[Polynomial], bases: Bases
) -> Certificate:
    """The rounded certificate of exact flow and limits; whether it holds is decided by `exact.wrong` alone.

    grams: of positivity, of every limit, and of the decrease.
    """
    exact, s = dyadic(v, BITS), rounded(np.asarray(multiplier))
    decrease = decreasing(exact, of_gram(bases.multiplier, s), flow, MARGIN)
    margins = (squares(len(flow), MARGIN), *limits)
    positive = [
        projected(added((1, exact), (-1, margin)), bases.positive, gram)
        for margin, gram in zip(margins, grams[:-1], strict=True)
    ]
    return Certificate(exact, positive, s, projected(decrease, bases.decrease, grams[-1]))
