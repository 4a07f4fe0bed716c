"""Faults and environment: each changes nothing at zero magnitude, and each has the effect that its file states.

Whatever is registered is covered by presence: a component's defaults are its zero magnitude. Start at `TestNeutral`;
noise and gusts have their own tests in test_noise.py, realisations in test_realisations.py.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from campaigns import Campaign, library, load_file
from tests.physics.scenes import changed, cost, flight, uncompiled
from worker.catalog import components
from worker.kernels.bind import plain
from worker.kernels.component import Environment, Fault, declared
from worker.kernels.glue import Body3
from worker.problem import Problem

CASE = load_file(library()["unicycle_static"])
FAULTS = {name: part for (role, name), part in components().items() if isinstance(part, Fault)}
PARTS = FAULTS | {name: part for (_, name), part in components().items() if isinstance(part, Environment)}


def loops() -> dict[str, Campaign]:
    """One campaign of every vehicle and avoider of the library, without the faults it has of its own."""
    found: dict[str, Campaign] = {}
    for path in library().values():
        campaign = load_file(path)
        scenario = campaign.scenario
        found.setdefault(f"{scenario.vehicle.component}-{scenario.avoider.component}", campaign)
    return found


LOOPS = loops()


def short(campaign: Campaign, steps: int, *names: str, **given: float) -> Problem:
    """The campaign's loop for a few steps from its start, with these faults and environment in it."""
    scenario, inputs = campaign.scenario, components()["vehicle", campaign.scenario.vehicle.component].inputs
    faults: list[dict[str, Any]] = []
    around: list[dict[str, Any]] = []
    for name in names:
        part = PARTS[name]
        document = {"component": name, "parameters": given}
        if isinstance(part, Environment):
            around.append(document)
        elif part.path == "actuator":
            faults += [document | {"on": signal.name} for signal in inputs]
        else:
            faults.append(document)
    period = scenario.guidance.period or 5 * scenario.step * ("guidance_delay" in names)
    return uncompiled(
        changed(
            campaign,
            faults=faults,
            environment=around,
            horizon=steps * scenario.step,
            guidance={"period": period},
        )
    )


def loop_with(name: str, on: str = "", scenario: dict[str, Any] | None = None, **parameters: float) -> Problem:
    """Case 1 with one fault or part of the environment, in plain Python."""
    part = {"component": name, "parameters": parameters} | ({"on": on} if on else {})
    where = "environment" if isinstance(PARTS[name], Environment) else "faults"
    return uncompiled(changed(CASE, **{where: [part]}, **(scenario or {})))


class TestNeutral:
    """With its defaults a component leaves the loop alone, to the last bit or nearly so."""

    @pytest.mark.parametrize("name", PARTS)
    def test_every_parameter_has_a_default(self, name: str) -> None:
        assert [p.name for p in declared(PARTS[name].parameters) if p.default is None] == []

    @pytest.mark.parametrize("loop", LOOPS)
    @pytest.mark.parametrize("name", PARTS)
    def test_defaults_change_nothing(self, name: str, loop: str) -> None:
        campaign = LOOPS[loop]
        n = len(components()["vehicle", campaign.scenario.vehicle.component].states)
        bare = short(campaign, 40)
        if name == "guidance_delay":  # only sampled guidance can be late
            bare = uncompiled(
                changed(bare.campaign, guidance=short(campaign, 40, name).campaign.scenario.guidance.model_dump())
            )
        assert flight(short(campaign, 40, name))[:, :n] == pytest.approx(flight(bare)[:, :n], rel=1e-12, abs=1e-12)

    def test_all_together_change_nothing_when_compiled(self) -> None:
        sampled = {"horizon": 6.0, "guidance": {"period": 0.05}}
        bare = Problem(changed(CASE, **sampled))
        full = Problem(changed(short(CASE, 10, *PARTS).campaign, **sampled))
        assert cost(full) == pytest.approx(cost(bare), abs=1e-12)


