"""The basic functions of the niching problems, maximised, and their composition (Liang et al. 2005)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.testing.searching import Function
from worker.engine.search.base import Floats


def uneven_trap(x: Floats) -> Floats:
    return np.interp(x[:, 0], [0.0, 2.5, 5.0, 7.5, 12.5, 17.5, 22.5, 27.5, 30.0], [200, 0, 160, 0, 140, 0, 160, 0, 200])


def equal_maxima(x: Floats) -> Floats:
    return np.asarray(np.sin(5 * np.pi * x[:, 0]) ** 6)


def uneven_maxima(x: Floats) -> Floats:
    decrease = np.exp(-2 * np.log(2) * ((x[:, 0] - 0.08) / 0.854) ** 2)
    return np.asarray(decrease * np.sin(5 * np.pi * (x[:, 0] ** 0.75 - 0.05)) ** 6)


def himmelblau(x: Floats) -> Floats:
    a, b = x.T
    return np.asarray(200 - (a**2 + b - 11) ** 2 - (a + b**2 - 7) ** 2)


def camel(x: Floats) -> Floats:
    a, b = x.T
    return np.asarray(-((4 - 2.1 * a**2 + a**4 / 3) * a**2 + a * b + (4 * b**2 - 4) * b**2))


def shubert(x: Floats) -> Floats:
    i = np.arange(1, 6)
    return np.asarray(-(i * np.cos((i + 1) * x[:, :, None] + i)).sum(axis=2).prod(axis=1))


def vincent(x: Floats) -> Floats:
    return np.asarray(np.sin(10 * np.log(x)).mean(axis=1))


def modified_rastrigin(x: Floats) -> Floats:
    return np.asarray(-(10 + 9 * np.cos(2 * np.pi * np.array([3, 4]) * x)).sum(axis=1))


def sphere(x: Floats) -> Floats:
    return np.asarray((x**2).sum(axis=1))


def rastrigin(x: Floats) -> Floats:
    return np.asarray((x**2 - 10 * np.cos(2 * np.pi * x) + 10).sum(axis=1))


def griewank(x: Floats) -> Floats:
    waves = np.cos(x / np.sqrt(np.arange(1, x.shape[1] + 1))).prod(axis=1)
    return np.asarray((x**2).sum(axis=1) / 4000 - waves + 1)


def weierstrass(x: Floats) -> Floats:
    k = np.arange(21)
    amplitude, frequency = 0.5**k, 2 * np.pi * 3.0**k
    lowest = x.shape[1] * (amplitude * np.cos(0.5 * frequency)).sum()
    return np.asarray((amplitude * np.cos(frequency * (x[:, :, None] + 0.5))).sum(axis=(1, 2)) - lowest)


def rosenbrock_griewank(x: Floats) -> Floats:
    """Expanded Griewank of Rosenbrock, F8F2, shifted so that its optimum is at the origin."""
    a = x + 1
    b = np.roll(a, -1, axis=1)
    rosenbrock = 100 * (a**2 - b) ** 2 + (1 - a) ** 2
    return np.asarray((1 + rosenbrock**2 / 4000 - np.cos(rosenbrock)).sum(axis=1))


def composition(
    basic: Sequence[Function], sigma: Floats, scale: Floats, optima: Floats, matrices: Floats, c: float = 2000.0
) -> Function:
    """A weighted sum of basic functions, each with its own optimum; all of them are global optima."""
    n = optima.shape[1]
    parts = list(zip(basic, scale, matrices, strict=True))
    highest = np.array([f((np.full((1, n), 5.0) / s) @ m)[0] for f, s, m in parts])

    def value(x: Floats) -> Floats:
        offsets = x[None, :, :] - optima[:, None, :]
        weights = np.exp(-(offsets**2).sum(axis=2) / (2 * n * sigma[:, None] ** 2))
        most = weights.max(axis=0)
        weights = np.where(weights == most, weights, weights * (1 - most**10))
        total = weights.sum(axis=0)
        weights = np.where(total > 0, weights / np.where(total > 0, total, 1.0), 1.0 / len(parts))
        values = np.array(
            [f(np.einsum("mj,ji->mi", offset / s, m)) for (f, s, m), offset in zip(parts, offsets, strict=True)]
        )
        return np.asarray(-(weights * c * values / highest[:, None]).sum(axis=0))

    return value
