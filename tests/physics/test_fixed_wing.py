"""The fixed-wing aircraft as physics: trim, conservation, symmetry, wind, order of the integrator.

Values: laws of mechanics; the trim of the reconstruction.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from campaigns import library, load_file
from campaigns.results.base import FAILED
from clearance.testing.problems import Problem
from tests.physics.airframe import CALM, aircraft, constants, flown, linear
from tests.physics.scenes import changed, cost, flight, uncompiled
from worker.engine.components.vehicles import fixed_wing, fixed_wing_linear
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import NoTrim
from worker.engine.kernels.views import Surroundings
from worker.engine.physics import aerodynamics, trim
from worker.engine.physics.aerodynamics import Airframe
from worker.engine.systems.base import CampaignUnusable, Floats

CRUISE = load_file(library()["uav_aca_no_avoidance"])

TRIMS = {20.0: (0.0303, -0.0330, 0.2731), 15.0: (0.0721, -0.0560, 0.1668)}


class TestTrim:
    @pytest.mark.parametrize("speed", [12.0, 15.0, 18.0, 20.0, 25.0])
    def test_nothing_accelerates(self, speed: float) -> None:
        at = trim.trimmed(Airframe(), speed)
        assert trim.motion(constants(), trim.level(speed, *at)) == pytest.approx([0.0] * 6, abs=1e-10)

    @pytest.mark.parametrize("speed", TRIMS)
    def test_is_the_reconstructed_one(self, speed: float) -> None:
        assert trim.trimmed(Airframe(), speed) == pytest.approx(TRIMS[speed], abs=6e-5)

    def test_a_trimmed_aircraft_stays_trimmed(self) -> None:
        p = aircraft()
        x = plain(fixed_wing.begin)(fixed_wing.Start(1.0, 2.0, 3.0, 0.5, 20.0), p)
        end = flown(p, x, (p.elevator, 0.0, 0.0, p.throttle), 5.0)
        assert end[3:] == pytest.approx(x[3:], abs=1e-8)
        assert end[:3] == pytest.approx([1.0 + 100 * math.cos(0.5), 2.0 + 100 * math.sin(0.5), 3.0], abs=1e-7)

    @pytest.mark.parametrize(
        ("speed", "changes", "statement"),
        [
            (6.0, {}, "angle of attack"),
            (45.0, {}, "throttle"),
            (20.0, {"C_mde": -0.01}, "elevator"),
            (-1.0, {}, "above 0"),
        ],
    )
    def test_says_why_there_is_none(self, speed: float, changes: dict[str, float], statement: str) -> None:
        with pytest.raises(NoTrim, match=statement):
            trim.trimmed(Airframe()._replace(**changes), speed)

    def test_a_campaign_without_trim_is_refused_with_the_sentence(self) -> None:
        with pytest.raises(CampaignUnusable, match=r" 45 m/s .* throttle"):
            Problem(changed(CRUISE, start={"speed": 45.0}))

    def test_the_flight_starts_in_it(self) -> None:
        # but for the autopilot, which holds the forward speed u at 20 m/s where trim has 20 m/s cos(alpha)
        problem = uncompiled(changed(CRUISE, horizon=10.0))
        assert flight(problem)[:200, 2] == pytest.approx(np.zeros(200), abs=0.02)


class TestMechanics:
    TUMBLING = (3.0, -2.0, -300.0, 0.4, 0.3, -0.8, 14.0, 2.0, -3.0, 0.7, -0.4, 0.9)
    EMPTY: dict[str, float] = {"rho": 0.0, "I_xz": 0.02, "omega_p": 0.0}  # noqa: RUF012
    OFF = (0.0, 0.0, 0.0, 0.0)

    def momentum(self, x: Floats, I_xz: float = 0.02) -> tuple[Floats, Floats, float]:
        """Angular momentum in the world frame, velocity there, energy."""
        a = Airframe()
        tensor = np.array([[a.I_xx, 0, -I_xz], [0, a.I_yy, 0], [-I_xz, 0, a.I_zz]])
        turn = Rotation.from_euler("ZYX", [x[5], x[4], x[3]])
        energy = 0.5 * a.m * x[6:9] @ x[6:9] + 0.5 * x[9:12] @ tensor @ x[9:12] - a.m * a.g * x[2]
        return turn.apply(tensor @ x[9:12]), turn.apply(x[6:9]), float(energy)

    def test_without_air_momentum_and_energy_stay(self) -> None:
        x = np.array(self.TUMBLING)
        end = flown(aircraft(**self.EMPTY), x, self.OFF, 1.5)
        (before, v, energy), (after, w, left) = self.momentum(x), self.momentum(end)
        assert after == pytest.approx(before, abs=1e-9)
        assert w == pytest.approx(v + np.array([0.0, 0.0, 9.81 * 1.5]), abs=1e-8)
        assert left == pytest.approx(energy, abs=1e-7)
        assert end[:3] == pytest.approx(x[:3] + 1.5 * v + [0.0, 0.0, 0.5 * 9.81 * 1.5**2], abs=1e-8)

    def test_the_spinning_propeller_does_no_work(self) -> None:
        x = np.array(self.TUMBLING)
        end = flown(aircraft(**self.EMPTY | {"omega_p": 827.0}), x, self.OFF, 1.5)
        assert self.momentum(end)[2] == pytest.approx(self.momentum(x)[2], abs=1e-7)
        assert np.abs(self.momentum(end)[0] - self.momentum(x)[0]).max() > 1e-3

    def test_power_of_the_loads_is_the_rate_of_energy(self) -> None:
        p, u = aircraft(), (-0.1, 0.05, -0.2, 0.6)
        x = np.array(self.TUMBLING)
        dx = np.array(plain(fixed_wing.derivative)(0.0, tuple(x.tolist()), u, CALM, p))
        force, moment = plain(aerodynamics.loads)(tuple(x[6:9]), tuple(x[9:12]), u, p)
        a = Airframe()
        rate = a.m * x[6:9] @ dx[6:9] + x[9:12] @ (np.array([a.I_xx, a.I_yy, a.I_zz]) * dx[9:12]) - a.m * a.g * dx[2]
        assert rate == pytest.approx(a.m * np.dot(force, x[6:9]) + np.dot(moment, x[9:12]), rel=1e-12)

    def test_drag_takes_energy_away(self) -> None:
        p = aircraft()
        random = np.random.default_rng(3)
        for _ in range(50):
            air = random.normal(0.0, 1.0, 3) * [2.0, 4.0, 2.0] + [18.0, 0.0, 0.0]
            force, _ = plain(aerodynamics.loads)(tuple(air), (0.0, 0.0, 0.0), (*random.normal(0, 0.2, 3), 0.0), p)
            lift_and_drag = np.array(force) - np.array(force) @ air / (air @ air) * air
            assert np.dot(force, air) < 0.0
            assert abs(lift_and_drag @ air) < 1e-9

    def test_thrust_acts_forward_and_below(self) -> None:
        p = constants()
        with_, without = (plain(aerodynamics.loads)((20.0, 0.0, 1.0), (0.0,) * 3, (0, 0, 0, t), p) for t in (1.0, 0.0))
        assert np.subtract(with_[0], without[0]) == pytest.approx([12.19 / 1.9, 0.0, 0.0], abs=1e-12)
        assert np.subtract(with_[1], without[1]) == pytest.approx([0.0, 0.046 * 12.19, 0.0], abs=1e-12)

    def test_mirrored_motion_has_mirrored_derivatives(self) -> None:
        signs = np.array([1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1.0])
        p, f = aircraft(omega_p=0.0, I_xz=0.02), plain(fixed_wing.derivative)
        x, u = np.array(self.TUMBLING), np.array([-0.1, 0.05, -0.2, 0.6])
        there = np.array(f(0.0, tuple(x.tolist()), tuple(u.tolist()), CALM, p))
        back = f(0.0, tuple((signs * x).tolist()), tuple((u * [1, -1, -1, 1]).tolist()), CALM, p)
        assert back == pytest.approx(signs * there, abs=1e-12)

    @pytest.mark.parametrize(
        ("given", "held"), [((9.0, -9.0, 9.0, 9.0), (1, -1, 1)), ((-9.0, 9.0, -9.0, 9.0), (-1, 1, -1))]
    )
    def test_surfaces_stop_at_their_stops(self, given: Any, held: Any) -> None:
        p, f = aircraft(), plain(fixed_wing.derivative)
        stops = (*(p.stop * s for s in held), 1.0)
        assert f(0.0, self.TUMBLING, given, CALM, p) == f(0.0, self.TUMBLING, stops, CALM, p)


class TestWind:
    WIND = Surroundings(4.0, -3.0, 1.5, 0.0, 0.0, 0.0)

    @pytest.mark.parametrize("vehicle", [fixed_wing, fixed_wing_linear])
    def test_carries_a_flight_along(self, vehicle: Any) -> None:
        # the same motion through the air, seen from ground over which the air moves
        p = aircraft() if vehicle is fixed_wing else linear(20.0)
        x = np.array(plain(vehicle.component.begin)(vehicle.component.start(psi=0.7), p))
        x[9:12] += 0.2, -0.1, 0.15
        u = (p.elevator - 0.02, 0.01, -0.03, p.throttle + 0.1)
        still = flown(p, x, u, 3.0, vehicle=vehicle)
        y = x.copy()
        y[6:9] += over_ground(x, self.WIND)
        blown = flown(p, y, u, 3.0, self.WIND, vehicle)
        blown[6:9] -= over_ground(blown, self.WIND)
        assert blown[3:] == pytest.approx(still[3:], abs=1e-7)
        assert blown[:3] - still[:3] == pytest.approx(3.0 * np.array(self.WIND[:3]), abs=1e-7)

    def test_the_autopilot_holds_the_airspeed(self) -> None:
        wind = {"component": "steady_wind", "parameters": {"x": 3.0, "y": -2.0}}
        problem = uncompiled(changed(CRUISE, environment=[wind], horizon=90.0))
        end = flight(problem)[-20:]
        heading = end[:, 5]
        assert heading == pytest.approx(np.full(20, 0.9), abs=2e-3)
        ground = np.diff(end[:, :2], axis=0).mean(axis=0) / problem.system.step
        assert ground == pytest.approx([20 * math.cos(0.9) + 3.0, 20 * math.sin(0.9) - 2.0], abs=0.05)

    def test_a_wind_of_zero_changes_nothing(self) -> None:
        calm = uncompiled(changed(CRUISE, environment=[{"component": "steady_wind"}], horizon=10.0))
        assert cost(calm) == pytest.approx(cost(uncompiled(changed(CRUISE, horizon=10.0))), abs=1e-12)


def over_ground(x: Floats, wind: Surroundings) -> Floats:
    """The wind in the body axes of a state."""
    return np.asarray(Rotation.from_euler("ZYX", [x[5], x[4], x[3]]).inv().apply(wind[:3]))


class TestIntegrator:
    def test_order_is_four_where_nothing_switches(self) -> None:
        # A smaller turn and change of speed than any limit of the autopilot; drag of the deflections has a corner at
        # zero deflection and is left out.
        smooth = {"component": "fixed_wing", "parameters": {"C_Dde": 0.0, "C_Dda": 0.0, "C_Ddr": 0.0}}
        problem = uncompiled(changed(CRUISE, vehicle=smooth, goal={"speed": 19.5, "heading": 1.1}, horizon=4.0))
        ends = {}
        for step in (0.01, 0.005, 0.0025):
            counts = problem.system.counts(step)
            ends[step] = problem.system.loop.simulate(problem.system.nominal[None], step, *counts, traced=1).trace[
                0, -1, :12
            ]
        coarse, fine = np.abs(ends[0.01] - ends[0.005]), np.abs(ends[0.005] - ends[0.0025])
        assert np.log2(coarse / fine) == pytest.approx(np.full(12, 4.0), abs=0.3)

    @pytest.mark.parametrize(
        ("values", "statement"),
        [
            ({"vehicle.m": math.nan}, "the simulation diverged"),
            ({"vehicle.C_mde": 5.0}, "the pitch exceeds|angle of attack|turn rate"),
            ({"start.speed": 2.0}, "the forward speed through the air is below 3 m/s"),
            ({"vehicle.C_lda": -2.0}, "the bank exceeds 2 rad|turn rate|sideways speed"),
        ],
    )
    def test_leaving_the_envelope_is_a_failure_with_a_reason(self, values: dict[str, float], statement: str) -> None:
        problem = uncompiled(CRUISE)
        batch, reasons = problem.system.simulate_vectors(problem.vector(values)[None])
        assert batch.status[0] == FAILED
        assert math.isnan(batch.costs[0, 0])
        assert any(part in reasons[0] for part in statement.split("|")), reasons
