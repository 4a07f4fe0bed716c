"""Coordinates x = T y in which a quadratic form is nearly |y|^2, exactly: T and its inverse are multiples of 2^-k.

A unit triangular matrix of such numbers has an inverse of such numbers, and so has a power of two.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from campaigns.certificates.coordinates import Matrix

FINENESS = 64
"""Of the entries of the triangular matrix."""


def scaling(scales: Any) -> Matrix:
    """Diagonal, of powers of two."""
    return [
        [Fraction(2) ** round(float(np.log2(s))) if i == k else Fraction(0) for k in range(len(scales))]
        for i, s in enumerate(scales)
    ]


def rounding(form: Any) -> Matrix:
    """In which x' form x is nearly |y|^2: y = D U x from its Cholesky factor, rounded."""
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