class Linear:
    """The state-space form of an actuator fault that is linear, from its kernel."""

    def __init__(self, name: str, **given: float) -> None:
        fault = FAULTS[name]
        self.p = parameters(fault, **given)
        self.act, self.rest = plain(fault.kernel), plain(fault.rest)
        n = fault.states
        zero = (0.0,) * n
        self.d = self.act(0.0, 1.0, zero, self.p)[0]
        self.b = np.array(self.act(0.0, 1.0, zero, self.p)[1])
        units = [tuple(float(i == k) for i in range(n)) for k in range(n)]
        self.c = np.array([self.act(0.0, 0.0, unit, self.p)[0] for unit in units])
        self.a = np.array([self.act(0.0, 0.0, unit, self.p)[1] for unit in units]).T

    def response(self, frequency: float) -> complex:
        inner = np.linalg.solve(1j * frequency * np.eye(len(self.b)) - self.a, self.b)
        return complex(self.d + self.c @ inner)

    def step(self, times: Any) -> Any:
        """The output after a unit step at t = 0 from rest at 0."""
        solved = solve_ivp(
            lambda t, a: self.act(t, 1.0, tuple(a), self.p)[1],
            (0.0, times[-1]), self.rest(0.0, self.p), t_eval=times, rtol=1e-11, atol=1e-13,
        )  # fmt: skip
        return np.array([self.act(t, 1.0, tuple(a), self.p)[0] for t, a in zip(times, solved.y.T, strict=True)])


def parameters(part: Fault | Environment, **given: float) -> Any:
    """A component's parameters, or the constants it derives from them, the rest at their defaults."""
    fields = part.parameters(**given)
    return fields if part.derived is None else part.derived.constants(*plain(part.derived.derive)(fields, ()))


def follow(name: str, command: Any, end: float, **given: float) -> tuple[Any, Any]:
    """Times, and what an actuator fault makes of a command as a function of time, from rest at its first value."""
    fault, p = FAULTS[name], parameters(FAULTS[name], **given)
    act, rest = plain(fault.kernel), plain(fault.rest)
    times = np.linspace(0.0, end, 2001)
    solved = solve_ivp(
        lambda t, a: act(t, command(t), tuple(a), p)[1],
        (0.0, end), rest(command(0.0), p), t_eval=times, rtol=1e-9, atol=1e-11, max_step=end / 500,
    )  # fmt: skip
    return times, np.array([act(t, command(t), tuple(a), p)[0] for t, a in zip(times, solved.y.T, strict=True)])


