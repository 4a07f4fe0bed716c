"""The ported falsification problems: statements of their publications, and that the integration is converged."""

from __future__ import annotations

import numpy as np
import pytest

from tests.given.falsification import PROBLEMS
from tests.given.falsification import aircraft as f16
from tests.given.falsification import transmission as at
from tests.given.falsification import vehicles as cc
from tests.given.falsification.problem import always, eventually
from worker.engine.search.base import Floats


@pytest.fixture(scope="module")
def full_throttle() -> Floats:
    return at.simulate(np.array([100.0] * at.PIECES + [0.0] * at.PIECES))


def test_operators_look_at_the_samples_of_their_interval() -> None:
    signal = np.array([3.0, -1.0, 4.0, 1.0, -5.0, 9.0])
    np.testing.assert_array_equal(always(signal, 0, 2), [-1.0, -1.0, -5.0, -5.0])
    np.testing.assert_array_equal(eventually(signal, 1, 3), [4.0, 4.0, 9.0])


def test_full_throttle_is_the_counterexample_of_the_benchmark(full_throttle: Floats) -> None:
    """ARCH-COMP: 120 mph are exceeded shortly before 20 s, and 4,750 rpm before 10 s, by full throttle."""
    assert -1.0 < at.at1(full_throttle) < 0.0
    assert -50.0 < at.at2(full_throttle) < 0.0


def test_the_transmission_shifts_up_at_the_speeds_of_its_schedule(full_throttle: Floats) -> None:
    speed, gear = full_throttle[:, 0], full_throttle[:, 2]
    shifts = np.flatnonzero(np.diff(gear))
    assert list(np.diff(gear)[shifts]) == [1.0, 1.0, 1.0]
    ticks = [int(shift) - at.WAIT + 1 for shift in shifts]  # the first tick beyond the threshold
    for tick, threshold in zip(ticks, (40.0, 70.0, 100.0), strict=True):
        assert speed[tick - 1] <= threshold < speed[tick + 1]


def test_without_throttle_the_engine_idles_and_the_brake_holds() -> None:
    signals = at.simulate(np.array([0.0] * at.PIECES + [325.0] * at.PIECES))
    assert (signals[:, 2] == 1.0).all()
    assert signals[-1, 0] < 5.0
    assert signals[:, 1].max() <= 1000.0


@pytest.mark.nightly
def test_without_input_the_chasing_cars_stand() -> None:
    positions = cc.simulate(np.zeros(2 * cc.PIECES))
    np.testing.assert_array_equal(positions, np.tile(10.0 * np.arange(5), (len(positions), 1)))
    assert cc.cc1(positions) == 30.0
    assert cc.cc2(positions) == -5.0  # never 15 apart


@pytest.mark.nightly
def test_a_car_that_falls_behind_chases_until_it_is_near_again() -> None:
    positions = cc.simulate(np.array([1.0, 0, 0, 0, 0, 0, 0, 0, 0, 0]))
    gap = positions[:, 1] - positions[:, 0]
    began = int(np.argmax(gap >= 15.0))
    assert 0 < began < len(gap)
    assert gap[began : began + 5 * cc.RATE].min() > 10.0
    assert (gap[:began] < 15.0).all()


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("simulated", "step", "seconds", "high", "pieces"),
    [
        (at.simulated, at.STEP, at.SECONDS, [100.0, 325.0], at.PIECES),
        (cc.simulated, cc.STEP, 10, [1.0, 1.0], cc.PIECES),
    ],
    ids=["transmission", "cars"],
)
def test_half_the_step_gives_the_same_signals(simulated, step, seconds, high, pieces) -> None:  # type: ignore[no-untyped-def]
    inputs = np.repeat(high, pieces) * np.random.default_rng(4).random(2 * pieces) * np.repeat([1.0, 0.1], pieces)
    steps = round(seconds / step)
    coarse, fine = simulated(inputs, step, steps, 4), simulated(inputs, step / 2, 2 * steps, 8)
    np.testing.assert_allclose(coarse, fine, rtol=2e-3, atol=0.1)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["CC1", "CC3", "AT2"])
def test_random_inputs_violate_what_the_competition_calls_easy(name: str) -> None:
    problem = PROBLEMS[name]
    values = problem(np.random.default_rng(1).random((120, problem.dimension)))
    assert 0.0 < (values <= 0.0).mean() < 0.5
    assert values[7] == problem(np.random.default_rng(1).random((120, problem.dimension))[7:8])[0]


@pytest.mark.nightly
def test_random_inputs_satisfy_what_the_competition_calls_hard() -> None:
    for name in ("CC4", "AT1"):
        problem = PROBLEMS[name]
        assert problem(np.random.default_rng(1).random((120, problem.dimension))).min() > 0.0


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("attitude", "published"),
    [
        ((0.79507471, -1.21425906, -1.14591671), 792.334),
        ((0.63264546, -1.12888887, -0.46122069), 1048.720),
        ((0.78713541, -1.14204801, -0.75113518), 927.456),
        ((0.87311992, -1.12848308, -1.17594643), 920.062),
    ],
)
def test_the_aircraft_loses_the_altitude_that_the_published_program_states(
    attitude: tuple[float, ...], published: float
) -> None:
    """From 3,000 ft, AeroBenchVVPython's `run_f16_sim` with Morelli's model, whose integrator controls its error."""
    steps = round(f16.SECONDS / f16.STEP)
    signals = f16.simulated(np.array(attitude), 3000.0, f16.STEP, steps, f16.LOGIC)
    assert f16.lowest(signals) == pytest.approx(published, abs=0.02)
    assert list(np.unique(signals[:, 2])) == [f16.ROLL, f16.PULL, f16.STANDBY]
    assert signals[0, 2] == f16.ROLL


@pytest.mark.nightly
def test_the_aircraft_hits_the_ground_from_one_attitude_in_thousands() -> None:
    problem = PROBLEMS["F16"]
    assert problem(np.random.default_rng(1).random((300, 3))).min() > 0.0
    assert -1.0 < problem(np.array([[0.9081234, 0.0, 0.9276416]]))[0] < 0.0
