"""Faults and environment: each changes nothing at zero magnitude, and each has its documented effect.

Whatever is registered is covered by presence: a component's defaults are its zero magnitude. Start at `TestNeutral`;
noise and gusts have their own tests in test_noise.py, realisations in test_realisations.py.
"""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import numpy as np
import pytest

from campaigns import Campaign, library, load_file
from clearance.testing.problems import Problem
from tests.physics.conditions import CASE, FAULTS, PARTS, loop_with, parameters, short
from tests.physics.scenes import changed, cost, flight, uncompiled
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Environment, declared
from worker.engine.kernels.views import Body3
from worker.running.catalogue.installed import components


def loops() -> dict[str, Campaign]:
    """One campaign of every vehicle and avoider of the library, without its own faults."""
    found: dict[str, Campaign] = {}
    for path in library().values():
        campaign = load_file(path)
        scenario = campaign.scenario
        found.setdefault(f"{scenario.vehicle.component}-{scenario.avoider.component}", campaign)
    return found


LOOPS = loops()


def some_by_day() -> list[Any]:
    """Every part in an eighth of the loops, the next part in another eighth; the other pairs at night."""
    return [
        pytest.param(name, loop, marks=() if (i + j) % 8 == 0 else pytest.mark.nightly)
        for (i, name), (j, loop) in product(enumerate(PARTS), enumerate(LOOPS))
    ]


class TestNeutral:
    """With its defaults a component leaves the loop alone, to the last bit or nearly so."""

    @pytest.mark.parametrize("name", PARTS)
    def test_every_parameter_has_a_default(self, name: str) -> None:
        assert [p.name for p in declared(PARTS[name].parameters) if p.default is None] == []

    @pytest.mark.by_day(12)
    @pytest.mark.parametrize(("name", "loop"), some_by_day())
    def test_defaults_change_nothing(self, name: str, loop: str) -> None:
        campaign = LOOPS[loop]
        n = len(components()["vehicle", campaign.scenario.vehicle.component].states)
        bare = short(campaign, 20)
        if name == "guidance_delay":  # only sampled guidance can be late
            bare = uncompiled(
                changed(bare.campaign, guidance=short(campaign, 20, name).campaign.scenario.guidance.model_dump())
            )
        assert flight(short(campaign, 20, name))[:, :n] == pytest.approx(flight(bare)[:, :n], rel=1e-12, abs=1e-12)

    @pytest.mark.nightly
    def test_all_together_change_nothing_when_compiled(self) -> None:
        sampled = {"horizon": 6.0, "guidance": {"period": 0.05}}
        bare = Problem(changed(CASE, **sampled))
        full = Problem(changed(short(CASE, 10, *PARTS).campaign, **sampled))
        assert cost(full) == pytest.approx(cost(bare), abs=1e-12)


def see(name: str, body: Body3, own: tuple[float, ...] = (0.0,) * 6, v: Any = (0.0, 0.0, 0.0), **given: float) -> Any:
    fault = FAULTS[name]
    return plain(fault.kernel)(given.pop("t", 0.0), 0.0, own, v, body, parameters(fault, **given))


def thing(x: float, y: float, z: float = 0.0, vx: float = 0.0, vy: float = 0.0, vz: float = 0.0) -> Body3:
    gap = math.sqrt(x * x + y * y + z * z) - 1.0
    return Body3(x, y, z, vx, vy, vz, 1.0, gap, -1.0, 0.0, 0.0)


