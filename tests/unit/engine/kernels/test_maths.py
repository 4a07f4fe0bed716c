"""The elementary functions of the loop, compiled as the loop compiles them: measured errors, range, NaN kept."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numba import njit

from worker.engine.kernels import maths
from worker.engine.kernels.bind import plain
from worker.engine.kernels.numba_internals import FLAGS

sincos, atan2, clip, wrap, whole = maths.sincos, maths.atan2, maths.clip, maths.wrap, maths.whole


@njit(**FLAGS)
def all_sincos(x: Any, out: Any) -> None:
    for i in range(len(x)):
        out[i, 0], out[i, 1] = sincos(x[i])


@njit(**FLAGS)
def all_atan2(y: Any, x: Any, out: Any) -> None:
    for i in range(len(x)):
        out[i] = atan2(y[i], x[i])


@njit(**FLAGS)
def held(x: float) -> tuple[float, float, float]:
    return clip(x, -1.0, 2.0), wrap(x), whole(x)


@pytest.mark.parametrize(("reach", "error"), [(30.0, 2e-15), (1e5, 5e-12)])
def test_sine_and_cosine_are_within_the_stated_error(reach: float, error: float) -> None:
    x = np.random.default_rng(1).uniform(-reach, reach, 200_000)
    x[:9] = [0.0, math.pi, -math.pi, math.pi / 2, -math.pi / 2, math.pi / 4, 3 * math.pi / 4, reach, -reach]
    out = np.empty((len(x), 2))
    all_sincos(x, out)
    assert np.abs(out[:, 0] - np.sin(x)).max() < error
    assert np.abs(out[:, 1] - np.cos(x)).max() < error


def test_atan2_is_within_the_stated_error() -> None:
    random = np.random.default_rng(2)
    size = 10.0 ** random.uniform(-12, 12, 200_000)
    angle = random.uniform(-math.pi, math.pi, 200_000)
    y, x = size * np.sin(angle), size * np.cos(angle)
    y[:6], x[:6] = [0.0, 0.0, 1.0, -1.0, 1.0, -1.0], [1.0, -1.0, 0.0, 0.0, 1.0, -1.0]
    out = np.empty(len(x))
    all_atan2(y, x, out)
    assert np.abs(out - np.arctan2(y, x)).max() < 1e-15


def test_angle_of_nothing_is_zero() -> None:
    out = np.empty(1)
    all_atan2(np.zeros(1), np.zeros(1), out)
    assert out[0] == 0.0


def test_nan_is_propagated() -> None:
    nan = np.array([math.nan, math.nan, 1.0])
    sines, angles = np.empty((3, 2)), np.empty(3)
    all_sincos(nan, sines)
    all_atan2(nan, np.array([1.0, math.nan, math.nan]), angles)
    assert np.isnan(sines[:2]).all()
    assert np.isnan(angles).all()
    assert all(map(math.isnan, held(math.nan)))


@pytest.mark.parametrize(("x", "clipped"), [(-3.0, -1.0), (0.5, 0.5), (7.0, 2.0)])
def test_clip_limits_a_value(x: float, clipped: float) -> None:
    assert held(x)[0] == clipped


@pytest.mark.parametrize(
    ("x", "nearest"), [(-1.0, -1.0), (-0.51, -1.0), (-0.49, 0.0), (0.0, 0.0), (2.49, 2.0), (2.51, 3.0)]
)
def test_whole_rounds_to_the_nearest(x: float, nearest: float) -> None:
    assert held(x)[2] == nearest


@pytest.mark.parametrize("turns", [-3, -1, 0, 2, 50])
def test_wrap_removes_whole_turns(turns: int) -> None:
    assert held(0.7 + 2 * math.pi * turns)[1] == pytest.approx(0.7, abs=1e-12)
    assert -math.pi <= held(math.pi * (2 * turns + 1))[1] < math.pi + 1e-12


def test_plain_and_compiled_are_the_same_function() -> None:
    x = np.linspace(-20, 20, 401)
    compiled = np.empty((len(x), 2))
    all_sincos(x, compiled)
    assert np.array([plain(sincos)(v) for v in x.tolist()]) == pytest.approx(compiled, abs=4e-15)
