"""Avoidance in space: gradients of the potentials, equation 7.7 and its geometry, gates and sides, rights of way.

Everything here asks the avoiders' own kernels, in plain Python, for one demand.
"""

from __future__ import annotations

import math
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from worker.engine.components.avoiders import (
    cruise_3d,
    ge_cui_3d,
    minimum_deviation_3d,
    none_3d,
    potential_field_3d,
    right_of_way_3d,
)
from worker.engine.components.obstacles import moving_sphere, sphere
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import declared
from worker.engine.physics import resolution
from worker.engine.physics.resolution import Plan

NOWHERE = (0.0, 0.0, 0.0)


def body(
    x: float, y: float, z: float, speed: float = 0.0, heading: float = 0.0, climb: float = 0.0, radius: float = 0.0
) -> Any:
    """An intruder as seen from any q: a function of q."""
    p = moving_sphere.Constants(
        *plain(moving_sphere.derive)(moving_sphere.MovingSphere(x, y, z, speed, heading, climb, radius), ())
    )
    return lambda q: plain(moving_sphere.body)(0.0, (), q, p)


def parameters(file: ModuleType, **given: float) -> Any:
    fields: Any = file.component.parameters
    return fields(**{p.field: given.get(p.field, p.default) for p in declared(fields)})


def ask(
    file: ModuleType,
    around: Any,
    q: Any = NOWHERE,
    v: Any = (20.0, 0.0, 0.0),
    goal: Any = None,
    memory: Any = None,
    **given: float,
) -> Any:
    """Demand and memory of one guidance sample; by default heading north at 20 m/s."""
    p = parameters(file, **given)
    goal = Plan(20.0, 0.0, 0.0) if goal is None else goal
    memory = plain(file.component.remember)(p) if memory is None else memory
    if file.component.weigh is None:
        return plain(file.component.steer)(0.0, q, v, goal, tuple(b(q) for b in around), memory, p)
    so_far = plain(file.component.first)(0.0, q, v, goal, memory, p)
    for i, b in enumerate(around):
        so_far = plain(file.component.weigh)(so_far, float(i), b(q), 0.0, q, v, goal, memory, p)
    return plain(file.component.steer)(0.0, q, v, goal, so_far, memory, p)


def slope(of: Any, at: Any) -> list[float]:
    found = []
    for k in range(3):
        ends = []
        for h in (1e-4, -1e-4):
            there = list(at)
            there[k] += h
            ends.append(of(tuple(there)))
        found.append((ends[0] - ends[1]) / 2e-4)
    return found