class TestPerception:
    def test_a_displaced_obstacle_is_displaced_with_its_surface(self) -> None:
        problem = loop_with("position_error", dx=0.7, dy=-0.2)
        p = problem.system.loop.extend(problem.system.nominal)
        x = problem.system.loop.part("initial")(p)
        *_, q, _, seen = problem.system.loop.part("measurements")(0.0, x, p)
        assert (seen[0].x, seen[0].y) == pytest.approx((4.7, 3.8))
        assert seen[0].gap == pytest.approx(math.hypot(4.7 - q[0], 3.8 - q[1]) - 0.5, abs=1e-12)

    def test_the_criterion_reads_the_truth(self) -> None:
        problem = loop_with("blackout", at=0.0, duration=1e3)
        straight = math.hypot(4.0, 4.0) * abs(math.sin(math.atan2(7.0, 6.0) - math.pi / 4))
        assert cost(problem) == pytest.approx(straight, abs=0.25)  # the obstacle is passed as if it were not there

    def test_a_track_error_turns_and_lengthens_the_velocity(self) -> None:
        error = see("track_error", thing(1.0, 2.0, vx=3.0, vy=4.0), du0=2.0, dpsi0=0.3)
        seen = (3.0 + error.vx, 4.0 + error.vy)
        assert math.hypot(*seen) == pytest.approx(7.0)
        assert math.atan2(seen[1], seen[0]) == pytest.approx(math.atan2(4.0, 3.0) + 0.3)

    def test_bearing_elevation_and_range_are_off_by_what_they_say(self) -> None:
        own = (10.0, -5.0, 2.0, 0.0, 0.0, 0.0)
        body = thing(13.0, -1.0, 14.0)
        error = see("bearing_range_error", body, own, db=0.2, de=-0.1, dr=1.5, k=0.1)
        x, y, z = 3.0 + error.x, 4.0 + error.y, 12.0 + error.z
        assert math.atan2(y, x) == pytest.approx(math.atan2(4.0, 3.0) + 0.2)
        assert math.atan2(z, math.hypot(x, y)) == pytest.approx(math.atan2(12.0, 5.0) - 0.1)
        assert math.sqrt(x * x + y * y + z * z) == pytest.approx(13.0 * 1.1 + 1.5)

    def test_beyond_its_range_a_sensor_detects_nothing(self) -> None:
        assert see("limited_range", thing(5.0, 0.0), range=4.0).visible == 1.0
        assert see("limited_range", thing(5.1, 0.0), range=4.0).visible == 0.0

    @pytest.mark.parametrize("pitch", [0.0, 0.3])
    @pytest.mark.parametrize("place", [(5.0, 0.9, 0.0), (4.9, 1.0, 2.0), (-1.0, 8.0, -3.0), (1.0, 1.0, -0.4)])
    def test_the_view_is_a_cone_about_the_axis(self, place: Any, pitch: float) -> None:
        own = (0.0, 0.0, 0.0, 0.0, pitch, math.pi / 4)
        axis = np.array([math.cos(pitch) / math.sqrt(2), math.cos(pitch) / math.sqrt(2), -math.sin(pitch)])
        apart = math.acos(np.dot(axis, place) / np.linalg.norm(place))
        assert see("field_of_view", thing(*place), own, alpha=apart + 1e-6).visible == 1.0
        assert see("field_of_view", thing(*place), own, alpha=apart - 1e-6).visible == 0.0

    def test_a_blackout_hides_from_its_beginning_to_its_end(self) -> None:
        times = (1.9999, 2.0, 3.4999, 3.5)
        assert [see("blackout", thing(1.0, 0.0), t=t, at=2.0, duration=1.5).visible for t in times] == [1, 0, 0, 1]

    def test_an_old_relative_position_moves_with_the_vehicle(self) -> None:
        error = see("ranging_latency", thing(9.0, 0.0, vx=-2.0, vy=1.0), v=(3.0, 0.0, 0.5), tau=0.2)
        assert (error.x, error.y, error.z) == pytest.approx((1.0, -0.2, 0.1))


MOVING = {"component": "moving_circle", "parameters": {"position": {"x": 9.0, "y": 2.0}, "goal": {"x": -9.0, "y": 8.0}}}
YIELDING = {"component": "cooperative_circle", "parameters": MOVING["parameters"]}


