"""Whether an obstacle moves as slowly as its component declares, by dense sampling of its positions."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from campaigns.catalogue import ParameterEntry, RateEntry
from campaigns.checked.rates import Intervals, fastest
from clearance.testing.problems import Problem
from worker.engine.systems.base import Floats
from worker.running.examination.turns import corners

FAR = 50.0
"""Paths are drawn within this distance [m] and up to this speed [m/s]."""
SAMPLES = 400
"""Of half a turn at the declared rate."""


def turns_as_declared(
    flown: Problem, parameters: Mapping[str, ParameterEntry], declared: RateEntry, draws: int = 40
) -> None:
    """The rate at random values is not exceeded, and bounds of values have no lower rate than the values."""
    chance = np.random.default_rng(1)
    for _ in range(draws):
        values = {path: _drawn(p, chance) for path, p in parameters.items()}
        exact = {path.partition(".")[2].partition(".")[2]: (v, v) for path, v in values.items()}
        rate = fastest(declared, exact)
        assert rate <= fastest(declared, _around(exact, chance)), values
        begin = chance.uniform(0.0, 3.0 * FAR / max(rate * FAR, 1.0))
        span = 0.999 * math.pi / rate if rate > 0.0 else 100.0
        turned = _turned(flown, values, begin + span * np.linspace(0.0, 1.0, SAMPLES))
        assert turned <= math.pi * 1.01, f"{values}: it turns by {turned:.4g} rad within pi over {rate:.4g} rad/s"
        assert rate > 0.0 or turned <= 1e-3, f"{values}: it turns by {turned:.4g} rad, and its rate is 0"


def _drawn(p: ParameterEntry, chance: np.random.Generator) -> float:
    low, high = max(p.low, -FAR), min(p.high, FAR)
    return float(low + (high - low) * chance.random() ** chance.choice([1.0, 4.0]))


def _around(values: Intervals, chance: np.random.Generator) -> Intervals:
    return {name: (v - chance.exponential(), v + chance.exponential()) for name, (v, _) in values.items()}


def _turned(flown: Problem, values: Mapping[str, float], times: Floats) -> float:
    """The sum of the angles between the consecutive displacements of the obstacle [rad]."""
    system = flown.system
    extended, here = system.loop.extend(flown.vector(values)), (0.0,) * system.parts.vehicle.dimension
    bodies = [system.loop.part("bodies")(float(t), (), here, extended)[0] for t in times]
    return float(corners(np.array([[getattr(body, a, 0.0) for a in "xyz"] for body in bodies])).sum())