class TestActuators:
    def test_the_lag_answers_a_step_as_it_should(self) -> None:
        times = np.linspace(0.0, 2.0, 50)
        found = Linear("actuator_lag", tau=0.4).step(times)
        assert found == pytest.approx(1.0 - np.exp(-times / 0.4), abs=1e-9)

    def test_a_lag_too_short_to_integrate_is_as_late(self) -> None:
        times = np.linspace(0.0, 3.0, 30001)
        found = Linear("actuator_lag", tau=0.02, shortest=0.05).step(times)
        assert np.trapezoid(1.0 - found, times) == pytest.approx(0.02, abs=1e-5)

    @pytest.mark.parametrize(("phase", "short"), [(0.1, 1.5e-7), (1.0, 1.4e-3), (2.0, 0.018), (3.0, 0.063)])
    def test_the_delay_has_gain_one_and_the_stated_phase(self, phase: float, short: float) -> None:
        found = Linear("control_delay", tau=0.2).response(phase / 0.2)
        assert abs(found) == pytest.approx(1.0, abs=1e-12)
        lag = -np.angle(found)
        assert 0.0 <= (phase - lag) / phase <= short

    def test_a_delay_too_short_to_integrate_is_as_late(self) -> None:
        delay = Linear("control_delay", tau=0.03, shortest=0.1)
        assert -np.angle(delay.response(1e-3)) / 1e-3 == pytest.approx(0.03, rel=1e-6)

    @pytest.mark.parametrize("name", ["actuator_lag", "control_delay"])
    def test_it_starts_settled_on_the_first_command(self, name: str) -> None:
        fault = FAULTS[name]
        p = parameters(fault, tau=0.3)
        a = plain(fault.rest)(7.0, p)
        out, change = plain(fault.kernel)(0.0, 7.0, a, p)
        assert out == pytest.approx(7.0, abs=1e-14)
        assert change == pytest.approx((0.0,) * fault.states, abs=1e-12)

    def test_a_slow_ramp_passes_the_rate_limit_untouched(self) -> None:
        times, found = follow("actuator_rate_limit", lambda t: 1.5 * t, 4.0, rate=2.0, K=20.0)
        assert found.tolist() == (1.5 * times).tolist()

    def test_a_fast_ramp_is_followed_at_the_rate(self) -> None:
        times, found = follow("actuator_rate_limit", lambda t: 8.0 * t, 4.0, rate=2.0, K=20.0)
        late = times > 0.5
        assert np.diff(found[late]) / np.diff(times[late]) == pytest.approx(2.0, rel=1e-6)
        assert found[-1] == pytest.approx(8.0, abs=2.0 / 20.0 + 1e-6)

    def test_a_step_is_reached_when_the_rate_allows_and_then_held(self) -> None:
        times, found = follow("actuator_rate_limit", lambda t: 3.0 if t > 0.0 else 0.0, 4.0, rate=2.0, K=50.0)
        reached = times[np.argmax(found >= 3.0)]
        assert reached == pytest.approx(1.5, abs=2.0 / 50.0)
        assert found[times > 1.6].tolist() == [3.0] * int(np.count_nonzero(times > 1.6))

    def test_a_stuck_actuator_stays_where_it_was(self) -> None:
        times, found = follow("actuator_stuck", math.sin, 6.0, at=2.0, K=50.0)
        before, after = times < 2.0, times > 2.01
        assert found[before].tolist() == [math.sin(t) for t in times[before]]
        assert np.ptp(found[after]) < 1e-9
        assert found[-1] == pytest.approx(math.sin(2.0 - 1 / 50), abs=1e-3)

    def test_loss_bias_and_hard_over_do_what_they_say(self) -> None:
        def output(name: str, t: float, u: float, **given: float) -> float:
            fault = FAULTS[name]
            return float(plain(fault.kernel)(t, u, (), parameters(fault, **given))[0])

        assert output("actuator_loss", 1.0, 5.0, loss=0.4, at=2.0) == 5.0
        assert output("actuator_loss", 2.0, 5.0, loss=0.4, at=2.0) == pytest.approx(3.0)
        assert output("actuator_loss", 3.0, 5.0, loss=1.0, about=1.5, at=2.0) == pytest.approx(1.5)
        assert output("actuator_loss", 3.0, 5.0, loss=0.4, at=2.0, over=4.0) == pytest.approx(4.5)
        assert output("actuator_bias", 0.0, 5.0, bias=-0.5) == pytest.approx(4.5)
        assert output("hard_over", 1.9, 5.0, at=2.0, value=-3.0) == 5.0
        assert output("hard_over", 2.5, 5.0, at=2.0, over=1.0, value=-3.0) == pytest.approx(1.0)
        assert output("hard_over", 3.0, 5.0, at=2.0, over=1.0, value=-3.0) == pytest.approx(-3.0)

    def test_in_the_loop_a_constant_force_accelerates_evenly(self) -> None:
        problem = loop_with("hard_over", "force", {"horizon": 1.0}, at=0.0, value=2.0)
        assert flight(problem)[:, 3] == pytest.approx(2.0 / 5.0 * 0.005 * np.arange(201), abs=1e-12)

    def test_it_is_on_the_input_it_names(self) -> None:
        states = flight(loop_with("hard_over", "torque", {"horizon": 0.5}, at=0.0, value=0.0))
        assert np.abs(states[:, 4]).max() == 0.0
        assert states[-1, 3] > 0.1


