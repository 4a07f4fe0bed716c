"""The own DOP853: order, dense output, discontinuities, minima between steps, and cases that cannot be simulated.

Everything here is the same code that is compiled, run in plain Python on systems with a closed form. The compiled code
is held against SciPy's in `test_reference_flights`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from worker.engine.reference import coefficients, flight, stepper
from worker.engine.reference.stepper import (
    BARRED,
    BEGIN,
    CHANNEL_ROWS,
    COST,
    LIMIT,
    NEW,
    ROWS,
    SAMPLE,
    SEE,
    SLOPE,
    WORK,
    K,
    X,
)

Floats = NDArray[np.float64]
Slope = Callable[[float, Floats, Floats], tuple[Any, Any]]


class System:
    """A system of slopes (t, x, p) -> (dx, channels) from a given start; p may be sampled."""

    def __init__(self, slope: Slope, start: Any, sample: Callable[[float, Floats], float] | None = None) -> None:
        self.slope, self.start, self.sample = slope, np.atleast_1d(np.array(start, dtype=float)), sample
        self.limit: Callable[[Floats], float] = lambda x: 0.0
        self.barred = False
        self.calls = 0

    def __call__(self, what: int, t: float, x: Floats, dx: Floats, y: Floats, p: Floats) -> float:
        if what in (SLOPE, SEE):
            self.calls += 1
            slope, y[:] = self.slope(t, x, p)
            if what == SLOPE:
                dx[:] = slope
        elif what == BEGIN:
            x[:] = self.start
        elif what == SAMPLE and self.sample is not None:
            p[0] = self.sample(t, x)
        elif what == LIMIT:
            return self.limit(x)
        elif what == BARRED:
            return float(self.barred)
        elif what == COST:
            return float(y.min())
        return 0.0


PATIENCE = 5_000
"""Calls without progress after which `flown` gives up a tolerance."""


def flown(
    system: System,
    instants: Any,
    asks: Any = None,
    before: float = 0.0,
    look: float = math.inf,
    turns: bool = False,
) -> tuple[Floats, Floats]:
    """The result of `flight.fly`, and the last state."""
    instants = np.array(instants, dtype=float)
    b, found = np.zeros((ROWS, len(system.start))), np.zeros(6)
    asked = np.zeros(len(instants) - 1, dtype=bool) if asks is None else np.array(asks)
    with np.errstate(all="ignore"):
        room = np.zeros((CHANNEL_ROWS, 1)), np.zeros(1), np.array([0.0, 0.0, 0.0, 0.0, look])
        flight.fly(system, instants, asked, np.full(len(asked), turns), before, PATIENCE, b, *room, found)
    return found, b[X]


def rational(t: float, x: Floats, p: Floats) -> tuple[Any, Any]:
    """x = 1 / (1 + t^2), and an oscillator; a monotonic channel, so that almost no step needs dense output."""
    return (-2.0 * t * x[0] ** 2, x[2], -x[1]), t


def exactly(t: Any) -> Floats:
    return np.array([1.0 / (1.0 + t**2), np.sin(t), np.cos(t)])


def stepped(h: float, steps: int) -> tuple[float, float]:
    """The error at t = 1 after so many steps of length h, and the largest of the dense output within the first."""
    system, p = System(rational, exactly(0.0)), np.zeros(1)
    b, y = np.zeros((ROWS, 3)), np.zeros((CHANNEL_ROWS, 1))
    b[X], inside = exactly(0.0), 0.0
    for k in range(steps):
        stepper.stages(k * h, h, 0, 13, 9.0, 1.0, 1.0, system, b, y, p)
        if k == 0:
            stepper.stages(0.0, h, 13, 16, 9.0, 1.0, 1.0, system, b, y, p)
            stepper.bend(h, b)
            for fraction in np.linspace(0.0, 1.0, 21):
                stepper.between(fraction, b)
                inside = max(inside, float(np.abs(b[WORK] - exactly(fraction * h)).max()))
        b[X] = b[NEW]
    return float(np.abs(b[X] - exactly(steps * h)).max()), inside


class TestStepper:
    def test_the_coefficients_meet_the_conditions_of_order_for_quadrature(self) -> None:
        b, c = coefficients.A[12, :12], coefficients.C[:12]
        for k in range(8):
            assert b @ c**k == pytest.approx(1.0 / (k + 1), abs=1e-14)
        assert coefficients.A.sum(axis=1) == pytest.approx(coefficients.C, abs=2e-14)

    def test_the_error_falls_with_the_eighth_power_of_the_step(self) -> None:
        orders = [math.log2(stepped(1 / n, n)[0] / stepped(0.5 / n, 2 * n)[0]) for n in (3, 4)]
        assert orders == pytest.approx([8.0, 8.0], abs=0.6)

    def test_the_dense_output_is_of_order_seven(self) -> None:
        # Within one step: one power more.
        order = math.log2(stepped(0.5, 1)[1] / stepped(0.25, 1)[1])
        assert order == pytest.approx(8.0, abs=0.7)

    def test_the_error_estimate_is_that_of_scipy(self) -> None:
        system, p, h = System(rational, exactly(0.3)), np.zeros(1), 0.4
        b, y = np.zeros((ROWS, 3)), np.zeros((CHANNEL_ROWS, 1))
        b[X] = exactly(0.3)
        error = stepper.stages(0.3, h, 0, 13, 9.0, 1e-5, 1e-5, system, b, y, p)
        slopes, scale = b[K : K + 13], 1e-5 + 1e-5 * np.maximum(np.abs(b[X]), np.abs(b[NEW]))
        five, three = (np.linalg.norm(slopes.T @ e / scale) ** 2 for e in (coefficients.E5[:13], coefficients.E3[:13]))
        assert error == pytest.approx(h * five / math.sqrt((five + 0.01 * three) * 3), rel=1e-12)

    def test_no_slope_is_taken_after_the_end(self) -> None:
        latest = [0.0]

        def slope(t: float, x: Floats, p: Floats) -> tuple[Any, Any]:
            latest[0] = max(latest[0], t)
            return 1.0, 0.0

        flown(System(slope, 0.0), [0.0, 1.0], before=1e-8)
        assert latest[0] == 1.0 - 1e-8


class TestFlight:
    def test_a_closed_form_is_reached_within_the_tolerance(self) -> None:
        found, x = flown(System(rational, exactly(0.0)), [0.0, 1.0, 10.0])
        assert x == pytest.approx(exactly(10.0), abs=2 * flight.RELATIVE)
        assert (found[1], found[2], found[4]) == (flight.OK, 10.0, 0.0)

    @pytest.fixture
    def few_looks(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Calls are counted: next to none to read the channels."""
        monkeypatch.setattr(flight, "READINGS", 1)

    def test_it_calls_no_more_than_scipy(self, few_looks: None) -> None:
        system = System(rational, exactly(0.0))
        flown(system, [0.0, 10.0])
        theirs = solve_ivp(
            lambda t, x: rational(t, x, x)[0],
            (0.0, 10.0),
            exactly(0.0),
            method="DOP853",
            rtol=flight.RELATIVE,
            atol=flight.RELATIVE,
        )
        assert system.calls < 1.2 * theirs.nfev

    def test_a_jump_at_an_instant_is_met_exactly(self, few_looks: None) -> None:
        # A constant acceleration that turns round at t = 1: the position is a polynomial on either side.
        def slope(t: float, x: Floats, p: Floats) -> tuple[Any, Any]:
            return (x[1], 2.0 if t < 1.0 else -6.0), t

        system = System(slope, (0.0, 0.0))
        found, x = flown(system, [0.0, 1.0, 3.0], before=1e-8)
        assert x == pytest.approx((1.0 + 4.0 - 12.0, 2.0 - 12.0), abs=1e-13)
        assert found[4] == 0.0
        assert system.calls < 400
        beside = System(slope, (0.0, 0.0))
        flown(beside, [0.0, 1.0 + 1e-3, 3.0], before=1e-8)
        assert beside.calls > 1.3 * system.calls

    def test_samples_are_held_and_asked_for_at_their_instants(self) -> None:
        at: list[float] = []

        def sample(t: float, x: Floats) -> float:
            at.append(t)
            return t

        system = System(lambda t, x, p: (p[0], 0.0), 0.0, sample)
        _, x = flown(system, [0.0, 0.5, 1.0, 1.5, 2.0], [True, False, True, True])
        assert at == [0.0, 1.0, 1.5]
        assert x[0] == pytest.approx(1.0 * 0.5 + 1.5 * 0.5, abs=1e-14)

    @pytest.mark.parametrize("at", [0.123456, 1.0, 4.9999999, 7.5, 9.99])
    def test_the_minimum_between_steps(self, at: float) -> None:
        # Straight past an obstacle: the steps are as long as the flight, the minimum is anywhere within one.
        def slope(t: float, x: Floats, p: Floats) -> tuple[Any, Any]:
            return 20.0, 9.0 + (x[0] - 20.0 * at) ** 2

        found, _ = flown(System(slope, 0.0), [0.0, 10.0])
        assert found[0] == pytest.approx(9.0, abs=1e-12)

    def test_the_lowest_of_many_minima(self) -> None:
        # Beats: minima every 0.1 s and less, the lowest at t = pi, each far narrower than a step may be.
        def slope(t: float, x: Floats, p: Floats) -> tuple[Any, Any]:
            return 1.0, math.cos(31.0 * x[0]) + math.cos(63.0 * x[0]) + 0.01 * (x[0] - 3.0) ** 2

        found, _ = flown(System(slope, 0.0), [0.0, 6.0])
        times = np.linspace(0.0, 6.0, 2_000_001)
        assert found[0] == pytest.approx(
            (np.cos(31 * times) + np.cos(63 * times) + 0.01 * (times - 3) ** 2).min(), abs=1e-8
        )

    def test_a_motion_that_repeats_with_the_steps_is_looked_at_inside_them(self) -> None:
        # From 5 s on a period of half a step, highest at the ends of every step: their difference says nothing.
        def slope(t: float, x: Floats, p: Floats) -> tuple[Any, Any]:
            return 1.0, 3.0 + 1e-3 * min(t, 5.0) + (math.cos(4.0 * math.pi * t) if t > 5.0 else 1.0)

        instants = np.arange(0.0, 10.5, 1.0)
        missed, _ = flown(System(slope, 0.0), instants, [True] * 10)
        followed, _ = flown(System(slope, 0.0), instants, [True] * 10, look=math.pi / 4.0 / (4.0 * math.pi))
        assert (missed[0], followed[0]) == (4.0, pytest.approx(2.005, abs=1e-12))
        beside, _ = flown(System(slope, 0.0), instants, [True] * 10, turns=True)
        assert beside[0] == pytest.approx(2.005, abs=1e-12)

    @pytest.mark.parametrize("at", [1.0005, 1.0025, 1.9975, 1.9995])
    def test_a_minimum_between_the_last_two_samples_of_a_step(self, at: float) -> None:
        # It was lower before than beside the end of the step, but not as low as within it.
        def slope(t: float, x: Floats, p: Floats) -> tuple[Any, Any]:
            return 1.0, 1.5 if t < 1.0 else 1.0 + abs(t - at) / min(at - 1.0, 2.0 - at)

        found, _ = flown(System(slope, 0.0), [0.0, 1.0, 2.0, 10.0], before=1e-8)
        assert found[0] == pytest.approx(1.0, abs=1e-5)

    def test_a_minimum_at_either_end(self) -> None:
        up, _ = flown(System(lambda t, x, p: (1.0, x[0]), 2.0), [0.0, 1.0])
        down, _ = flown(System(lambda t, x, p: (-1.0, x[0]), 2.0), [0.0, 1.0])
        assert (up[0], down[0]) == (2.0, pytest.approx(1.0, abs=1e-15))


