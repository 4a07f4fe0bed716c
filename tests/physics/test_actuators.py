"""Faults of actuators and guidance: closed forms of lag, delay and rate limit, and of stuck, lost or late commands."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from campaigns.results.base import FAILED, OK
from clearance.testing.problems import Problem
from tests.physics.conditions import CASE, FAULTS, loop_with, parameters
from tests.physics.scenes import changed, flight, uncompiled
from worker.engine.kernels.bind import plain


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

    @pytest.mark.parametrize("name", [name for name, fault in FAULTS.items() if fault.rest is not None])
    def test_before_the_start_there_is_no_fault(self, name: str) -> None:
        """A bias from t = 0 acts as one from just after it: what follows it rests on the controller's command."""
        bias = {"component": "actuator_bias", "on": "force", "parameters": {"bias": 3.0}}
        begun = []
        for before in ([], [bias]):
            problem = uncompiled(changed(CASE, faults=[*before, {"component": name, "on": "force"}]))
            begun.append(problem.system.loop.part("initial")(problem.system.loop.extend(problem.system.nominal)))
        assert begun[0] == begun[1]

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
        g = flight(problem)[:, problem.system.loop.n_state :]
        samples = g[::20]
        # newest, then the four before it: a shift register
        for lag in range(1, 5):
            assert samples[lag:, 2 * lag : 2 * lag + 2].tolist() == samples[: len(samples) - lag, 0:2].tolist()
        assert samples[0, 2:].tolist() == samples[0, :2].tolist() * 4

    @pytest.mark.parametrize("periods", [0.0, 1.0, 2.5, 4.0])
    def test_the_demand_that_acts_is_that_many_periods_old(self, periods: float) -> None:
        problem = self.late(periods)
        waited = problem.system.loop.part("demand")
        g = tuple(float(k) for k in range(10))  # newest (0, 1), before it (2, 3) ... (8, 9)
        p = problem.system.loop.extend(problem.system.nominal)
        assert waited(0.0, (), (), (), g, p) == pytest.approx((2 * periods, 2 * periods + 1))

    def test_a_demand_that_is_not_stored_any_more_is_no_number(self) -> None:
        """What the check of a campaign cannot see, such as the delay of a component of one's own, fails."""
        for periods, status in ((1.0, OK), (2.5, FAILED)):
            delay = {"component": "guidance_delay", "parameters": {"periods": periods}}
            problem = uncompiled(changed(CASE, faults=[delay, delay], guidance={"period": 0.1}, horizon=1.0))
            batch, _ = problem.system.simulate_vectors(problem.vector({})[None])
            assert batch.status[0] == status

    def test_it_needs_sampled_guidance(self) -> None:
        with pytest.raises(ValueError, match=r"only sampled guidance can be delayed"):
            loop_with("guidance_delay", periods=1.0)
