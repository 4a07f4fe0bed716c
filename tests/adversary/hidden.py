"""Attacks on a verdict by functions whose violations no search evaluates; the truth is known in closed form.

The function is searched once as it is; then a part of it that no search has seen is made to violate, so that the same
searches find the same again. What is left to notice it is the independent sample, and the rules of agreement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import clearance

Floats = NDArray[np.float64]
Function = Callable[..., Any]

THRESHOLD = 1.0
STREAM = 2**21
"""The random stream of the sample, which an attacker knows from the code."""
TRIES = 84
PLACES = 20_000
"""Tried for a box that no search has met, before there is another campaign."""
VALIDATION = 10_000
"""Evaluations that validation may take: enough to leave nothing out."""


@dataclass(frozen=True)
class Hidden:
    """A function with a violation that its searches do not see; arguments: of `clearance.search`; fraction: the
    probability of the violation."""

    function: Function
    arguments: dict[str, Any]
    fraction: float

    def search(self, **more: Any) -> clearance.Result:
        return clearance.search(self.function, **(self.arguments | more))


def _bowl(random: np.random.Generator, n: int) -> Function:
    """A smooth function with its lowest value inside the box, and an influence of every parameter."""
    centre, slope = random.uniform(0.2, 0.8, n), random.uniform(0.5, 3.0, n)
    lowest = THRESHOLD + float(random.uniform(0.2, 2.0))

    def bowl(**x: Floats) -> Floats:
        points = np.stack([x[name] for name in sorted(x)], axis=-1)
        return np.asarray(lowest + (slope * (points - centre) ** 2).sum(axis=-1))

    return bowl


def _with_a_box(base: Function, low: Floats, high: Floats, depth: float) -> Function:
    def function(**x: Floats) -> Floats:
        points = np.stack([x[name] for name in sorted(x)], axis=-1)
        inside = ((points >= low) & (points <= high)).all(axis=-1)
        return np.where(inside, THRESHOLD - depth, base(**x))

    return function


def hidden_box(random: np.random.Generator, certify: int, fraction: tuple[float, float]) -> Hidden:
    """A box between what the searches and the validation evaluate, with a probability between the two of `fraction`."""
    while (found := _hidden_box(random, certify, fraction)) is None:  # they have left no room for one
        pass
    return found


def _hidden_box(random: np.random.Generator, certify: int, fraction: tuple[float, float]) -> Hidden | None:
    n = int(random.integers(3, 5))
    base = _bowl(random, n)
    names = [f"x{k}" for k in range(n)]
    asked = {
        "parameters": dict.fromkeys(names, (0.0, 1.0)), "threshold": THRESHOLD, "vectorized": True, "certify": 0,
        "validation": VALIDATION,
        "methods": {"direct": 60 * n, "cma_es": 60 * n}, "seed": int(random.integers(1, 2**31)),
    }  # fmt: skip
    points = clearance.search(base, **asked).points
    for _ in range(PLACES):
        volume = float(random.uniform(*fraction))
        shape = random.uniform(0.6, 1.6, n)
        width = shape * (volume / shape.prod()) ** (1 / n)
        low = random.uniform(0.0, 1.0, n) * (1 - width)
        inside = ((points >= low) & (points <= low + width)).all(axis=1)
        if (width < 1).all() and not inside.any():
            function = _with_a_box(base, low, low + width, float(random.uniform(0.01, 1.0)))
            return Hidden(function, asked | {"certify": certify}, volume)
    return None


def lucky_seed(given: Hidden) -> int | None:
    """The first seed whose sample has no violation, of as many as an attacker tries at home."""
    names = sorted(given.arguments["parameters"])
    for seed in range(1, TRIES + 1):
        stream = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(STREAM,)))
        drawn = stream.random((given.arguments["certify"], len(names)))
        if (given.function(**dict(zip(names, drawn.T, strict=True))) > THRESHOLD).all():
            return seed
    return None


def needle(random: np.random.Generator) -> Hidden:
    """A steep cone above the threshold, whose methods stop at values that differ by more than what is left of it, with
    a needle below the threshold beside its tip."""
    n = int(random.integers(2, 5))
    centre, direction = random.uniform(0.25, 0.75, n), random.normal(size=n)
    radius = float(10 ** random.uniform(-4.0, -3.0))
    tip = centre + 3 * radius * direction / np.linalg.norm(direction)
    steep, left = float(10 ** random.uniform(3.0, 4.0)), float(random.uniform(0.2, 2.0))

    def function(**x: Floats) -> Floats:
        points = np.stack([x[name] for name in sorted(x)], axis=-1)
        cone = THRESHOLD + left + steep * np.linalg.norm(points - centre, axis=-1)
        return np.where(np.linalg.norm(points - tip, axis=-1) <= radius, THRESHOLD - 0.5, cone)

    asked = {
        "parameters": {f"x{k}": (0.0, 1.0) for k in range(n)}, "threshold": THRESHOLD, "vectorized": True,
        "certify": 100, "validation": VALIDATION,
        "methods": {"direct": 50 * n, "cma_es": 50 * n}, "seed": int(random.integers(1, 2**31)),
        "nominal": {f"x{k}": 0.0 for k in range(n)},
    }  # fmt: skip
    return Hidden(function, asked, float(radius**n))