class TestGuidance:
    def late(self, periods: float, horizon: float = 2.0) -> Problem:
        return loop_with("guidance_delay", "", {"horizon": horizon, "guidance": {"period": 0.1}}, periods=periods)

    def test_a_whole_period_shifts_the_demand_by_a_sample(self) -> None:
        problem = self.late(2.0)
        g = flight(problem)[:, problem.loop.n_state :]
        samples = g[::20]
        # newest, then the four before it: a shift register
        for lag in range(1, 5):
            assert samples[lag:, 2 * lag : 2 * lag + 2].tolist() == samples[: len(samples) - lag, 0:2].tolist()
        assert samples[0, 2:].tolist() == samples[0, :2].tolist() * 4

    @pytest.mark.parametrize("periods", [0.0, 1.0, 2.5, 4.0])
    def test_the_demand_that_acts_is_that_many_periods_old(self, periods: float) -> None:
        problem = self.late(periods)
        waited = plain(problem.loop._glue["closed_loop"]).__globals__["demand"]
        g = tuple(float(k) for k in range(10))  # newest (0, 1), before it (2, 3) ... (8, 9)
        p = problem.loop.extend(problem.nominal)
        assert waited(0.0, (), (), (), g, p) == pytest.approx((2 * periods, 2 * periods + 1))

    def test_it_needs_sampled_guidance(self) -> None:
        with pytest.raises(ValueError, match=r"only guidance with a period can be late"):
            loop_with("guidance_delay", periods=1.0)


def see(name: str, body: Body3, own: tuple[float, ...] = (0.0,) * 6, v: Any = (0.0, 0.0, 0.0), **given: float) -> Any:
    fault = FAULTS[name]
    return plain(fault.kernel)(given.pop("t", 0.0), 0.0, own, v, body, parameters(fault, **given))


def thing(x: float, y: float, z: float = 0.0, vx: float = 0.0, vy: float = 0.0, vz: float = 0.0) -> Body3:
    gap = math.sqrt(x * x + y * y + z * z) - 1.0
    return Body3(x, y, z, vx, vy, vz, 1.0, gap, -1.0, 0.0, 0.0)


class TestPerception:
    def test_a_displaced_obstacle_is_displaced_with_its_surface(self) -> None:
        problem = loop_with("position_error", dx=0.7, dy=-0.2)
        p = problem.loop.extend(problem.nominal)
        x = problem.loop.part("initial")(p)
        *_, q, _, seen = problem.loop.part("aware")(0.0, x, p)
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

    def test_beyond_its_range_a_sensor_sees_nothing(self) -> None:
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
        p = problem.loop.extend(problem.nominal)
        return problem.loop.part("aware")(t, problem.loop.part("initial")(p), p)[3][0]

    def true(self, t: float) -> Any:
        return self.seen(t, "latency")

    def test_a_late_track_is_where_the_obstacle_was(self) -> None:
        assert self.seen(5.0, "latency", tau=1.2) == pytest.approx(self.true(3.8))

    def test_a_compensated_one_is_where_it_is_on_a_straight_way(self) -> None:
        assert self.seen(5.0, "latency", tau=1.2, compensation=1.0) == pytest.approx(self.true(5.0), abs=1e-12)

    def test_in_a_dropout_the_last_track_is_held(self) -> None:
        for t, then in ((1.9, 1.9), (2.0, 2.0), (3.3, 2.0), (3.5, 3.5)):
            assert self.seen(t, "dropout", at=2.0, duration=1.5) == pytest.approx(self.true(then))

    def test_or_carried_on(self) -> None:
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
        p = problem.loop.extend(problem.nominal)
        return np.array(problem.loop.part("aware")(t, (1.0, 2.0, 0.3, 0.4, 0.5, 0.0, 0.0, 0.0, 0.0), p)[0])

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

    def test_uphill_it_slows_down_by_the_share_of_gravity(self) -> None:
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