class TestPotentials:
    SPHERES = ((30.0, 5.0, -4.0, 6.0), (12.0, -20.0, 3.0, 2.0), (-10.0, 9.0, 8.0, 4.0))

    @pytest.mark.parametrize("s", [1e9, 25.0])
    def test_the_static_force_is_the_gradient(self, s: float) -> None:
        p, goal = {"k_att": 0.7, "k_rep": 300.0, "d_0": 18.0, "s": s}, potential_field_3d.Goal(60.0, 10.0, -12.0)
        around = [lambda q, of=of: plain(sphere.body)(0.0, (), q, sphere.Sphere(*of)) for of in self.SPHERES]

        def potential(q: Any) -> float:
            far = math.dist(q, goal)
            total = 0.5 * p["k_att"] * far**2 if far <= s else p["k_att"] * s * (far - 0.5 * s)
            for x, y, z, radius in self.SPHERES:
                d = math.dist(q, (x, y, z)) - radius
                total += 0.5 * p["k_rep"] * (1 / d - 1 / p["d_0"]) ** 2 if d <= p["d_0"] else 0.0
            return total

        for q in [(16.0, 4.0, 1.0), (24.0, 12.0, -3.0), (0.0, 0.0, 0.0), (45.0, 12.0, -12.0), (-2.0, 5.0, 4.0)]:
            force, _ = ask(potential_field_3d, around, q, goal=goal, **p)
            assert force == pytest.approx([-f for f in slope(potential, q)], rel=1e-6, abs=1e-6)

    def test_the_moving_force_is_the_gradient_over_position_and_velocity(self) -> None:
        # for a point, whose distance and that of its surface are one
        p = {"k_att": 0.7, "eta": 900.0, "rho_0": 60.0, "A_max": 9.0}
        goal, at, own = ge_cui_3d.Goal(90.0, 10.0, -12.0), (45.0, 9.0, -5.0), (6.0, -2.0, -0.5)
        centre = body(*at, 6.4, 2.8, 0.2)

        def potential(q: Any, v: Any) -> float:
            b = centre(q)
            d = math.dist(q, at)
            closing = sum((a - c) * (e - f) / d for a, c, e, f in zip(v, (b.vx, b.vy, b.vz), at, q, strict=True))
            left = d - closing**2 / (2 * p["A_max"])
            attraction = 0.5 * p["k_att"] * math.dist(q, goal) ** 2
            return attraction + (p["eta"] * (1 / left - 1 / p["rho_0"]) if closing > 0 and left < p["rho_0"] else 0.0)

        for q, v in [((4.0, 3.0, 1.0), own), ((20.0, -6.0, 4.0), own), ((20.0, -6.0, 4.0), (-12.0, 3.0, 1.0))]:
            force, _ = ask(ge_cui_3d, [centre], q, v, goal, **p)
            over_q, over_v = slope(lambda x, v=v: potential(x, v), q), slope(lambda x, q=q: potential(q, x), v)
            assert force == pytest.approx([-a - b for a, b in zip(over_q, over_v, strict=True)], rel=1e-6, abs=1e-6)

    def test_nothing_is_avoided_without_avoidance(self) -> None:
        around = [body(100.0, 0.0, 0.0)]
        force, _ = ask(none_3d, around, goal=none_3d.component.goal(30.0, -40.0, 12.0), k_att=2.0, s=6.5)
        assert force == pytest.approx([13.0 * 30 / 51.42, -13.0 * 40 / 51.42, 13.0 * 12 / 51.42], rel=1e-3)
        velocity, _ = ask(cruise_3d, around, goal=Plan(20.0, math.pi / 2, 0.3))
        assert velocity == pytest.approx([0.0, 20 * math.cos(0.3), -20 * math.sin(0.3)], abs=1e-12)