class TestTiming:
    def seen(self, t: float, name: str, obstacle: dict[str, Any] = MOVING, **given: float) -> Any:
        problem = loop_with(name, "", {"obstacles": [obstacle]}, **given)
        p = problem.system.loop.extend(problem.system.nominal)
        return problem.system.loop.part("measurements")(t, problem.system.loop.part("initial")(p), p)[3][0]

    def true(self, t: float) -> Any:
        return self.seen(t, "latency")

    def test_a_late_track_is_where_the_obstacle_was(self) -> None:
        assert self.seen(5.0, "latency", tau=1.2) == pytest.approx(self.true(3.8))

    def test_a_compensated_obstacle_is_exact_on_a_straight_path(self) -> None:
        assert self.seen(5.0, "latency", tau=1.2, compensation=1.0) == pytest.approx(self.true(5.0), abs=1e-12)

    def test_in_a_dropout_the_last_track_is_held(self) -> None:
        for t, then in ((1.9, 1.9), (2.0, 2.0), (3.3, 2.0), (3.5, 3.5)):
            assert self.seen(t, "dropout", at=2.0, duration=1.5) == pytest.approx(self.true(then))

    def test_in_a_dropout_the_last_track_may_be_extrapolated(self) -> None:
        assert self.seen(3.3, "dropout", at=2.0, duration=1.5, coasting=1.0) == pytest.approx(self.true(3.3), abs=1e-12)

    def test_an_obstacle_with_states_is_taken_back_along_its_velocity(self) -> None:
        true, late = self.seen(5.0, "latency", YIELDING), self.seen(5.0, "latency", YIELDING, tau=1.2)
        assert (late.x, late.y) == pytest.approx((true.x - 1.2 * true.vx, true.y - 1.2 * true.vy))
        assert (late.vx, late.vy) == (true.vx, true.vy)

    def test_a_standing_obstacle_is_not_affected(self) -> None:
        still = loop_with("latency", "", {"horizon": 2.0}, tau=0.8)
        assert flight(still).tobytes() == flight(uncompiled(changed(CASE, horizon=2.0))).tobytes()


class TestNavigation:
    def believed(self, t: float, name: str, **given: float) -> Any:
        problem = loop_with(name, **given)
        p = problem.system.loop.extend(problem.system.nominal)
        return np.array(
            problem.system.loop.part("measurements")(t, (1.0, 2.0, 0.3, 0.4, 0.5, 0.0, 0.0, 0.0, 0.0), p)[0]
        )

    def test_a_bias_is_added_to_what_is_true(self) -> None:
        found = self.believed(0.0, "navigation_bias", dx=0.1, dy=-0.2, dpsi=0.05, du=0.3)
        assert found == pytest.approx([1.1, 1.8, 0.35, 0.7, 0.5])

    def test_a_drift_grows_from_its_beginning(self) -> None:
        given = {"vx": 0.1, "vy": -0.2, "rate": 0.01, "at": 2.0}
        assert self.believed(1.0, "navigation_drift", **given) == pytest.approx([1.0, 2.0, 0.3, 0.4, 0.5])
        assert self.believed(5.0, "navigation_drift", **given) == pytest.approx([1.3, 1.4, 0.33, 0.4, 0.5])


class TestEnvironment:
    def speed(self, name: str, **given: float) -> Any:
        start = {"x": 0.0, "y": 0.0, "theta": math.pi / 6, "v": 2.0, "omega": 0.0}
        coasting = dict.fromkeys(("K_p1", "K_i1", "K_d1", "K_p2", "K_i2", "K_d2"), 0.0)
        scenario = {"controller": {"component": "pid_speed", "parameters": coasting}, "start": start, "horizon": 4.0}
        return flight(loop_with(name, "", scenario, **given))[:, 3]

    def test_uphill_it_slows_down_by_the_component_of_gravity(self) -> None:
        times = 0.005 * np.arange(801)
        climb = 0.1 * math.cos(math.pi / 6) + 0.05 * math.sin(math.pi / 6)
        assert self.speed("ground_slope", x=0.1, y=0.05) == pytest.approx(2.0 - 9.81 * climb * times, abs=1e-9)

    def test_rolling_resistance_brings_it_to_rest_and_not_back(self) -> None:
        times = 0.005 * np.arange(801)
        found = self.speed("ground_friction", c=0.1)
        rolling = times < 2.0 / 0.981 - 0.02
        assert found[rolling] == pytest.approx(2.0 - 0.981 * times[rolling], abs=1e-9)
        assert 0.0 <= found[-1] < 1e-6

    def blow(self, name: str, t: float, q: Any = (0.0, 0.0, 0.0), **given: float) -> Any:
        part = PARTS[name]
        assert isinstance(part, Environment)
        return plain(part.blow)(t, q, (1.0, 0.0, 0.0), (), parameters(part, **given))[0]

    def test_steady_wind_changes_along_the_vertical_axis(self) -> None:
        wind = self.blow("steady_wind", 3.0, (5.0, 6.0, -40.0), x=3.0, y=-1.0, z=0.5, shear_x=-0.1, reference=-10.0)
        assert wind[:3] == pytest.approx((6.0, -1.0, 0.5))

    def test_a_gust_rises_holds_and_falls(self) -> None:
        given = {"y": 4.0, "at": 2.0, "rise": 1.0, "hold": 3.0}
        times = (1.9, 2.5, 3.0, 5.9, 6.5, 7.1)
        found = [self.blow("discrete_gust", t, **given).wind_y for t in times]
        assert found == pytest.approx([0.0, 2.0, 4.0, 4.0, 2.0, 0.0], abs=1e-10)


