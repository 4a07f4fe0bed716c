"""Vectors and attitudes of the kernels against the standard library and SciPy; NaN is preserved."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from worker.engine.kernels.bind import plain
from worker.engine.physics import space, vectors

RANDOM = np.random.default_rng(11)


def test_arcsine_is_that_of_libm() -> None:
    x = RANDOM.uniform(0, 1, 20_000)
    found = np.array([plain(space.arcsine)(v) for v in x])
    assert np.abs(found - np.arcsin(x)).max() < 1e-14
    assert [plain(space.arcsine)(v) for v in (1.0, 1.5, 1e9)] == [math.pi / 2] * 3


@pytest.mark.parametrize(("function", "arguments"), [(space.arcsine, 1), (space.attitude, 3)])
def test_no_number_stays_no_number(function: Any, arguments: int) -> None:
    for k in range(arguments):
        given = [0.5] * arguments
        given[k] = math.nan
        assert np.isnan(plain(function)(*given)).any()


class TestAttitude:
    ANGLES = RANDOM.uniform([-3, -1.5, -3], [3, 1.5, 3], (200, 3))

    def test_turns_vectors_as_rotations_do(self) -> None:
        for roll, pitch, yaw in self.ANGLES:
            a, v = plain(space.attitude)(roll, pitch, yaw), tuple(RANDOM.normal(size=3))
            turn = Rotation.from_euler("ZYX", [yaw, pitch, roll])
            assert plain(space.to_world)(a, v) == pytest.approx(turn.apply(v), abs=1e-14)
            assert plain(space.to_body)(a, v) == pytest.approx(turn.inv().apply(v), abs=1e-14)

    def test_euler_rates_are_those_of_the_turning_body(self) -> None:
        h = 1e-6
        for roll, pitch, yaw in self.ANGLES[np.abs(self.ANGLES[:, 1]) < 1.2]:
            rates = RANDOM.normal(size=3)
            turn = Rotation.from_euler("ZYX", [yaw, pitch, roll])
            ends = [(turn * Rotation.from_rotvec(s * h * rates)).as_euler("ZYX")[::-1] for s in (1.0, -1.0)]
            slopes = (ends[0] - ends[1] + np.pi) % (2 * np.pi) - np.pi
            found = plain(space.euler_rates)(plain(space.attitude)(roll, pitch, yaw), tuple(rates))
            assert found == pytest.approx(slopes / (2 * h), abs=1e-6)

    def test_a_velocity_points_along_heading_and_climb(self) -> None:
        for heading, climb in self.ANGLES[:, :2]:
            turn = Rotation.from_euler("ZYX", [heading, climb, 0.0])
            assert plain(space.velocity_vector)(7.0, heading, climb) == pytest.approx(
                turn.apply([7.0, 0.0, 0.0]), abs=1e-13
            )


def test_a_ball_is_seen_at_its_surface() -> None:
    b = plain(vectors.round_body)((1.0, 2.0, -3.0), (4.0, 5.0, 6.0), 2.0, (1.0, 6.0, 0.0))
    assert b == pytest.approx((1.0, 2.0, -3.0, 4.0, 5.0, 6.0, 2.0, 3.0, 0.0, 0.8, 0.6), abs=1e-11)
