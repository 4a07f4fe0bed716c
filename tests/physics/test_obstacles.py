"""Obstacles: distance and normal of every shape, paths and their velocities, and intruders that give way."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from tests.physics.bodies import OBSTACLES, _body, centre
from tests.physics.scenes import changed, flight, uncompiled
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Obstacle
from worker.engine.physics.closest import Rules, resolve

CASE = load_file(library()["unicycle_static"])


def made(name: str, **given: float) -> Any:
    """An obstacle as a function (t, q) -> body, at its defaults but for the values given by field."""
    obstacle = next(o for o in OBSTACLES if o.name == name)
    return _body(obstacle, given)


def normal(body: Any, dimension: int) -> np.ndarray[Any, Any]:
    return np.array([body.nx, body.ny] + ([body.nz] if dimension == 3 else []))


def speed(body: Any, dimension: int) -> np.ndarray[Any, Any]:
    return np.array([body.vx, body.vy] + ([body.vz] if dimension == 3 else []))


@pytest.mark.parametrize("obstacle", OBSTACLES, ids=lambda o: o.name)
class TestEvery:
    def points(self, obstacle: Obstacle, at: Any) -> Any:
        body = at(0.3, (0.0,) * obstacle.dimension)
        size = max(body.radius, 1.0)
        random = np.random.default_rng(11)
        return centre(body, obstacle.dimension) + random.uniform(-2.5 * size, 2.5 * size, (60, obstacle.dimension))

    def test_the_normal_is_the_gradient_of_the_separation(self, obstacle: Obstacle) -> None:
        at = _body(obstacle, {})
        h = 1e-6
        for q in self.points(obstacle, at):
            body = at(0.3, tuple(q))
            slope = [
                (at(0.3, tuple(q + h * e)).gap - at(0.3, tuple(q - h * e)).gap) / (2 * h)
                for e in np.eye(obstacle.dimension)
            ]
            assert normal(body, obstacle.dimension) == pytest.approx(slope, abs=1e-5)
            assert np.linalg.norm(normal(body, obstacle.dimension)) == pytest.approx(1.0, abs=1e-9)

    def test_the_surface_is_one_separation_away_along_the_normal(self, obstacle: Obstacle) -> None:
        at = _body(obstacle, {})
        for q in self.points(obstacle, at):
            body = at(0.3, tuple(q))
            if body.gap > 0:
                foot = q - body.gap * normal(body, obstacle.dimension)
                assert at(0.3, tuple(foot)).gap == pytest.approx(0.0, abs=1e-9)

    def test_the_circumscribed_ball_contains_it(self, obstacle: Obstacle) -> None:
        at = _body(obstacle, {})
        for q in self.points(obstacle, at):
            body = at(0.3, tuple(q))
            away = np.linalg.norm(q - centre(body, obstacle.dimension))
            assert away - body.radius <= body.gap + 1e-9

    def test_the_velocity_is_the_rate_of_the_position(self, obstacle: Obstacle) -> None:
        if obstacle.states:
            return  # its position is a state of the loop
        at = _body(obstacle, {})
        here = (0.0,) * obstacle.dimension
        for t in (-5.0, -0.2, 0.2, 1.1, 3.7):
            rate = (
                centre(at(t + 1e-6, here), obstacle.dimension) - centre(at(t - 1e-6, here), obstacle.dimension)
            ) / 2e-6
            assert speed(at(t, here), obstacle.dimension) == pytest.approx(rate, abs=1e-5)

    def test_before_the_start_it_moves_as_at_the_start(self, obstacle: Obstacle) -> None:
        """What tracks with latency observe: straight motions are extended, turns go on turning."""
        if obstacle.states:
            return  # latency extrapolates it back along its present velocity
        at, here, d = _body(obstacle, {}), (0.0,) * obstacle.dimension, obstacle.dimension
        now = speed(at(0.0, here), d)
        assert np.linalg.norm(now) > 0.1 or not obstacle.moving
        assert np.linalg.norm(speed(at(-2.0, here), d)) == pytest.approx(np.linalg.norm(now), rel=1e-9)
        if obstacle.rate is not None and not obstacle.rate.per:
            assert centre(at(-2.0, here), d) == pytest.approx(centre(at(0.0, here), d) - 2.0 * now, rel=1e-9)
        assert obstacle.moving or not speed(at(1.0, here), obstacle.dimension).any()

    def test_what_is_not_a_number_survives(self, obstacle: Obstacle) -> None:
        at = _body(obstacle, {})
        assert math.isnan(at(0.3, (math.nan,) * obstacle.dimension).gap)


class TestShapes:
    @pytest.mark.parametrize(
        ("q", "gap", "n"),
        [
            ((5.0, 0.2), 3.0, (1, 0)), ((-1.0, 4.0), 3.0, (0, 1)), ((5.0, 5.0), 5.0, (0.6, 0.8)),
            ((1.5, 0.0), -0.5, (1, 0)), ((0.0, -0.9), -0.1, (0, -1)),
        ],
    )  # fmt: skip
    def test_the_distance_to_a_box_is_exact(self, q: tuple[float, float], gap: float, n: tuple[float, float]) -> None:
        body = made("box", position_x=0.0, position_y=0.0, length=4.0, width=2.0)(0.0, q)
        assert (body.gap, body.nx, body.ny) == pytest.approx((gap, *n))

    def test_the_distance_to_a_turned_box_is_exact(self) -> None:
        body = made("box", position_x=1.0, position_y=2.0, length=4.0, width=2.0, angle=math.pi / 6)
        along = (math.cos(math.pi / 6), math.sin(math.pi / 6))
        seen = body(0.0, (1.0 + 5.0 * along[0], 2.0 + 5.0 * along[1]))
        assert (seen.gap, seen.nx, seen.ny) == pytest.approx((3.0, *along))

    @pytest.mark.parametrize(
        ("q", "gap", "n"),
        [
            ((30.0, 0.0, 10.0), 10.0, (1, 0, 0)), ((3.0, 4.0, 80.0), 30.0, (0, 0, 1)),
            ((0.0, 23.0, -54.0), 5.0, (0, 0.6, -0.8)), ((19.0, 0.0, 0.0), -1.0, (1, 0, 0)),
        ],
    )  # fmt: skip
    def test_the_distance_to_a_cylinder_is_exact(self, q: Any, gap: float, n: Any) -> None:
        at = made("cylinder", position_x=0.0, position_y=0.0, position_z=0.0, radius=20.0, height=100.0)
        body = at(0.0, q)
        assert (body.gap, body.nx, body.ny, body.nz) == pytest.approx((gap, *n))
        assert body.z == pytest.approx(min(max(q[2], -50.0), 50.0))

    def test_the_distance_to_a_box_in_space_is_exact(self) -> None:
        at = made("box_3d", position_x=0.0, position_y=0.0, position_z=0.0, length=2.0, width=4.0, height=6.0)
        assert at(0.0, (3.0, 4.0, 4.0)).gap == pytest.approx(3.0)
        assert at(0.0, (0.0, 0.0, 2.5)).gap == pytest.approx(-0.5)
        assert at(0.0, (0.5, 0.0, 0.0)).nx == 1.0


class TestPaths:
    def test_a_circle_goes_straight_and_stops(self) -> None:
        at = made("moving_circle", position_x=35.0, position_y=30.0, goal_x=15.0, goal_y=-25.0, speed=1.45)
        way = math.hypot(20.0, 55.0)
        half = at(0.5 * way / 1.45, (0.0, 0.0))
        assert (half.x, half.y) == pytest.approx((25.0, 2.5))
        assert math.hypot(half.vx, half.vy) == pytest.approx(1.45)
        end = at(way / 1.45 + 1.0, (0.0, 0.0))
        assert (end.x, end.y, end.vx, end.vy) == (15.0, -25.0, 0.0, 0.0)

    @pytest.mark.parametrize("speed", [0.0, 1.0])
    def test_a_circle_that_starts_at_its_goal_stays(self, speed: float) -> None:
        at = made("moving_circle", position_x=3.0, position_y=4.0, goal_x=3.0, goal_y=4.0, speed=speed)
        body = at(2.0, (3.0, 0.0))
        assert (body.x, body.y, body.gap) == pytest.approx((3.0, 4.0, 3.5))

    def test_a_circle_at_rest_stays(self) -> None:
        at = made("moving_circle", position_x=3.0, position_y=4.0, goal_x=30.0, goal_y=4.0, speed=0.0)
        assert (at(1e3, (0.0, 0.0)).x, at(1e3, (0.0, 0.0)).vx) == (3.0, 0.0)

    @pytest.mark.parametrize(
        ("t", "at", "v"),
        [
            (1.0, (2.0, 0.0), (2, 0)), (3.0, (4.0, 2.0), (0, 2)), (5.0, (2.0, 4.0), (-2, 0)),
            (7.0, (0.0, 2.0), (0, -2)), (9.0, (0.0, 0.0), (0, 0)),
        ],
    )  # fmt: skip
    def test_waypoints_lead_around_a_square(self, t: float, at: Any, v: Any) -> None:
        square = {"to1_x": 4.0, "to1_y": 0.0, "to2_x": 4.0, "to2_y": 4.0, "to3_x": 0.0, "to3_y": 4.0}
        body = made("waypoint_circle", position_x=0.0, position_y=0.0, speed=2.0, **square)(t, (9.0, 9.0))
        assert (body.x, body.y, body.vx, body.vy) == pytest.approx((*at, *v), abs=1e-9)

    def test_fewer_legs_end_sooner(self) -> None:
        at = made(
            "waypoint_circle", position_x=0.0, position_y=0.0, to1_x=4.0, to1_y=0.0, to2_x=4.0, to2_y=9.0, legs=1.0
        )
        body = at(50.0, (9.0, 9.0))
        assert (body.x, body.y, body.vx, body.vy) == pytest.approx((4.0, 0.0, 0.0, 0.0), abs=1e-9)

    def test_waypoints_in_space_are_reached_in_order(self) -> None:
        at = made(
            "waypoint_sphere", position_x=0.0, position_y=0.0, position_z=0.0, to1_x=0.0, to1_y=0.0, to1_z=-30.0,
            to2_x=40.0, to2_y=0.0, to2_z=-30.0, legs=2.0, speed=10.0,
        )  # fmt: skip
        body = at(5.0, (0.0, 0.0, 0.0))
        assert (body.x, body.z, body.vx, body.vz) == pytest.approx((20.0, -30.0, 10.0, 0.0))

    def test_an_orbit_returns_to_its_start(self) -> None:
        at = made("orbiting_circle", centre_x=1.0, centre_y=2.0, way=3.0, phase=0.4, speed=1.5)
        start, again = at(0.0, (0.0, 0.0)), at(2 * math.pi * 3.0 / 1.5, (0.0, 0.0))
        assert (again.x, again.y) == pytest.approx((start.x, start.y))
        assert (start.x, start.y) == pytest.approx((1.0 + 3.0 * math.cos(0.4), 2.0 + 3.0 * math.sin(0.4)))


INTRUDER = {"position": {"x": 8.0, "y": 0.3}, "goal": {"x": -8.0, "y": 0.3}, "radius": 0.5, "clearance": 2.0}


class TestGivesWay:
    @staticmethod
    @cache
    def distance(**given: float) -> tuple[float, Any]:
        """The closest approach [m] to a vehicle that heeds nothing, and the intruder's states."""
        problem = uncompiled(
            changed(
                CASE,
                avoider={"component": "none", "parameters": {"k_att": 15.0, "s": 1.0}},
                start={"x": 0.0, "y": 0.0, "theta": 0.0},
                goal={"x": 12.0, "y": 0.0},
                obstacles=[{"component": "cooperative_circle", "parameters": INTRUDER | given}],
                horizon=20.0,
            )
        )
        states = flight(problem)
        return float(np.hypot(*(states[:, :2] - states[:, -6:-4]).T).min()), states

    @pytest.mark.nightly
    def test_it_keeps_its_clearance_alone(self) -> None:
        assert self.distance(clearance=0.0)[0] < 0.4
        assert self.distance(sharing=0.0)[0] == pytest.approx(2.0, abs=0.25)

    @pytest.mark.nightly
    def test_by_the_rule_it_leaves_the_rest_to_the_other(self) -> None:
        alone, shared = self.distance(sharing=0.0)[0], self.distance(sharing=1.0)[0]
        assert 0.6 < shared < alone - 0.3

    def test_it_reaches_its_goal(self) -> None:
        _, states = self.distance(sharing=0.0)
        assert states[-1, -6:-2] == pytest.approx([-8.0, 0.3, 0.0, 0.0], abs=0.02)

    def test_undisturbed_it_moves_straight(self) -> None:
        _, states = self.distance(clearance=0.0)
        assert np.ptp(states[:, -5]) == pytest.approx(0.0, abs=1e-12)

    def test_two_that_share_keep_the_clearance_together(self) -> None:
        # Each turns by its fraction at first detection of the other: displacements at the closest approach add up.
        r, a, b = (10.0, 0.5, 0.0), (2.0, 0.0, 0.0), (-1.0, 0.0, 0.0)
        rules = Rules(3.0, 100.0, 1.0)
        side = (0.0, -1.0, 0.0)
        share = plain(resolve)
        tau, u_a = share(r, a, b, side, rules)
        tau_b, u_b = share(tuple(-c for c in r), b, a, side, rules)
        assert tau == tau_b == pytest.approx(10.0 / 3.0)
        moved_a = 2.0 * tau * u_a[1] / u_a[0]  # sideways when it has come as far ahead as it would have
        moved_b = -1.0 * tau * u_b[1] / u_b[0]
        assert moved_b - moved_a == pytest.approx(3.0 - 0.5)
        assert moved_b == pytest.approx(2.0 * -moved_a)
