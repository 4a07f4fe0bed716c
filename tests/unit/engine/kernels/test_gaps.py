"""A gap that is larger than the distance to a surface is found; the bodies that are shipped have none."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from worker.engine.kernels.component import Obstacle, declared
from worker.engine.kernels.gaps import Floats, overstated
from worker.engine.kernels.reaches import Reaches, sampled
from worker.running.catalogue.installed import components
from worker.running.examination.scenes import usual

OBSTACLES = {
    name: component for (_, name), component in components().items() if isinstance(component, Obstacle)
}  # fmt: skip


def level(*axes: float) -> Callable[[Floats], float]:
    """The usual short cut for an ellipse: right on the surface, too large beside it."""
    return lambda q: (float(np.linalg.norm(q / np.array(axes))) - 1.0) * max(axes)


def along_a_ray(q: Floats) -> float:
    """Of a star: right along every ray from its centre."""
    return math.hypot(*q) - 1.0 - 0.3 * math.cos(3.0 * math.atan2(q[1], q[0]))


def above_ground(q: Floats) -> float:
    """A height above a slope."""
    return float(q[2]) - 0.5 * float(q[0])


WRONG: dict[str, tuple[Callable[[Floats], float], int]] = {
    "an ellipse": (level(0.5, 1.5), 2),
    "an ellipsoid": (level(2.0, 2.0, 1.9), 3),
    "feet": (lambda q: (math.hypot(*q) - 1.0) / 0.3048, 2),
    "a thousandth": (lambda q: (math.hypot(*q) - 1.0) * 1.001, 2),
    "a square": (lambda q: float(q @ q) - 1.0, 3),
    "a star": (along_a_ray, 2),
    "a height": (above_ground, 3),
}


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize("scale", [1e-2, 1.0, 1e3])
def test_a_gap_that_is_too_large_is_found(name: str, scale: float) -> None:
    gap, axes = WRONG[name]
    centre = scale * np.array([3.0, -2.0, 1.0])[:axes]

    def placed(q: Floats) -> float:
        return scale * gap((q - centre) / scale)

    found = overstated(placed, centre)
    assert found is not None
    assert found.gap == placed(found.place) > found.distance
    assert placed(found.elsewhere) > 0.0


RIGHT: dict[str, Callable[[Floats], float]] = {
    "less than the distance": lambda q: 0.5 * (math.hypot(*q) - 1.0),
    "of half planes": lambda q: max(abs(float(q[0])), abs(float(q[1]))) - 1.0,
    "wrong inside": lambda q: math.hypot(*q) - 1.0 if math.hypot(*q) > 1.0 else -1e9,
    "by iteration": lambda q: round((math.hypot(*q) - 1.0) / 3e-8) * 3e-8,
    "in single precision": lambda q: float(np.float32(math.hypot(*q) - 1.0)),
    "infinite": lambda q: math.inf,
    "no number": lambda q: math.nan,
}


@pytest.mark.parametrize("name", RIGHT)
def test_a_gap_that_is_not_too_large_outside_is_accepted(name: str) -> None:
    assert overstated(RIGHT[name], np.array([3.0, -2.0])) is None


@pytest.mark.parametrize("name", OBSTACLES)
def test_no_shipped_body_has_one(name: str) -> None:
    obstacle: Any = OBSTACLES[name]
    nominal = {p.name: usual(p, "obstacles.0") for p in declared(obstacle.parameters)}
    limits = {p.name: (p.low, p.high) for p in declared(obstacle.parameters)}
    for values, time in itertools.product(itertools.islice(sampled(nominal, limits), 12), (0.0, 7.3)):
        assert Reaches(obstacle).overstated(values, time) is None