class TestResolution:
    def seen(self, around: Any, q: Any = NOWHERE, v: Any = (20.0, 0.0, 0.0), **given: float) -> Any:
        p = parameters(minimum_deviation_3d, **{"eta_max": 1.6} | given)
        own = plain(resolution.own_reading)(v, Plan(20.0, 0.0, 0.0), p)
        return plain(resolution.perceive)(q, v, own, around(q), p)

    INTRUDERS = (
        (300.0, 60.0, 20.0, 15.0, 2.8, 0.05),
        (250.0, -90.0, -30.0, 18.0, 1.4, -0.1),
        (400.0, 5.0, 0.0, 20.0, 3.0, 0.0),
    )

    @pytest.mark.parametrize("intruder", INTRUDERS)
    def test_the_miss_is_that_of_equation_7_1(self, intruder: Any) -> None:
        e = self.seen(body(*intruder))
        r, w = np.array(intruder[:3]), np.array(e.relative)
        assert e.miss == pytest.approx(np.linalg.norm((r @ w) / (w @ w) * w - r), rel=1e-9)
        # and that of two straight flights
        t = np.linspace(0.0, 60.0, 600_001)
        assert e.miss == pytest.approx(np.linalg.norm(r[:, None] - w[:, None] * t, axis=0).min(), abs=1e-4)
        assert e.wait == pytest.approx(t[np.linalg.norm(r[:, None] - w[:, None] * t, axis=0).argmin()], abs=2e-4)

    @pytest.mark.parametrize("intruder", INTRUDERS)
    @pytest.mark.parametrize("side", [0.0, 1.0, -1.0])
    def test_the_demand_passes_at_the_planning_radius_with_the_least_change(self, intruder: Any, side: float) -> None:
        e = self.seen(body(*intruder), radius=80.0)
        h, xi = plain(resolution.aside)(e, side)
        demand = np.array(plain(resolution.resolve)(e, h, xi))
        r, w = np.array(intruder[:3]), demand - np.array(e.other)
        assert np.linalg.norm(np.cross(r, w)) / np.linalg.norm(w) == pytest.approx(80.0, rel=1e-9)
        if side == 0.0 or intruder[2] == intruder[5] == 0.0:  # a committed side is horizontal
            assert (demand - np.array(e.own)) @ w == pytest.approx(0.0, abs=1e-8)  # square to what it leads to

    @pytest.mark.parametrize("intruder", INTRUDERS)
    def test_equals_equation_7_7_where_that_has_a_value(self, intruder: Any) -> None:
        e = self.seen(body(*intruder), radius=80.0)
        h, xi = plain(resolution.aside)(e, 0.0)
        size = np.linalg.norm(e.relative)
        printed = (
            size * math.cos(e.turn - xi) / math.sin(xi)
            * (math.sin(e.turn) * np.array(e.relative) / size - math.sin(e.turn - xi) * np.array(e.n))
            + np.array(e.other)
        )  # fmt: skip
        assert plain(resolution.resolve)(e, h, xi) == pytest.approx(printed, rel=1e-9)

    def test_readings_carry_their_errors(self) -> None:
        around = body(300.0, 60.0, 20.0, 15.0, 2.8, 0.1)
        e = self.seen(around, du=1.5, dpsi=0.1, du0=-2.0, dpsi0=0.15)
        assert e.own == pytest.approx([21.5 * math.cos(0.1), 21.5 * math.sin(0.1), 0.0], abs=1e-12)
        level = 13.0 * math.cos(0.1)
        assert e.other == pytest.approx(
            [level * math.cos(2.65), level * math.sin(2.65), -13.0 * math.sin(0.1)], abs=1e-9
        )
        now = self.seen(around, v=(3.0, 4.0, -1.0), du=1.0, dpsi=0.5, instant=1.0)
        assert np.linalg.norm(now.own) == pytest.approx(math.sqrt(26) + 1.0)
        assert math.atan2(now.own[1], now.own[0]) == pytest.approx(math.atan2(4.0, 3.0) + 0.5)
        assert self.seen(body(300.0, 0.0, 0.0), du0=2.0).other == pytest.approx(NOWHERE)  # what rests has no track

    @pytest.mark.parametrize(("side", "sign"), [(-1.0, -1.0), (1.0, 1.0), (0.0, -1.0), (2.0, -1.0)])
    def test_the_side_is_the_stated_or_the_nearer_one(self, side: float, sign: float) -> None:
        # the relative velocity points left of the intruder: 7.7 goes left, and so does a side taken at first
        velocity, memory = ask(minimum_deviation_3d, [body(300.0, 20.0, 0.0, 20.0, math.pi)], side=side)
        assert math.copysign(1.0, velocity[1]) == sign
        if side == 2.0:
            assert memory[1] == -1.0
            other_side = [body(300.0, -20.0, 0.0, 20.0, math.pi)]
            velocity, memory = ask(minimum_deviation_3d, other_side, side=2.0, memory=memory)
            assert velocity[1] < 0.0

    @pytest.mark.parametrize(
        ("gate", "conflict", "clear"), [(0.0, True, True), (1.0, True, False), (2.0, True, False), (4.0, True, False)]
    )
    def test_a_gate_limits_what_is_avoided(self, gate: float, conflict: bool, clear: bool) -> None:
        for y, acts in ((10.0, conflict), (200.0, clear)):
            velocity, _ = ask(minimum_deviation_3d, [body(300.0, y, 0.0, 20.0, math.pi)], gate=gate, side=-1.0)
            assert (velocity != pytest.approx([20.0, 0.0, 0.0])) is acts

    def test_a_latched_gate_stays_active_until_nothing_comes_closer(self) -> None:
        near, far, gone = ([body(x, y, 0.0, 20.0, math.pi)] for x, y in ((300.0, 10.0), (300.0, 200.0), (-300.0, 0.0)))
        _, memory = ask(minimum_deviation_3d, near, gate=2.0)
        velocity, memory = ask(minimum_deviation_3d, far, gate=2.0, memory=memory)
        assert velocity != pytest.approx([20.0, 0.0, 0.0])
        velocity, memory = ask(minimum_deviation_3d, gone, gate=2.0, memory=memory)
        assert (velocity, memory[0]) == (pytest.approx([20.0, 0.0, 0.0]), 0.0)

    def test_a_holding_gate_holds_the_last_demand(self) -> None:
        first, memory = ask(minimum_deviation_3d, [body(300.0, 10.0, 0.0, 20.0, math.pi)], gate=3.0)
        held, _ = ask(minimum_deviation_3d, [body(300.0, 200.0, 0.0, 20.0, math.pi)], gate=3.0, memory=memory)
        assert held == first

    def test_an_intruder_out_of_range_or_moving_away_is_ignored(self) -> None:
        for around in (body(601.0, 0.0, 0.0, 20.0, math.pi), body(300.0, 0.0, 0.0, 30.0, 0.0)):
            assert ask(minimum_deviation_3d, [around])[0] == pytest.approx([20.0, 0.0, 0.0])

    def test_of_several_conflicts_the_soonest_counts(self) -> None:
        soon, late = body(200.0, 5.0, 0.0, 20.0, math.pi), body(500.0, -5.0, 30.0, 20.0, math.pi)
        alone = ask(minimum_deviation_3d, [soon], gate=1.0)[0]
        assert ask(minimum_deviation_3d, [late, soon], gate=1.0)[0] == alone
        assert ask(minimum_deviation_3d, [soon, late], gate=1.0)[0] == alone