class TestInSpace:
    """The same chains in three dimensions, on the aircraft of case 5."""

    CASE = load_file(library()["uav_aca"])

    def with_fault(self, name: str, obstacle: dict[str, Any] | None = None, **given: float) -> Problem:
        obstacles = {} if obstacle is None else {"obstacles": [obstacle]}
        return uncompiled(
            changed(self.CASE, faults=[{"component": name, "parameters": given}], horizon=4.0, **obstacles)
        )

    def seen(self, t: float, problem: Problem) -> Any:
        p = problem.system.loop.extend(problem.system.nominal)
        return problem.system.loop.part("measurements")(t, problem.system.loop.part("initial")(p), p)[3][0]

    def test_errors_have_a_third_component(self) -> None:
        true = self.seen(3.0, self.with_fault("position_error"))
        shifted = self.seen(3.0, self.with_fault("position_error", dx=1.0, dy=2.0, dz=-3.0))
        assert (shifted.x, shifted.y, shifted.z) == pytest.approx((true.x + 1.0, true.y + 2.0, true.z - 3.0))
        faster = self.seen(3.0, self.with_fault("velocity_error", dvx=1.0, dvy=2.0, dvz=-3.0))
        assert (faster.vx, faster.vy, faster.vz) == pytest.approx((true.vx + 1.0, true.vy + 2.0, true.vz - 3.0))

    def test_an_unseen_obstacle_is_far_away(self) -> None:
        hidden = self.seen(3.0, self.with_fault("blackout", at=0.0, duration=9.0))
        assert hidden.gap > 1e6
        assert (hidden.vx, hidden.vy, hidden.vz) == (0.0, 0.0, 0.0)

    def test_late_tracks_and_tracks_with_states(self) -> None:
        assert self.seen(3.0, self.with_fault("latency", tau=0.8)) == pytest.approx(
            self.seen(2.2, self.with_fault("latency")), rel=1e-12
        )
        place = {"position": {"x": 0.0, "y": 800.0, "z": -5.0}, "goal": {"x": 500.0, "y": 0.0, "z": 20.0}}
        yielding = {"component": "cooperative_sphere", "parameters": place}
        true, late = (self.seen(3.0, self.with_fault("latency", yielding, tau=tau)) for tau in (0.0, 0.8))
        moved = [true.x - 0.8 * true.vx, true.y - 0.8 * true.vy, true.z - 0.8 * true.vz]
        assert [late.x, late.y, late.z] == pytest.approx(moved)

    def test_a_late_demand_is_that_of_earlier_samples(self) -> None:
        problem = self.with_fault("guidance_delay", periods=2.0)
        g = flight(problem)[::2, problem.system.loop.n_state :]
        first = 3 + problem.system.parts.avoider.memory
        for lag in range(1, 5):
            kept = g[lag:, first + 3 * (lag - 1) : first + 3 * lag]
            assert kept.tolist() == g[: len(g) - lag, 0:3].tolist()
        waited = problem.system.loop.part("demand")
        p = problem.system.loop.extend(problem.system.nominal)
        assert waited(0.0, (), (), (), tuple(g[10].tolist()), p) == pytest.approx(g[8, 0:3].tolist())
