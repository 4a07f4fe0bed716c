"""The state of many local searches, one row each, and the functions that their compiled state machines share.

A machine hands a searcher over by setting its kind and requesting no points.
"""

from __future__ import annotations

from typing import Any, NamedTuple, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

from worker.engine.kernels.cached import F, compiled
from worker.engine.kernels.numba_internals import UNCALLABLE
from worker.engine.search.base import Floats

Ints = NDArray[np.int64]

COMPASS, NELDER_MEAD, CMA = 0, 1, 2

BEGIN = -3
"""The stage of a searcher whose machine starts at its incumbent."""


def inner(function: F) -> F:
    """Compile a function that only compiled functions call; Python cannot call it.

    A Python wrapper, which unpacks the whole state, takes longer to compile than most of these functions. For the same
    reason they copy and add element by element: whole-array statements also compile their shape checks.
    """
    made: Any = njit(error_model="numpy", **UNCALLABLE)(function)
    return cast(F, made)


class State(NamedTuple):
    """All searchers: r rows, n parameters, at most c points in one request."""

    kind: Ints
    """(r,) the active machine"""
    stage: Ints
    """(r,) the state within it: position in a poll, last Nelder-Mead move, redraws of a generation"""
    flat: Ints
    """(r,) generations of CMA-ES with equal values"""
    evaluations: Ints
    """(r,)"""
    begin: Floats
    """(r, 2) first step of the first machine, first deviation of every CMA-ES after it"""
    best: Floats
    """(r, n) incumbent"""
    cost: Floats
    """(r,) its cost"""
    step: Floats
    """(r,) step of the compass, deviation of CMA-ES"""
    requested: Ints
    """(r,) number of requested points"""
    which: Ints
    """(r, c) their rows in points"""
    points: Floats
    """(r, c, n)"""
    values: Floats
    """(r, c)"""
    matrix: Floats
    """(r, n + 1, n) basis of the poll, simplex, or covariance"""
    factor: Floats
    """(r, n, n) Cholesky factor of the covariance"""
    vectors: Floats
    """(r, 4, n) last successful direction; mean, evolution path of the covariance, evolution path of sigma"""
    order: Floats
    """(r, 2 n + 1) order of a poll; costs of a simplex"""
    weights: Floats
    """(mu,) recombination weights of CMA-ES, shared by all"""
    rates: Floats
    """(7,) constants of CMA-ES, shared by all: mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, lambda"""


def room(rows: int, n: int) -> State:
    """An empty state for `rows` searchers of n parameters."""
    population = max(4 + int(3 * np.log(n)), 4)
    mu = population // 2
    weights = np.log(population / 2 + 0.5) - np.log(np.arange(1, mu + 1))
    weights /= weights.sum()
    m = 1.0 / float((weights**2).sum())
    c = max(population, n + 1)
    return State(
        kind=np.zeros(rows, np.int64), stage=np.zeros(rows, np.int64), flat=np.zeros(rows, np.int64),
        evaluations=np.zeros(rows, np.int64), begin=np.zeros((rows, 2)),
        best=np.zeros((rows, n)), cost=np.full(rows, np.inf), step=np.zeros(rows), requested=np.zeros(rows, np.int64),
        which=np.zeros((rows, c), np.int64), points=np.zeros((rows, c, n)), values=np.zeros((rows, c)),
        matrix=np.zeros((rows, n + 1, n)), factor=np.zeros((rows, n, n)), vectors=np.zeros((rows, 4, n)),
        order=np.zeros((rows, 2 * n + 1)), weights=weights,
        rates=np.array([*constants(n, m), population]),
    )  # fmt: skip


def constants(n: int, m: float) -> tuple[float, float, float, float, float, float]:
    """mu_eff, c_sigma, d_sigma, c_c, c_1 and c_mu of CMA-ES for n parameters and mu_eff m (Hansen 2016, table 1)."""
    c_sigma = (m + 2) / (n + m + 5)
    d_sigma = 1 + 2 * max(0.0, np.sqrt((m - 1) / (n + 1)) - 1) + c_sigma
    c_c = (4 + m / n) / (n + 4 + 2 * m / n)
    c_1 = 2 / ((n + 1.3) ** 2 + m)
    return m, c_sigma, d_sigma, c_c, c_1, min(1 - c_1, 2 * (0.25 + m + 1 / m - 2) / ((n + 2) ** 2 + m))


def grown(s: State) -> State:
    """The searchers with twice the number of rows."""
    shared = {"weights": s.weights, "rates": s.rates}
    rows = {name: np.concatenate([column, np.zeros_like(column)]) for name, column in s._asdict().items()}
    return State(**(rows | shared))


@compiled
def receive(s: State, rows: Ints, values: Floats) -> None:
    """Pass the values of the requested points to these searchers, in their order."""
    at = 0
    for t in rows:
        for i in range(s.requested[t]):
            s.values[t, s.which[t, i]] = values[at]
            at += 1
        s.evaluations[t] += s.requested[t]


@compiled
def requested(s: State, rows: Ints) -> Floats:
    """The points that these searchers request, in their order."""
    count = 0
    for t in rows:
        count += s.requested[t]
    points = np.empty((count, s.best.shape[1]))
    at = 0
    for t in rows:
        for i in range(s.requested[t]):
            for k in range(s.best.shape[1]):
                points[at, k] = s.points[t, s.which[t, i], k]
            at += 1
    return points
