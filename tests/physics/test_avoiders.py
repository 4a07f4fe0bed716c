"""Avoiders: gradients of the potentials, closed forms of the geometric laws, and each combined with each vehicle."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numba
import numpy as np
import pytest

from campaigns import library, load_file
from clearance.testing.problems import Problem
from tests.given.at_night import nightly_but
from tests.physics.in_space import OBSTACLES
from tests.physics.scenes import changed, flight, uncompiled
from worker.engine.components.avoiders import closest_approach, closest_approach_3d, ge_cui, gnron, gnron_3d, none
from worker.engine.components.obstacles import box, box_3d, circle, cylinder
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Avoider, Controller, Vehicle
from worker.engine.kernels.numba_internals import FLAGS
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.closest import NEVER, Rules, miss, resolve
from worker.running.catalogue.installed import components

CASE = load_file(library()["unicycle_static"])
BOX = box.Constants(*plain(box.derive)(box.Box(1.0, 3.2, 1.0, 0.6, 0.4), ()))
BOX3 = box_3d.Constants(*plain(box_3d.derive)(box_3d.Box3(1.0, 3.2, 0.5, 1.0, 0.6, 2.0, 0.4), ()))


def around(*q: float) -> tuple[Any, ...]:
    """A circle and a box, or a cylinder and a box in space, seen from q."""
    if len(q) == 2:
        return plain(circle.body)(0.0, (), q, circle.Circle(4.0, 4.0, 0.5)), plain(box.body)(0.0, (), q, BOX)
    stood = cylinder.Cylinder(4.0, 4.0, 0.0, 0.5, 3.0)
    return plain(cylinder.body)(0.0, (), q, stood), plain(box_3d.body)(0.0, (), q, BOX3)


def slope(potential: Any, q: Any, h: float = 1e-6) -> list[float]:
    """The gradient by central differences."""
    return [(potential(q + h * e) - potential(q - h * e)) / (2 * h) for e in np.eye(len(q))]


def pull(distance: float, k_att: float, s: float) -> float:
    """The conic-quadratic potential (2.7), k_att = 2 k_a."""
    return 0.5 * k_att * (distance**2 if distance <= s else 2 * s * distance - s**2)


class TestGradients:
    """A force is the negative gradient of its potential."""

    PLANE = ((3.0, 3.2), (2.0, 2.9), (0.4, 2.2), (5.0, 6.0), (2.6, 3.9), (-3.0, 8.0))
    SPACE = ((3.0, 3.2, 0.3), (2.0, 2.9, -1.0), (0.4, 2.2, 1.9), (5.0, 6.0, 2.0), (2.6, 3.9, 0.0), (4.2, 4.1, 2.2))

    @pytest.mark.parametrize("s", [1.5, 4.0, 1e9])
    @pytest.mark.parametrize("q", PLANE)
    def test_the_attraction_is_the_negative_gradient(self, q: tuple[float, float], s: float) -> None:
        goal = np.array([6.0, 7.0])
        force, _ = plain(none.steer)(0.0, q, (0.0, 0.0), none.Goal(*goal), (), (), none.Attraction(5.0, s))
        gradient = slope(lambda at: pull(float(np.linalg.norm(goal - at)), 5.0, s), np.array(q))
        assert force == pytest.approx([-g for g in gradient], rel=1e-6, abs=1e-6)

    @pytest.mark.parametrize("n", [0.0, 1.0, 2.0, 3.0])
    @pytest.mark.parametrize("q", PLANE + SPACE)
    def test_the_force_of_gnron_is_the_negative_gradient(self, q: tuple[float, ...], n: float) -> None:
        component: Any = (gnron if len(q) == 2 else gnron_3d).component
        p = component.parameters(5.0, 4.0, 2.0, n, 3.0)
        goal = np.array([6.0, 7.0, 1.0][: len(q)])

        def potential(at: Any) -> float:
            g = float(np.linalg.norm(goal - at))
            near = [b.gap for b in around(*at) if b.gap <= p.d_0]
            return pull(g, p.k_att, p.s) + sum(0.5 * p.k_rep * (1 / d - 1 / p.d_0) ** 2 * g**n for d in near)

        force, _ = plain(component.steer)(0.0, q, (0.0,) * len(q), component.goal(*goal), around(*q), (), p)
        assert force == pytest.approx([-g for g in slope(potential, np.array(q))], rel=1e-5, abs=1e-5)

    def test_the_repulsion_of_gnron_vanishes_at_the_goal(self) -> None:
        beside = plain(circle.body)(0.0, (), (6.0, 7.0), circle.Circle(6.5, 7.0, 0.3))
        for n in (1.0, 2.0, 3.0):
            p = gnron.Gnron(5.0, 4.0, 2.0, n)
            force, _ = plain(gnron.steer)(0.0, (6.0, 7.0), (0.0, 0.0), gnron.Goal(6.0, 7.0), (beside,), (), p)
            assert force == pytest.approx((0.0, 0.0), abs=1e-12)

    @pytest.mark.parametrize(
        ("q", "v"), [((3.0, 3.2), (0.9, 0.5)), ((2.2, 3.5), (0.8, -0.2)), ((4.4, 2.9), (0.1, 0.6))]
    )
    def test_the_force_of_ge_and_cui_is_the_negative_gradient(
        self, q: tuple[float, float], v: tuple[float, float]
    ) -> None:
        # The negative gradient over position and velocity (2.16). It is exact for a point: the printed F_rep2 turns n
        # with the distance from the surface, which is the distance from the centre only there.
        p = ge_cui.GeCui(k_att=0.0, eta=5.3, rho_0=4.0, A_max=0.71)
        at, moving = np.array([4.0, 4.0]), np.array([0.3, -0.4])

        def potential(state: Any) -> float:
            r = at - state[:2]
            distance = float(np.linalg.norm(r))
            closing = float((state[2:] - moving) @ r / distance)
            gap = distance - closing**2 / (2 * p.A_max)
            return p.eta * (1 / gap - 1 / p.rho_0) if closing > 0 and gap < p.rho_0 else 0.0

        d = math.dist(at, q)
        body = Body(*at, *moving, 0.0, d, (q[0] - at[0]) / d, (q[1] - at[1]) / d)
        force, _ = plain(ge_cui.steer)(0.0, q, v, ge_cui.Goal(9.0, 9.0), (body,), (), p)
        gradient = slope(potential, np.array([*q, *v]))
        assert force == pytest.approx([-gradient[0] - gradient[2], -gradient[1] - gradient[3]], rel=1e-6)

    def test_ge_cui_is_inactive_when_the_distance_grows_or_suffices(self) -> None:
        p = ge_cui.GeCui(k_att=0.0)
        steer = plain(ge_cui.steer)

        def force(v: tuple[float, float], gap: float) -> Any:
            body = Body(10.0, 0.0, 0.0, 0.0, 1.0, gap, -1.0, 0.0)
            return steer(0.0, (0.0, 0.0), v, ge_cui.Goal(0.0, 0.0), (body,), (), p)[0]

        assert force((-0.1, 0.0), 1.0) == (0.0, 0.0)
        assert force((0.5, 0.0), 4.0 + 0.25 / 1.42 + 1e-9) == (0.0, 0.0)
        assert force((0.5, 0.0), 4.0 + 0.25 / 1.42 - 1e-9)[0] < -0.3  # it jumps: the gradient does not vanish there
        assert force((0.5, 0.0), -2.0) == force((0.5, 0.0), 0.05)  # "not defined" in the paper: limited to the floor


class TestClosestApproach:
    RULES = Rules(3.0, 100.0, 0.0)

    def test_the_miss_is_across_the_relative_velocity(self) -> None:
        r, c = np.array([9.0, 2.0, -1.0]), np.array([-2.0, 0.3, 0.2])
        tau, found = plain(miss)(tuple(r), tuple(c))
        unit = c / np.linalg.norm(c)
        assert found == pytest.approx(np.cross(unit, np.cross(r, unit)))
        assert tau == pytest.approx(-r @ c / (c @ c))

    @pytest.mark.parametrize(
        ("r", "other"),
        [
            ((-9.0, 0.5, 0.0), (0.0, 0.0, 0.0)),  # behind
            ((9.0, 3.5, 0.0), (0.0, 0.0, 0.0)),  # abeam by more than the clearance
            ((400.0, 0.0, 0.0), (0.0, 0.0, 0.0)),  # beyond the horizon
            ((9.0, 0.5, 0.0), (3.0, 0.0, 0.0)),  # faster, the same way
        ],
    )
    def test_without_a_conflict_nothing_is_resolved(self, r: Any, other: Any) -> None:
        assert plain(resolve)(r, (2.0, 0.0, 0.0), other, (0.0, -1.0, 0.0), self.RULES)[0] == NEVER

    @pytest.mark.parametrize("r", [(9.0, 0.5, 0.0), (9.0, -0.7, 0.4), (5.0, 2.0, 0.0)])
    def test_flying_the_resolution_keeps_the_clearance(self, r: Any) -> None:
        own, other = np.array([2.0, 0.0, 0.0]), np.array([-1.0, 0.2, 0.1])
        tau, u = plain(resolve)(r, tuple(own), tuple(other), (0.0, -1.0, 0.0), self.RULES)
        assert np.linalg.norm(u) == pytest.approx(2.0)
        _, m = plain(miss)(r, tuple(other - own))
        moved = np.array(u) * np.dot(own, own) * tau / np.dot(u, own) - own * tau  # as far ahead as without it
        wanted = -(3.0 - np.linalg.norm(m)) * np.array(m) / np.linalg.norm(m)
        # it has the direction of V tau - (r_safe - r_m) m^
        assert np.cross(u, own * tau + wanted) == pytest.approx(np.zeros(3), abs=1e-12)
        assert np.dot(moved, wanted) > 0

    def test_head_on_it_turns_right(self) -> None:
        plane = closest_approach.ClosestApproach(speed=2.0, clearance=1.0, horizon=20.0)
        ahead = Body(8.0, 0.0, -1.0, 0.0, 0.5, 7.5, -1.0, 0.0)
        u, _ = plain(closest_approach.steer)(
            0.0, (0.0, 0.0), (2.0, 0.0), closest_approach.Goal(20.0, 0.0), (ahead,), (), plane
        )
        assert u[1] < 0
        space = closest_approach_3d.ClosestApproach(speed=2.0, clearance=1.0, horizon=20.0)
        there = Body3(8.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.5, 7.5, -1.0, 0.0, 0.0)
        component = closest_approach_3d.component
        u3, _ = plain(component.steer)(
            0.0, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), component.goal(20.0, 0.0, 0.0), (there,), (), space
        )
        assert u3[1] > 0  # z is down: y is right of x
        assert (u3[0], -u3[1], u3[2]) == pytest.approx((*u, 0.0))

    def test_the_soonest_conflict_is_resolved(self) -> None:
        p = closest_approach.ClosestApproach(speed=2.0, clearance=1.0, horizon=20.0)
        goal = closest_approach.Goal(20.0, 0.0)
        near, far = Body(4.0, 0.3, 0, 0, 0.5, 3.5, -1.0, 0.0), Body(9.0, -0.3, 0, 0, 0.5, 8.5, -1.0, 0.0)
        steer = plain(closest_approach.steer)
        demands = [steer(0.0, (0.0, 0.0), (2.0, 0.0), goal, b, (), p)[0] for b in ((near,), (near, far), (far, near))]
        assert demands[0] == demands[1] == demands[2]
        assert demands[0][1] < 0

    def test_it_slows_down_at_the_goal(self) -> None:
        p = closest_approach.ClosestApproach(speed=2.0, k_goal=1.0)
        goal = closest_approach.Goal(3.0, 4.0)
        steer = plain(closest_approach.steer)
        assert steer(0.0, (0.0, 0.0), (0.0, 0.0), goal, (), (), p)[0] == pytest.approx((1.2, 1.6))
        assert steer(0.0, (3.0, 3.5), (0.0, 0.0), goal, (), (), p)[0] == pytest.approx((0.0, 0.5))


VEHICLES = [c for c in components().values() if isinstance(c, Vehicle)]
AVOIDERS = [c for c in components().values() if isinstance(c, Avoider)]
PAIRS = [(v, a) for v, a in itertools.product(VEHICLES, AVOIDERS) if v.dimension == a.dimension]
SOME = [
    pytest.param(v, a, marks=() if (VEHICLES.index(v) + AVOIDERS.index(a)) % 2 == 0 else pytest.mark.nightly)
    for v, a in PAIRS
]
SPACE = load_file(library()["uav_static"])


def in_space(vehicle: Vehicle, avoider: Avoider, horizon: float) -> Any:
    """A vehicle passing a cylinder, a box, a sphere on waypoints and a cooperative one; otherwise as in case 3."""
    goal = {"x": 500.0, "y": 530.0, "z": -50.0}
    return changed(
        SPACE,
        vehicle={"component": vehicle.name},
        avoider={"component": avoider.name},
        goal={k: v for k, v in goal.items() if k in avoider.goal._fields},  # type: ignore[attr-defined]
        obstacles=[
            {"component": name, "parameters": OBSTACLES[name]}
            for name in ("cylinder", "box_3d", "waypoint_sphere", "cooperative_sphere")
        ],
        horizon=horizon,
    )


def encounter(vehicle: Vehicle, avoider: Avoider, horizon: float = 20.0) -> Any:
    """A vehicle passing a circle, a box and a crossing circle; everything else at its defaults."""
    if vehicle.dimension == 3:
        return in_space(vehicle, avoider, horizon)
    fits = next(c for c in components().values() if isinstance(c, Controller) and vehicle.name in c.fits)
    weak = {"k_att": 0.5, "s": 4.0} if "s" in avoider.parameters._fields else {}  # type: ignore[attr-defined]
    return changed(
        CASE,
        vehicle={"component": vehicle.name},
        controller={"component": fits.name},
        avoider={"component": avoider.name, "parameters": weak},
        start={"x": 0.0, "y": 0.0},
        goal={"x": 9.0, "y": 1.0},
        obstacles=[
            {"component": "circle", "parameters": {"position": {"x": 4.0, "y": -0.4}, "radius": 0.3}},
            {"component": "box", "parameters": {"position": {"x": 6.0, "y": 3.0}, "angle": 0.5}},
            {
                "component": "moving_circle",
                "parameters": {"position": {"x": 7.0, "y": 6.0}, "goal": {"x": 6.0, "y": -6.0}},
            },
        ],
        horizon=horizon,
        step=0.005,
    )


ALONE = ("none", "none_3d", "cruise_3d", "orca", "right_of_way_3d")


def alone(avoider: Any) -> Any:
    """What an avoider demands of two obstacles, as the loop calls it."""
    first, weigh, steer = avoider.first, avoider.weigh, avoider.steer

    def of_all(q: Any, v: Any, goal: Any, bodies: Any, memory: Any, p: Any) -> Any:
        return steer(0.0, q, v, goal, bodies, memory, p)

    def one_by_one(q: Any, v: Any, goal: Any, bodies: Any, memory: Any, p: Any) -> Any:
        weighed = first(0.0, q, v, goal, memory, p)
        weighed = weigh(weighed, 0.0, bodies[0], 0.0, q, v, goal, memory, p)
        weighed = weigh(weighed, 1.0, bodies[1], 0.0, q, v, goal, memory, p)
        return steer(0.0, q, v, goal, weighed, memory, p)

    return of_all if weigh is None else one_by_one


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", nightly_but(("none", "none_3d", "orca"), ALONE))
def test_compiled_alone_they_demand_what_they_do_in_plain_python(name: str) -> None:
    """The loops with them are compiled at night only: by day their simulations are in plain Python."""
    avoider: Any = components()["avoider", name]
    v = (0.5, -0.5, 0.2)[: avoider.dimension]
    goal = avoider.goal(*(4.0 + k for k in range(len(avoider.goal._fields))))
    p = type(avoider.parameters())(*map(float, avoider.parameters()))
    memory = avoider.remember(p)
    compiled, plainly = numba.njit(**FLAGS)(alone(avoider)), plain(alone(avoider))
    for place in ((1.0, 2.0, 3.0), (3.2, 3.4, 1.0), (-2.0, 5.0, 0.0)):
        q = place[: avoider.dimension]
        given = q, v, goal, around(*q), memory, p
        demand, kept = compiled(*given)
        expected, remembered = plainly(*given)
        assert demand == pytest.approx(expected, rel=1e-9, abs=1e-12)
        assert kept == pytest.approx(remembered, rel=1e-9, abs=1e-12)


class TestFlown:
    # By day each avoider with a vehicle, the next with the next; all pairs for a few steps: test_pairs.py.
    @pytest.mark.by_day(5)
    @pytest.mark.parametrize(("vehicle", "avoider"), SOME, ids=lambda c: c.name)
    def test_each_avoider_with_each_vehicle(self, vehicle: Vehicle, avoider: Avoider) -> None:
        system = uncompiled(encounter(vehicle, avoider, horizon=5.0 if vehicle.dimension == 3 else 2.5)).system
        made = system.loop.simulate(system.nominal[None], system.step, *system.counts(system.step), traced=1)
        status, reasons = system.judge(made.status, made.when)
        assert status[0] == 0, reasons
        assert np.isfinite(made.trace).all()

    @pytest.mark.nightly
    @pytest.mark.parametrize("name", ["orca", "closest_approach", "gnron"])
    def test_lockstep_equals_plain_python(self, name: str) -> None:
        avoider = next(a for a in AVOIDERS if a.name == name)
        robot = next(v for v in VEHICLES if v.name == "pioneer_3dx")
        campaign = encounter(robot, avoider, horizon=3.0)
        fast, slow = Problem(campaign), uncompiled(campaign)
        assert flight(slow) == pytest.approx(flight(fast), abs=1e-12)
