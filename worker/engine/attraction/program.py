"""Sums of squares as a semidefinite program (Parrilo, Math. Program. 96, 2003), solved by Clarabel.

The objective is the least eigenvalue of all Gram matrices, so that solutions are inside, where rounding is possible.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.sparse as sp

from campaigns.certificates.polynomials import Monomial, Polynomial, added, times

CONSTANT = -1
"""The key of the part of an affine polynomial without an unknown."""
Affine = dict[int, Polynomial]
"""{unknown: polynomial}: the sum of unknown times polynomial, and the constant part."""


class Program:
    """Free unknowns and Gram matrices, and polynomials that are to vanish or to be sums of squares."""

    def __init__(self) -> None:
        self.unknowns = 1  # the first is the least eigenvalue
        self.grams: list[tuple[list[Monomial], list[tuple[int, int]], int]] = []
        self.zero: list[Affine] = []

    def free(self, basis: list[Monomial]) -> Affine:
        """A polynomial with unknown coefficients."""
        first = self.unknowns
        self.unknowns += len(basis)
        return {first + k: {m: 1.0} for k, m in enumerate(basis)}

    def squares(self, basis: list[Monomial]) -> Affine:
        """An unknown sum of squares."""
        pairs = [(i, j) for j in range(len(basis)) for i in range(j + 1)]
        first = self.unknowns
        self.unknowns += len(pairs)
        self.grams.append((basis, pairs, first))
        found: Affine = {}
        for k, (i, j) in enumerate(pairs):
            both = tuple(map(sum, zip(basis[i], basis[j], strict=True)))
            found[first + k] = {both: 1.0 if i == j else 2.0}
        return found

    def is_squares(self, p: Affine, basis: list[Monomial]) -> None:
        self.zero.append(combined((1.0, p), (-1.0, self.squares(basis))))

    def solved(self, costs: Mapping[int, float] | None = None, least: float = 0.0) -> tuple[float, np.ndarray] | None:
        """The least eigenvalue and the unknowns; None if the solver finds none.

        The eigenvalue is as large as possible, or, with costs of unknowns, at least so large.
        """
        import clarabel

        a, b, cones = self._constraints(clarabel, least)
        q = np.zeros(self.unknowns)
        for u, cost in ({0: -1.0} if costs is None else costs).items():
            q[u] = cost
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        solver = clarabel.DefaultSolver(sp.csc_matrix((self.unknowns,) * 2), q, a, b, cones, settings)
        found = solver.solve()
        if str(found.status) not in ("Solved", "AlmostSolved"):
            return None
        x = np.array(found.x)
        return float(x[0]), x

    def gram(self, x: np.ndarray, which: int) -> np.ndarray:
        basis, pairs, first = self.grams[which]
        found = np.zeros((len(basis),) * 2)
        for k, (i, j) in enumerate(pairs):
            found[i, j] = found[j, i] = x[first + k]
        return found

    def _constraints(self, clarabel: Any, least: float) -> tuple[Any, np.ndarray, list[Any]]:
        rows: list[dict[int, float]] = []
        b: list[float] = []
        for p in self.zero:
            for m in sorted({m for part in p.values() for m in part}):
                rows.append({u: part[m] for u, part in p.items() if u != CONSTANT and m in part})
                b.append(-p.get(CONSTANT, {}).get(m, 0.0))
        cones = [clarabel.ZeroConeT(len(rows)), clarabel.NonnegativeConeT(2)]
        rows += [{0: 1.0}, {0: -1.0}]
        b += [1.0, -least if least else 1.0]  # the least eigenvalue is at most 1
        for basis, pairs, first in self.grams:
            for k, (i, j) in enumerate(pairs):
                rows.append({first + k: -1.0, 0: 1.0} if i == j else {first + k: -math.sqrt(2.0)})
            b += [0.0] * len(pairs)
            cones.append(clarabel.PSDTriangleConeT(len(basis)))
        entries = [(r, u, v) for r, row in enumerate(rows) for u, v in row.items()]
        r, u, v = zip(*entries, strict=True)
        return sp.csc_matrix((v, (r, u)), shape=(len(rows), self.unknowns)), np.array(b), cones


def combined(*terms: tuple[float, Affine]) -> Affine:
    """The sum of factor times affine polynomial."""
    return {u: added(*((f, p[u]) for f, p in terms if u in p)) for u in {u for _, p in terms for u in p}}


def product(p: Affine, q: Polynomial) -> Affine:
    return {u: times(part, q) for u, part in p.items()}


def fixed(p: Polynomial) -> Affine:
    return {CONSTANT: p}


def at(p: Affine, x: np.ndarray) -> Polynomial:
    """The polynomial with these unknowns."""
    return added(*((1.0 if u == CONSTANT else x[u], part) for u, part in p.items()))
