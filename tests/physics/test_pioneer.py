"""Case 2 as physics: published values, an independent program, order, DOP853, symmetry, closed forms, stops.

Values: Srikanthakumar (tables 3.1, 3.2, 4.2, 5.4, 5.5) as reconstructed.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.results.base import FAILED
from clearance.testing.problems import Problem
from tests.bench.reference_pioneer import Reference
from tests.given.reference_in_python import PlainReference
from tests.physics.scenes import changed, cost, flight, uncompiled
from worker.engine.components.vehicles import pioneer_3dx
from worker.engine.kernels.bind import plain
from worker.engine.reference.reference import Reference as Confirming

CASE = load_file(library()["pioneer_moving"])
PROBLEM = Problem(CASE)
ALONE = uncompiled(load_file(library()["pioneer_no_avoidance"]))

CORNER = {
    "vehicle.m": 34.0, "vehicle.B_e": 0.48, "vehicle.delta_u": 0.9, "vehicle.delta_w": 0.1, "vehicle.I_e": 3.8,
    "vehicle.u_s": 0.02, "faults.0.dx": 0.5, "faults.0.dy": -0.5,
}  # fmt: skip
PUBLISHED = [({}, 7.628), (CORNER, 5.895), (CORNER | {"vehicle.m": 18.271, "vehicle.I_e": 0.204}, 6.9166)]
CORNERS = np.array(list(itertools.product([0.0, 1.0], repeat=8)))
FALLING = {"vehicle.m": 0.0035, "vehicle.I_e": 0.030, "vehicle.delta_u": 0.333, "faults.0.dx": 0.465}
RISING = {"vehicle.B_e": 0.161, "vehicle.delta_w": 0.183, "vehicle.u_s": 0.188, "faults.0.dy": 0.400}


class TestPublished:
    @pytest.mark.parametrize(("values", "d_min"), PUBLISHED)
    def test_d_min_is_the_published_value(self, values: dict[str, float], d_min: float) -> None:
        assert cost(PROBLEM, values) == pytest.approx(d_min, abs=0.005)

    def test_the_published_corner_is_the_lowest_of_all(self) -> None:
        costs = PROBLEM.evaluate(CORNERS)[0].costs[:, 0]
        assert PROBLEM.named(CORNERS[costs.argmin()]) == CORNER
        assert np.sort(costs)[:3] == pytest.approx([5.8949, 5.9112, 5.9324], abs=0.003)

    @pytest.mark.parametrize(("path", "change"), [*((p, -c) for p, c in FALLING.items()), *RISING.items()])
    def test_d_min_rises_or_falls_over_each_range(self, path: str, change: float) -> None:
        r = next(r for r in PROBLEM.ranges if r.path == path)
        values = np.array([cost(PROBLEM, {path: float(v)}) for v in np.linspace(r.low, r.high, 21)])
        assert values[-1] - values[0] == pytest.approx(change, rel=0.02)
        assert (np.diff(values) * np.sign(change) > 0).all()

    def test_never_within_the_safety_radius(self) -> None:
        batch, _ = PROBLEM.evaluate(np.random.default_rng(2).random((2000, 8)))
        assert batch.costs.min() > 5.8949

    @pytest.mark.parametrize(("values", "d_min"), [({}, 4.781), (CORNER, 1.974)])
    def test_without_avoidance_d_min_is_the_known_value(self, values: dict[str, float], d_min: float) -> None:
        assert cost(ALONE, {k: v for k, v in values.items() if k in ALONE.paths}) == pytest.approx(d_min, abs=0.001)

    def test_reaches_the_goal(self) -> None:
        end = flight(PROBLEM)[-1]
        assert math.hypot(end[0] - 35.0, end[1] - 10.0) == pytest.approx(0.118, abs=0.002)


class TestFormulations:
    def test_an_independent_program_agrees(self) -> None:
        points = np.vstack([CORNERS, np.random.default_rng(3).random((300, 8))])
        difference = PROBLEM.evaluate(points)[0].costs[:, 0] - Reference(PROBLEM, PROBLEM.vectors(points)).costs()
        # The same mathematics; rounding moves a switch by a step now and then.
        assert np.median(np.abs(difference)) < 1e-10
        assert np.abs(difference).max() < 1e-5

    def test_lockstep_equals_plain_python_before_the_first_switch(self) -> None:
        slow = uncompiled(changed(CASE, horizon=14.0))
        fast = flight(PROBLEM)[: len(flight(slow))]
        assert flight(slow) == pytest.approx(fast, abs=1e-12)

    def test_lockstep_and_plain_python_over_the_whole_flight(self) -> None:
        # Both meet the same switches here, so that only rounding differs.
        assert cost(uncompiled(CASE)) == pytest.approx(cost(PROBLEM), abs=1e-9)

    def test_the_constants_follow_from_the_motors(self) -> None:
        p = pioneer_3dx.Constants(*plain(pioneer_3dx.derive)(pioneer_3dx.Pioneer(), ()))
        theta_1, theta_2 = 1 / p.per_u, 1 / p.per_w
        found = [theta_1, theta_2, p.c_uww * theta_1, p.c_u * theta_1, p.c_wuw * theta_2, p.c_w * theta_2]
        q, wheel = 0.71 / 0.8808, 0.0977
        friction = 0.8808 * 0.8808 / 0.71 + 0.8
        assert found == pytest.approx(
            [
                (q * (18 * 0.14 * wheel + 4) + 2 * wheel * 0.1) / (2 * wheel * 11),
                (q * (2 * 0.395**2 + 2 * 0.14 * wheel * (20 + 0.18)) + 2 * wheel * 0.0395) / (2 * wheel * 0.395 * 11),
                q * 18 * 0.1 * 0.14 / 22,
                q * friction / (wheel * 11) + 1,
                q * 18 * 0.1 * 0.14 / (0.395 * 11),
                q * friction * 0.395 / (2 * wheel * 11) + 1,
            ],
            rel=1e-12,
        )


class TestIntegrator:
    def test_order_is_four_where_nothing_switches(self) -> None:
        # Ten times the inertia of the wheels slows the poles, so that these steps lie in the asymptotic range.
        problem = changed(
            CASE,
            vehicle={"component": "pioneer_3dx", "parameters": {"I_e": 20.0, "delta_u": 0.0, "delta_w": 0.0}},
            start={"x": 0.0, "y": 0.0, "psi": 0.6, "u": 0.5, "omega": 0.2},
            goal={"x": 9.0, "y": 3.0},
            horizon=1.6,
            step=0.02,
        )
        made = Problem(problem)
        ends = {step: flight(made, step=step)[-1, :7] for step in (0.08, 0.04, 0.02)}
        coarse, fine = np.abs(ends[0.08] - ends[0.04]), np.abs(ends[0.04] - ends[0.02])
        assert np.log2(coarse / fine) == pytest.approx(np.full(7, 4.0), abs=0.3)

    @pytest.mark.parametrize("values", [pytest.param({}, marks=pytest.mark.nightly), CORNER])
    def test_agrees_with_dop853_where_nothing_switches(self, values: dict[str, float]) -> None:
        given = {k: v for k, v in values.items() if k in ALONE.paths}
        other = PlainReference(ALONE.system).simulate(ALONE.vector(given))
        assert not other.reason
        assert other.cost == pytest.approx(cost(ALONE, given), abs=1e-6)

    @pytest.mark.parametrize(("values", "apart"), [({}, 5e-4), (CORNER, 3e-3)])
    def test_agrees_with_dop853_as_far_as_the_switches_allow(self, values: dict[str, float], apart: float) -> None:
        # The trajectory slides along v_RO = 0, where the force is discontinuous: the order of convergence is lost.
        other = Confirming(PROBLEM.system).simulate(PROBLEM.vector(values))
        assert "switches back and forth" in other.reason
        assert other.cost == pytest.approx(cost(PROBLEM, values), abs=apart)

    @pytest.mark.parametrize(("values", "apart"), [({}, 3e-4), (CORNER, 1e-3)])
    def test_half_the_step_changes_d_min_little(self, values: dict[str, float], apart: float) -> None:
        assert cost(PROBLEM, values, PROBLEM.system.step / 2) == pytest.approx(cost(PROBLEM, values), abs=apart)


class TestSymmetry:
    """Rotating, mirroring or moving the whole scene changes no distance."""

    def scene(self, turn: float = 0.0, mirror: float = 1.0, shift: float = 0.0, **vehicle: float) -> Problem:
        c, s = math.cos(turn), math.sin(turn)

        def place(x: float, y: float, by: float = shift) -> dict[str, float]:
            y *= mirror
            return {"x": c * x - s * y + by, "y": s * x + c * y - by}

        intruder = {"position": place(35.0, 30.0), "goal": place(15.0, -25.0), "speed": 1.45, "radius": 5.0}
        seen = place(0.3, -0.2, 0.0)
        given = {"delta_u": 0.2, "delta_w": 0.5, "u_s": 0.05} | vehicle
        given |= {"delta_w": mirror * given["delta_w"], "u_s": mirror * given["u_s"]}
        return Problem(
            changed(
                CASE,
                vehicle={"component": "pioneer_3dx", "parameters": given},
                start={**place(0.0, 0.0), "psi": turn + mirror * math.atan2(10.0, 35.0)},
                goal=place(35.0, 10.0),
                obstacles=[{"component": "moving_circle", "parameters": intruder}],
                faults=[{"component": "position_error", "parameters": {"dx": seen["x"], "dy": seen["y"]}}],
            )
        )

    @pytest.mark.parametrize(
        "scene", [{"turn": 2.1}, {"mirror": -1.0}, {"shift": 11.0}, {"turn": -0.7, "mirror": -1.0}]
    )
    def test_the_closest_approach_stays(self, scene: dict[str, float]) -> None:
        assert cost(self.scene(**scene)) == pytest.approx(cost(self.scene()), abs=1e-6)


def coasting(**given: Any) -> Problem:
    """A problem without control, slip and unmodelled acceleration, the intruder far away."""
    vehicle = {"u_s": 0.0, "delta_u": 0.0, "delta_w": 0.0} | given.pop("vehicle", {})
    free = dict.fromkeys(("K_1", "K_2", "K_3", "K_4"), 0.0)
    return uncompiled(
        changed(
            CASE,
            vehicle={"component": "pioneer_3dx", "parameters": vehicle},
            controller={"component": "pi_anti_windup", "parameters": free},
            obstacles=[{"component": "circle", "parameters": {"position": {"x": 500.0, "y": 0.0}}}],
            faults=[],
            **{"horizon": 4.0} | given,
        )
    )


class TestClosedForms:
    CONSTANTS = pioneer_3dx.Constants(*plain(pioneer_3dx.derive)(pioneer_3dx.Pioneer(), ()))

    def test_it_coasts_to_rest(self) -> None:
        rate = self.CONSTANTS.c_u
        states = flight(coasting(start={"u": 1.5}))
        t = 0.02 * np.arange(len(states))
        assert states[:, 3] == pytest.approx(1.5 * np.exp(-rate * t), abs=1e-7)
        assert states[:, 0] == pytest.approx(1.5 / rate * (1 - np.exp(-rate * t)), abs=1e-7)

    def test_the_coupling_of_speed_and_turn_does_no_work(self) -> None:
        # theta_1 u u' + c theta_2 w w' with c = theta_3/theta_5: the terms in u w^2 cancel, what is left is friction.
        p = self.CONSTANTS
        theta_1, theta_2 = 1 / p.per_u, 1 / p.per_w
        c = (p.c_uww * theta_1) / (p.c_wuw * theta_2)
        states = flight(coasting(start={"u": 1.0, "omega": 3.0}, step=0.005))
        u, w = states[:, 3], states[:, 4]
        energy = 0.5 * theta_1 * u**2 + 0.5 * c * theta_2 * w**2
        lost = p.c_u * theta_1 * u**2 + c * p.c_w * theta_2 * w**2
        work = np.concatenate([[0.0], np.cumsum(0.5 * (lost[1:] + lost[:-1])) * 0.005])
        assert energy + work == pytest.approx(np.full(len(u), energy[0]), rel=1e-4)

    def test_it_rolls_down_a_slope(self) -> None:
        p = self.CONSTANTS
        states = flight(coasting(start={}, environment=[{"component": "ground_slope", "parameters": {"x": -0.1}}]))
        t = 0.02 * np.arange(len(states))
        assert states[:, 3] == pytest.approx(0.1 * p.fall / p.c_u * (1 - np.exp(-p.c_u * t)), abs=1e-7)
        # the whole weight, were it not for the wheels, rotors and motors that turn with it
        light = pioneer_3dx.Pioneer(I_e=0.0, k_DT=0.0)
        assert pioneer_3dx.Constants(*plain(pioneer_3dx.derive)(light, ())).fall == pytest.approx(9.81)

    def test_slip_moves_it_sideways(self) -> None:
        states = flight(coasting(vehicle={"u_s": 0.05}, start={"psi": 0.5}))
        assert states[-1, :2] == pytest.approx([-0.2 * math.sin(0.5), 0.2 * math.cos(0.5)], abs=1e-12)


class TestStops:
    """An acceleration that drives the speed against its stop, the goal ahead."""

    def against(self, k_aw: float) -> Any:
        problem = changed(
            CASE,
            vehicle={"component": "pioneer_3dx", "parameters": {"delta_u": 5.0, "delta_w": 0.0, "u_s": 0.0}},
            controller={"component": "pi_anti_windup", "parameters": {"k_aw": k_aw}},
            start={"psi": 0.0},
            goal={"x": 300.0, "y": 0.0},
            obstacles=[{"component": "circle", "parameters": {"position": {"x": 500.0, "y": 0.0}}}],
            faults=[],
        )
        return uncompiled(problem)

    def test_the_speed_keeps_within_its_stop(self) -> None:
        states = flight(self.against(1.0))
        assert states[:, 3].max() == 1.6
        assert states[-1, 3] == 1.6

    def test_the_integral_bleeds_until_nothing_is_taken_away(self) -> None:
        p = pioneer_3dx.Constants(*plain(pioneer_3dx.derive)(pioneer_3dx.Pioneer(delta_u=5.0), ()))
        end = flight(self.against(1.0))[-1]
        u_ref = 0.41 * end[5]  # at the stop u_d = u, so that the proportional part is 0
        assert -p.c_u * 1.6 + p.per_u * u_ref + 5.0 == pytest.approx(0.0, abs=1e-3)

    def test_without_anti_windup_it_keeps_what_it_has(self) -> None:
        states = flight(self.against(0.0))
        at_stop = states[states[:, 3] >= 1.6]
        assert at_stop[-1, 5] == pytest.approx(at_stop[0, 5], abs=1e-9)

    def test_it_has_no_effect_on_case_2(self) -> None:
        points = np.random.default_rng(4).random((100, 8))
        vectors = PROBLEM.vectors(points)
        without = vectors.copy()
        without[:, PROBLEM.paths["controller.k_aw"]] = 0.0
        assert PROBLEM.system.simulate_vectors(without)[0].costs == pytest.approx(
            PROBLEM.system.simulate_vectors(vectors)[0].costs, abs=1e-12
        )


class TestFailures:
    @pytest.mark.parametrize(
        "values",
        [
            {"vehicle.m": math.nan},
            {"vehicle.k_PT": 0.0},
            {"vehicle.delta_u": math.inf},
            {"controller.K_1": math.nan},
            {"avoider.eta": math.nan},
            {"avoider.rho_0": math.nan},
            {"obstacles.0.speed": math.nan},
            {"faults.0.dx": math.nan},
            {"start.psi": math.nan},
        ],
    )
    def test_ends_as_failed_with_a_reason(self, values: dict[str, float]) -> None:
        batch, reasons = PROBLEM.system.simulate_vectors(PROBLEM.vector(values)[None])
        assert batch.status[0] == FAILED
        assert math.isnan(batch.costs[0, 0])
        assert "at t = " in reasons[0]
