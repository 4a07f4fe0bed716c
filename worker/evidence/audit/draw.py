"""Draws the points of a run's samples again from its seed: `redrawn`; and the points of its full grid: `gridded`.

The random numbers and their order are those of the run, so that uniform points have the same bits; a point that was
chosen, stored twice or left out shows. Quantile functions may differ in the last bits on other machines: `ROUNDING`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.results.base import EXCLUDED
from worker.engine.problem.distributions import Distributions, Range
from worker.evidence.audit import limits

BLOCK = 4096
"""Draws in one request; correlated draws of other blocks may have other last bits."""
CERTIFY = 2**21
"""The random stream of the certify stage; searches have those from 0 on."""
FIRST, GROWTH = 100, 1.5
"""Draws until the first interim analysis of a sample that may stop early, and their growth until the next."""

ROUNDING = 1e-12
"""Fraction of a range by which a point of another distribution than the uniform one may differ."""

Bounds = dict[str, tuple[float, float]]


def redrawn(campaign: Campaign, bounds: Bounds, seed: int, stream: int, blocks: Iterator[int]) -> Any:
    """The points (m, n) of a sample requested in blocks of these sizes."""
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(stream,)))
    distributions, dimension = distributed(campaign, bounds), len(campaign.uncertain)
    drawn = [distributions.quantile(random.random((size, dimension))) for size in blocks]
    return np.concatenate([np.empty((0, dimension)), *drawn])


def distributed(campaign: Campaign, bounds: Bounds) -> Distributions:
    """What the campaign states of its uncertain parameters."""
    ranges = [
        Range(path, k, *bounds[path], math.nan, uncertain.distribution)
        for k, (path, uncertain) in enumerate(campaign.uncertain.items())
    ]
    return Distributions(ranges, campaign.correlations)


def certified(requested: int, status: Any) -> Iterator[int]:
    """The blocks of the certify stage, which draws excluded ones again; status (m,): of its draws."""
    done, most = 0, limits.draws(requested, len(status))
    while done < len(status) and (left := requested - int(np.count_nonzero(status[:done] != EXCLUDED))) > 0:
        size = min(BLOCK, left, most - done)
        if size <= 0:
            return
        yield size
        done += size


def searched(budget: int, draws: int, early: bool) -> Iterator[int]:
    """The blocks of a random search: with early stopping, up to the next interim analysis."""
    done, size = 0, float(FIRST)
    while done < min(draws, budget):
        until = done + BLOCK
        if early:
            while math.ceil(size) <= done:
                size *= GROWTH
            until = math.ceil(size)
        block = min(until, budget) - done
        yield block
        done += block


def gridded(points: int, dimension: int) -> Any:
    """The points of a full grid; the last parameter varies fastest."""
    places = np.indices((points,) * dimension).reshape(dimension, -1).T
    return places / (points - 1)


def agreeing(campaign: Campaign, stored: Any, drawn: Any) -> int:
    """How many of the stored points are the drawn ones, in their places."""
    size = min(len(stored), len(drawn))
    mixed = {path for c in campaign.correlations if c.value != 0.0 for path in c.between}
    plain = [u.distribution.kind == "uniform" and path not in mixed for path, u in campaign.uncertain.items()]
    same = np.abs(stored[:size] - drawn[:size]) <= np.where(plain, 0.0, ROUNDING)
    return int(np.count_nonzero(same.all(axis=1)))