class TestWhatCannotBeFlown:
    def test_sliding_is_integrated_at_the_coarse_tolerance(self) -> None:
        # x slides along 0 from t = 1 on.
        system = System(lambda t, x, p: (-math.copysign(1.0, x[0]), abs(x[0])), 1.0)
        found, x = flown(system, [0.0, 0.5, 1.5, 2.0])
        assert found[1] == flight.OK
        assert (found[3], found[4]) == (0.5, flight.STUCK)
        assert found[5] == pytest.approx(1.0, abs=1e-2)
        assert abs(x[0]) < 1e-3

    def test_without_headway_even_then_it_ends(self) -> None:
        system = System(lambda t, x, p: (-1e5 * math.copysign(1.0, x[0]), 0.0), 1e5)
        found, _ = flown(system, [0.0, 2.0])
        assert found[1] in (flight.STUCK, flight.SHORT)
        assert found[2] == pytest.approx(1.0, abs=1e-2)
        assert system.calls < 3 * (1 + flight.LENIENT) * PATIENCE

    @pytest.mark.parametrize(
        "slope",
        [
            lambda t, x, p: (x[0] ** 2, 0.0),  # infinite at t = 1
            lambda t, x, p: (math.inf if t > 1.0 else 0.0, 0.0),
            lambda t, x, p: (math.nan if t > 1.0 else 0.0, 0.0),
            lambda t, x, p: (0.0, math.nan if t > 1.0 else 0.0),
            lambda t, x, p: (0.0, 1e301 if t > 1.0 else 0.0),
            lambda t, x, p: (1e200 * x[0], 0.0),
        ],
    )
    def test_nan_and_overflow_end_it(self, slope: Slope) -> None:
        system = System(slope, 1.0)
        found, _ = flown(system, [0.0, 0.9, 2.0, 3.0])
        assert found[1] in (flight.SHORT, flight.NOT_FINITE, flight.STUCK)
        assert found[2] <= 2.0
        assert system.calls < 3 * (1 + flight.LENIENT) * PATIENCE

    def test_the_envelope_and_the_precondition(self) -> None:
        system = System(lambda t, x, p: (1.0, 0.0), 0.0)
        system.limit = lambda x: 2.0 if x[0] > 1.25 else 0.0
        found, _ = flown(system, np.linspace(0.0, 3.0, 31))
        assert (found[1], found[2]) == (flight.OUTSIDE + 1.0, pytest.approx(1.3, abs=0.05))
        system.barred = True
        assert flown(system, [0.0, 1.0])[0][1] == flight.EXCLUDED
