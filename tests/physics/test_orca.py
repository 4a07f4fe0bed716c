"""ORCA: half-planes against the velocity obstacle, the solution against a general optimiser, simulations of case 2."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from campaigns import library, load_file
from clearance.testing.problems import Problem
from tests.physics.scenes import cost, uncompiled
from worker.engine.components.avoiders import orca
from worker.engine.kernels.bind import plain
from worker.engine.kernels.views import Body
from worker.engine.reference.reference import Reference

CORNER = {
    "vehicle.m": 34.0, "vehicle.B_e": 0.48, "vehicle.delta_u": 0.9, "vehicle.delta_w": 0.1, "vehicle.I_e": 3.8,
    "vehicle.u_s": 0.02, "faults.0.dx": 0.5, "faults.0.dy": -0.5,
}  # fmt: skip


def disc(x: float, y: float, vx: float = 0.0, vy: float = 0.0, radius: float = 0.5) -> Body:
    d = math.hypot(x, y)
    return Body(x, y, vx, vy, radius, d - radius, -x / d, -y / d)


class TestOrca:
    P = orca.Orca(speed=1.0, v_max=1.5, radius=0.5, tau=5.0, c=1.0)
    GOAL = orca.Goal(20.0, 0.0)

    def steer(self, v: tuple[float, float], *bodies: Body, p: orca.Orca = P) -> tuple[float, float]:
        return plain(orca.steer)((0.0), (0.0, 0.0), v, self.GOAL, bodies, (), p)[0]  # type: ignore[no-any-return]

    @pytest.mark.parametrize("body", [disc(0.0, 6.0), disc(-3.0, 0.0), disc(7.0, 0.0), disc(3.0, 0.0, 1.5, 0.0)])
    def test_nothing_in_the_way(self, body: Body) -> None:
        # abeam; behind; ahead, but farther than tau; ahead and faster
        assert self.steer((1.0, 0.0), body) == pytest.approx((1.0, 0.0))

    def test_straight_at_a_far_disc_it_slows_down(self) -> None:
        # nearest edge of the velocity obstacle is its rounded end: (distance - R) / tau
        found = self.steer((0.78, 0.0), disc(5.0, 0.0))
        assert found == pytest.approx((4.0 / 5.0, 0.0))

    def test_near_a_disc_it_takes_the_tangent(self) -> None:
        # half-angle asin(R / distance), R = 1, distance 2: the tangent is at 30 degrees, (1, 0) projects to cos 30
        u = self.steer((1.0, -1e-9), disc(2.0, 0.0))
        assert u == pytest.approx((0.75, -math.sqrt(3) / 4), abs=1e-6)

    def test_half_the_change_when_both_make_it(self) -> None:
        half = orca.Orca(speed=1.0, v_max=1.5, radius=0.5, tau=5.0, c=0.5)
        body = disc(2.0, 0.3)
        line, other = (plain(orca.half_plane)(body, (0.0, 0.0), (1.0, 0.0), p) for p in (self.P, half))
        assert (other[0] - 1.0, other[1]) == pytest.approx((0.5 * (line[0] - 1.0), 0.5 * line[1]))

    @pytest.mark.by_day(4)
    @pytest.mark.parametrize("seed", range(12))
    def test_the_half_plane_touches_the_velocity_obstacle(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        body = disc(*random.uniform(-4, 4, 2), *random.uniform(-1, 1, 2), 0.3)
        v = random.uniform(-1.5, 1.5, 2)
        px, py, nx, ny = plain(orca.half_plane)(body, (0.0, 0.0), tuple(v), self.P)
        r, R = np.array([body.x, body.y]), body.radius + self.P.radius
        if math.hypot(*r) <= R:
            return
        t = np.linspace(0.0, self.P.tau, 20001)[:, None]

        def nearest(w: Any) -> float:
            return float(np.linalg.norm(r - np.asarray(w) * t, axis=1).min() - R)

        w = np.array([px, py]) - [body.vx, body.vy]
        assert nearest(w) == pytest.approx(0.0, abs=1e-3)  # on its edge
        assert nearest(w + 1e-2 * np.array([nx, ny])) > 0 > nearest(w - 1e-2 * np.array([nx, ny]))
        u = np.linalg.norm(w - (v - [body.vx, body.vy]))
        inside = nearest(v - [body.vx, body.vy]) < 0
        for angle in np.linspace(0, 2 * np.pi, 60):  # and nowhere is the edge nearer
            tried = v - [body.vx, body.vy] + 0.98 * u * np.array([np.cos(angle), np.sin(angle)])
            assert (nearest(tried) < 1e-3) == inside or abs(nearest(tried)) < 2e-3

    @pytest.mark.parametrize("seed", range(20))
    def test_it_is_the_nearest_velocity_that_is_permitted(self, seed: int) -> None:
        random = np.random.default_rng(100 + seed)
        angles = random.uniform(0, 2 * np.pi, 3)
        bodies = [
            disc(d * np.cos(a), d * np.sin(a), *random.uniform(-0.7, 0.7, 2))
            for a, d in zip(angles, random.uniform(1.5, 5, 3), strict=True)
        ]
        v = tuple(random.uniform(-0.8, 0.8, 2))
        lines = [plain(orca.half_plane)(b, (0.0, 0.0), v, self.P) for b in bodies]
        limits: list[Any] = [
            {"type": "ineq", "fun": lambda u, k=k: (u[0] - k[0]) * k[2] + (u[1] - k[1]) * k[3]} for k in lines
        ]
        limits.append({"type": "ineq", "fun": lambda u: self.P.v_max**2 - u @ u})
        best = minimize(lambda u: (u[0] - 1) ** 2 + u[1] ** 2, (0.1, 0.1), constraints=limits, options={"ftol": 1e-14})
        if not best.success or min(k["fun"](best.x) for k in limits) < -1e-7:
            return  # no velocity is permitted
        assert self.steer(v, *bodies) == pytest.approx(best.x, abs=1e-5)

    def test_hemmed_in_it_stays_within_its_speed(self) -> None:
        ring = [disc(0.9 * math.cos(a), 0.9 * math.sin(a)) for a in np.linspace(0, 5, 6)]
        u = self.steer((1.0, 0.0), *ring)
        assert math.hypot(*u) <= 1.5 + 1e-12

    def test_a_mirrored_scene_has_a_mirrored_velocity(self) -> None:
        a = self.steer((0.9, 0.1), disc(2.0, 0.4, -0.3, 0.2), disc(3.0, -1.0, 0.0, 0.3))
        b = self.steer((0.9, -0.1), disc(2.0, -0.4, -0.3, -0.2), disc(3.0, 1.0, 0.0, -0.3))
        assert a == pytest.approx((b[0], -b[1]))

    def test_of_five_in_the_way_the_worst_three_count(self) -> None:
        # The three that are violated most in turn: those alone give the same demand.
        bodies = [disc(1.6, 0.9), disc(1.6, -0.9), disc(4.0, 0.1), disc(3.5, 2.0), disc(3.5, -2.0)]
        u = self.steer((0.9, 0.0), *bodies)
        lines = [plain(orca.half_plane)(b, (0.0, 0.0), (0.9, 0.0), self.P) for b in bodies]
        kept = [(u[0] - k[0]) * k[2] + (u[1] - k[1]) * k[3] for k in lines]
        assert math.hypot(*u) <= 1.5 + 1e-12
        assert sum(k >= -1e-6 for k in kept) >= 3


class TestCase2:
    """The encounter of case 2: a continuous demand, so that step and integrator do not matter."""

    CAMPAIGN = load_file(library()["pioneer_orca"])
    PROBLEM = Problem(CAMPAIGN)
    ANCHORS = pytest.mark.parametrize(("values", "d_min"), [({}, 7.8748), (CORNER, 5.7945)])

    @pytest.mark.by_day(1)
    @ANCHORS
    def test_d_min_is_the_known_value(self, values: dict[str, float], d_min: float) -> None:
        """In plain Python; compiled alone in test_avoiders.py."""
        assert cost(uncompiled(self.CAMPAIGN), values) == pytest.approx(d_min, abs=1e-4)

    @pytest.mark.nightly  # a loop and an integrator for two simulations
    @ANCHORS
    def test_step_and_integrator_do_not_matter(self, values: dict[str, float], d_min: float) -> None:
        found = cost(self.PROBLEM, values)
        assert found == pytest.approx(d_min, abs=1e-4)
        assert cost(self.PROBLEM, values, self.PROBLEM.system.step / 2) == pytest.approx(found, abs=3e-6)
        other = Reference(self.PROBLEM.system).simulate(self.PROBLEM.vector(values))
        assert not other.reason
        assert other.cost == pytest.approx(found, abs=3e-6)
