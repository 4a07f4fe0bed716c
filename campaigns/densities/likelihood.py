"""How likely a case is under the stated distributions: `likelihood`; and the most likely violation: `most_likely`.

The probability that a draw is no more likely is that of the region outside the level set of the density (Hyndman,
Computing and graphing highest density regions, The American Statistician 50, 1996).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns import cube
from campaigns.claims import likelihood as claims
from campaigns.cube import Floats
from campaigns.densities.joint import Joint
from campaigns.results.base import OK
from campaigns.results.likelihood import Likelihood, LikelyViolation, MostLikely
from campaigns.special import chi_square_beyond

CELLS = 2000
"""Of the grid on which the falls of several bounded distributions are added."""


def likelihood(of: Joint, point: Floats) -> Likelihood:
    """How likely one point (n,) of the unit cube is."""
    if of.uniform:
        return Likelihood(statement=claims.UNIFORM)
    if of.unbounded:
        return Likelihood(statement=claims.unbounded(of.unbounded))
    counted = len(of.mixed) + sum(one.freedom != 0 for one in of.alone)
    if of.skewed:
        return Likelihood(parameters=counted, statement=claims.skewed(of.skewed))
    own, joined = (float(fall[0]) for fall in of.falls(np.clip(point, 0.0, 1.0)[None, :]))
    if math.isinf(joined):
        return Likelihood(parameters=counted, statement=claims.AT_BOUND)
    if math.isinf(own):
        return Likelihood(density=0.0, tail=0.0, parameters=counted, statement=claims.IMPOSSIBLE)
    fall = own + joined
    values = math.exp(-fall / 2.0), math.sqrt(fall), beyond(of, fall), counted
    named = dict(zip(("density", "distance", "tail", "parameters"), values, strict=True))
    return Likelihood.model_validate(named | {"statement": claims.likelihood(*values, of=len(of.shapes))})


def beyond(of: Joint, fall: float) -> float:
    """The probability that the density at a draw is at least so far below its highest."""
    freedom = len(of.mixed) + sum(one.freedom or 0 for one in of.alone)
    others = [one for one in of.alone if one.freedom is None]
    if not others or fall <= 0.0:
        return float(chi_square_beyond(fall, freedom))
    masses, halves, tail = np.array([1.0]), np.linspace(0.0, fall, 2 * CELLS + 1), 0.0
    for number, one in enumerate(others):  # the probabilities that the fall of a draw is in each cell up to `fall`
        beyond_halves = one.beyond(halves)
        tail += float(masses @ beyond_halves[_left(len(masses), number)])
        masses = np.convolve(masses, -np.diff(beyond_halves[::2]))[:CELLS]
    rest = chi_square_beyond(halves[_left(len(masses), len(others))], freedom)
    return min(tail + float(masses @ rest), 1.0)


def _left(cells: int, added: int) -> NDArray[np.intp]:
    """What is left of a fall from the middle of each cell of a sum of so many, in half cells."""
    left: NDArray[np.intp] = np.maximum(2 * CELLS - 2 * np.arange(cells) - added, 0)
    return left


class Rows(NamedTuple):
    """Evaluations of one stage from the index `first` on: points (m, n), costs (m, k), status (m,).

    seeds: of the noise realisations that the stage's leading evaluations drew, from its index 0 on.
    """

    position: int
    first: int
    points: Floats
    costs: Floats
    status: NDArray[np.uint8]
    seeds: Sequence[int] = ()


def most_likely(
    threshold: float, of: Joint | None, nominal: Mapping[str, float], stored: Iterable[Rows], unit: str
) -> MostLikely:
    """The most likely of the violations among the stored evaluations; the first of equally likely ones.

    of: None if the bounds of a parameter are not known; unit: of the threshold."""
    violations, highest = 0, -math.inf
    best: tuple[Rows, int] | None = None
    for rows in stored:
        violating = np.flatnonzero((rows.status == OK) & (rows.costs[:, 0] <= threshold))
        violations += len(violating)
        if not len(violating) or of is None or not of.distinguishes:
            continue
        ranks = of.ranks(rows.points[violating])
        k = int(np.argmax(ranks))
        if (rank := float(ranks[k])) > highest:
            highest, best = rank, (rows, int(violating[k]))
    if of is None or best is None:
        return MostLikely(
            violations=violations, statement=claims.no_case(violations, of is not None, bool(of and of.uniform))
        )
    case = _case(of, nominal, threshold, *best)
    name = f"{case.position}:{case.index}"
    statement = claims.most_likely(violations, name, case.margin, unit, case.likelihood.statement)
    return MostLikely(violations=violations, case=case, statement=statement)


def _case(of: Joint, nominal: Mapping[str, float], threshold: float, rows: Rows, row: int) -> LikelyViolation:
    point, cost = rows.points[row], float(rows.costs[row, 0])
    values = cube.natural(point, [nominal[path] for path in of.shapes], of.low, of.high)
    index = rows.first + row
    return LikelyViolation(
        position=rows.position,
        index=index,
        cost=cost,
        margin=cost - threshold,
        parameters=dict(zip(of.shapes, values.tolist(), strict=True)),
        realisation=int(rows.seeds[index]) if index < len(rows.seeds) else None,
        likelihood=likelihood(of, point),
    )