class TestRightOfWay:
    """Heading north at 20 m/s; every intruder is on a collision course."""

    ENCOUNTERS = {  # noqa: RUF012
        "head-on": (body(400.0, 2.0, 0.0, 20.0, math.pi - 0.1), True),
        "from the right": (body(300.0, 300.0, 0.0, 20.0, -math.pi / 2), True),
        "from the right, slanting": (body(400.0, 165.0, 0.0, 20.0, -2.36), True),
        "from the left": (body(300.0, -300.0, 0.0, 20.0, math.pi / 2), False),
        "overtaking": (body(200.0, -3.0, 0.0, 8.0, 0.0), True),
        "overtaking what crosses from the left": (body(300.0, -70.0, 0.0, 8.0, 0.6), True),
        "overtaken": (body(-200.0, 2.0, 0.0, 35.0, 0.0), False),
        "overtaken from the right": (body(-200.0, 50.0, 0.0, 35.0, -0.17), False),
    }

    @pytest.mark.parametrize("encounter", ENCOUNTERS)
    def test_who_gives_way_turns_right(self, encounter: str) -> None:
        around, gives_way = self.ENCOUNTERS[encounter]
        velocity, memory = ask(right_of_way_3d, [around], last_resort=0.0)
        duty = right_of_way_3d.GIVES_WAY if gives_way else right_of_way_3d.STANDS_ON
        assert memory == (right_of_way_3d.OVERTAKEN if encounter.startswith("overtaken") else duty, 0.0)
        if gives_way:
            assert velocity[1] > 0.5
        else:
            assert velocity == pytest.approx([20.0, 0.0, 0.0])

    @pytest.mark.parametrize(("encounter", "sign"), [("from the left", -1.0), ("overtaken from the right", 1.0)])
    def test_as_a_last_resort_it_acts(self, encounter: str, sign: float) -> None:
        velocity, _ = ask(right_of_way_3d, [self.ENCOUNTERS[encounter][0]], last_resort=60.0)
        assert sign * velocity[1] > 0.5  # behind what comes from the left, away from what overtakes

    def test_a_duty_lasts_as_long_as_its_conflict(self) -> None:
        right, left = (body(300.0, y, 0.0, 20.0, h) for y, h in ((300.0, -math.pi / 2), (-300.0, math.pi / 2)))
        _, memory = ask(right_of_way_3d, [right])
        assert ask(right_of_way_3d, [left], memory=memory)[0][1] > 0.5  # as if it had come from the left by manoeuvring
        gone = body(-300.0, 0.0, 0.0, 20.0, math.pi)
        assert ask(right_of_way_3d, [gone], memory=memory)[1][0] == -1.0

    def test_the_resolution_is_that_of_the_side_right(self) -> None:
        around = [self.ENCOUNTERS["from the right"][0]]
        expected = ask(minimum_deviation_3d, around, side=1.0, gate=1.0)[0]
        assert ask(right_of_way_3d, around)[0] == expected

    def test_without_a_conflict_the_plan_is_followed(self) -> None:
        assert ask(right_of_way_3d, [body(300.0, 500.0, 0.0, 20.0, -math.pi / 2)])[0] == pytest.approx([20.0, 0.0, 0.0])
