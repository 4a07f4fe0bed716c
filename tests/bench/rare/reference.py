"""The probabilities of the public problems, computed again: `python -m tests.bench.rare --references`.

By line sampling (Koutsourelakis, Pradlwarter, Schueller, Probabilistic Engineering Mechanics 19, 2004): along every
line of one direction the violating intervals have an exact probability; in two parameters the lines are a grid, in
more a scrambled sequence of Sobol. Four problems have closed forms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import integrate, special, stats
from scipy.stats import qmc

from tests.bench.rare.problem import Floats, Problem

REACH, ALONG = 9.0, 1201
SCRAMBLES, LINES, AT_ONCE = 8, 4096, 512


def probability(problem: Problem) -> tuple[float, float]:
    """P(violation) and its standard error; that of a grid is the difference to one half as fine."""
    if problem.name in CLOSED:
        return CLOSED[problem.name](), 0.0
    way = _direction(problem, np.random.default_rng(20261125))
    if problem.dimension == 2:
        fine, coarse = (_grid(problem, way, lines) for lines in (8192, 4096))
        return fine, abs(fine - coarse)
    means = [_of_scramble(problem, way, seed) for seed in range(SCRAMBLES)]
    return float(np.mean(means)), float(np.std(means, ddof=1) / np.sqrt(SCRAMBLES))


def _of_scramble(problem: Problem, way: Floats, seed: int) -> float:
    points = special.ndtri(qmc.Sobol(problem.dimension, seed=seed).random(LINES))
    return float(np.mean([_on_lines(problem, way, some) for some in np.split(points, LINES // AT_ONCE)]))


def _rp33() -> float:
    """One minus the probability that both half-spaces hold, whose normals have the correlation 1 / sqrt(3)."""
    below = integrate.quad(
        lambda z: stats.norm.pdf(z) * special.ndtr((3.0 - z / np.sqrt(3.0)) / np.sqrt(2.0 / 3.0)), -REACH, 3.0
    )
    return 1.0 - float(below[0])


def _rp77() -> float:
    """Over the third parameter: x - y has the deviation sqrt(1.25)."""
    low = integrate.quad(lambda z: stats.norm.pdf(z, 4.0) * special.ndtr((z - 10.0) / np.sqrt(1.25)), -5.0, 5.0)
    high = integrate.quad(lambda z: stats.norm.pdf(z, 4.0) * special.ndtr(-z), 5.0, 13.0)
    return float(low[0] + high[0])


CLOSED: dict[str, Callable[[], float]] = {
    "RP33": _rp33,
    "RP54": lambda: float(stats.gamma.cdf(8.951, 20)),
    "RP77": _rp77,
    "RP107": lambda: float(special.ndtr(-5.0)),
}


def _direction(problem: Problem, random: np.random.Generator) -> Floats:
    """The mean direction of violations among draws of two deviations."""
    points = 2.0 * random.standard_normal((200_000, problem.dimension))
    bad = points[problem.costs(points) <= 0.0]
    mean = (np.exp(-0.375 * np.sum(bad**2, axis=1))[:, None] * bad).sum(axis=0)
    return np.asarray(mean / np.linalg.norm(mean))


def _grid(problem: Problem, way: Floats, lines: int) -> float:
    edges = np.linspace(-REACH, REACH, lines + 1)
    middle, weights = (edges[1:] + edges[:-1]) / 2.0, np.diff(special.ndtr(edges))
    across = middle[:, None] * np.array([-way[1], way[0]])
    parts = [_on_lines(problem, way, some) for some in np.split(across, lines // AT_ONCE)]
    return float(weights @ np.concatenate(parts))


def _on_lines(problem: Problem, way: Floats, points: Floats) -> Floats:
    """The probability of violation on the line through each point, its ends interpolated."""
    across = points - (points @ way)[:, None] * way
    at = np.linspace(-REACH, REACH, ALONG)
    costs = problem.costs((across[:, None, :] + at[:, None] * way).reshape(-1, len(way))).reshape(len(points), ALONG)
    left, right = costs[:, :-1], costs[:, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = at[:-1] + np.where((left <= 0.0) != (right <= 0.0), left / (left - right), 0.0) * (at[1] - at[0])
    begins = np.where(left <= 0.0, at[:-1], np.where(right <= 0.0, zero, at[1:]))
    ends = np.where(right <= 0.0, at[1:], np.where(left <= 0.0, zero, at[:-1]))
    inside = (left <= 0.0) | (right <= 0.0)
    # By the smaller tail, in which the difference does not cancel.
    mass = np.where(
        begins > 0.0, special.ndtr(-begins) - special.ndtr(-ends), special.ndtr(ends) - special.ndtr(begins)
    )
    return np.asarray(np.where(inside, mass, 0.0).sum(axis=1))
