"""Test functions on which constants of methods for small budgets are set.

The methods are judged on `tests.given.small_budget_functions`; no function is in both. Seven of these twelve have many
valleys.
"""

from __future__ import annotations

import numpy as np

from tests.given.functions_with_minima import ackley, griewank, levy, shekel
from tests.given.small_budget_functions import Judged, rotated
from worker.engine.search.base import Floats

PEAKS = np.random.default_rng(12)
CENTRES = np.concatenate([np.zeros((1, 4)), PEAKS.uniform(-1, 1, (11, 4))])
HEIGHTS = np.concatenate([[1.0], PEAKS.uniform(0.3, 0.9, 11)])
WIDTHS = np.concatenate([[0.3], PEAKS.uniform(0.2, 0.6, 11)])
PLANES = np.random.default_rng(13).standard_normal((8, 4))


def peaks(x: Floats) -> Floats:
    """Twelve wells of random depth, width and position; nothing leads from one to the next."""
    squares = ((x[:, None, :] - CENTRES[None]) ** 2).sum(axis=2)
    return np.asarray(1 - (HEIGHTS * np.exp(-squares / (2 * WIDTHS**2))).max(axis=1))


def funnels(x: Floats) -> Floats:
    """Two bowls, of which the wider is not the deeper, with ripples."""
    deep, wide = ((x - 2) ** 2).sum(axis=1), 4 + 0.5 * ((x + 2.5) ** 2).sum(axis=1)
    return np.asarray(np.minimum(deep, wide) + 0.5 * (1 - np.cos(3 * (x - 2))).sum(axis=1))


def michalewicz(x: Floats) -> Floats:
    i = np.arange(1, x.shape[1] + 1)
    return np.asarray(-(np.sin(x) * np.sin(i * x**2 / np.pi) ** 20).sum(axis=1))


def ridge(x: Floats) -> Floats:
    return np.asarray(x[:, 0] ** 2 + 10 * np.sqrt((x[:, 1:] ** 2).sum(axis=1)))


def kinks(x: Floats) -> Floats:
    return np.asarray(np.abs(x @ PLANES.T).max(axis=1))


def dixon_price(x: Floats) -> Floats:
    i = np.arange(2, x.shape[1] + 1)
    return np.asarray((x[:, 0] - 1) ** 2 + (i * (2 * x[:, 1:] ** 2 - x[:, :-1]) ** 2).sum(axis=1))


def edge(x: Floats) -> Floats:
    """A bent bowl whose minimum is at the edge of the box."""
    return np.asarray((np.abs(x) ** 1.5).sum(axis=1) + (x.sum(axis=1)) ** 2 + (x[:, 0] * x[:, 1]) ** 2)


def hole(x: Floats) -> Floats:
    """A bowl with a ball next to its minimum in which evaluations fail."""
    fails = ((x - 0.8) ** 2).sum(axis=1) < 1.2**2
    return np.where(fails, np.nan, ((x**2) * np.arange(1, x.shape[1] + 1)).sum(axis=1))


TUNING: dict[str, Judged] = {
    j.name: j
    for j in (
        Judged("rotated Ackley 5", 5, -10, 10, rotated(ackley, 5), 0.0, True),
        Judged("Levy 4", 4, -10, 10, levy, 0.0, True, 1.0),
        Judged("peaks 4", 4, -1, 1, peaks, 0.0, True),
        Judged("Griewank 5", 5, -25, 25, griewank, 0.0, True),
        Judged("funnels 6", 6, -5, 5, funnels, 0.0, True, 2.0),
        Judged(
            "Michalewicz 5", 5, 0, np.pi, michalewicz, -4.687658179, True,
            np.array([2.202906, 1.570796, 1.284992, 1.923058, 1.720470]),
        ),
        Judged("Shekel 4", 4, 0, 10, shekel(10), -10.53641, True, 4.0),
        Judged("Dixon-Price 5", 5, -5, 5, dixon_price, 0.0, False, 2.0 ** -(1 - 2.0 ** -np.arange(5.0))),
        Judged("rotated ridge 6", 6, -5, 5, rotated(ridge, 6), 0.0, False),
        Judged("kinks 4", 4, -3, 3, kinks, 0.0, False),
        Judged("edge 6", 6, -9, 1, edge, 0.0, False),
        Judged("hole 4", 4, -2, 3, hole, 0.0, False),
    )
}  # fmt: skip
