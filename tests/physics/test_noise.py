"""The random numbers of the kernels, and the noise and gusts generated from them: moments, independence, spectra.

Statistical bounds are five standard errors of the sample: the numbers are fixed, so a test that passes keeps passing.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numba import njit
from scipy import linalg, stats

from worker.engine.components.environment import dryden_gusts
from worker.engine.components.faults import missed_detection, navigation_noise, sensor_noise
from worker.engine.kernels import maths
from worker.engine.kernels.bind import plain
from worker.engine.kernels.maths import kernel, normals, random_bits, scramble, uniform
from worker.engine.kernels.numba_internals import FLAGS
from worker.engine.kernels.views import Body3

N = 400_000


def table(function: Callable[..., Any], width: int) -> Callable[[float, float, int], Any]:
    """A compiled table (n, width) of a random kernel over counts 0 to n - 1."""

    @njit(**FLAGS)  # type: ignore[untyped-decorator]
    def fill(seed, stream, out):  # type: ignore[no-untyped-def]
        for i in range(out.shape[0]):
            row = function(seed, stream, float(i))
            for k in range(width):
                out[i, k] = row[k]

    def made(seed: float, stream: float, n: int) -> Any:
        out = np.empty((n, width))
        fill(seed, stream, out)
        return out

    return made


@kernel
def one(seed: float, stream: float, count: float) -> tuple[float]:
    return (uniform(seed, stream, count),)


uniforms = table(one, 1)
pairs = table(normals, 2)


class TestNumbers:
    def test_the_scrambler_is_that_of_splitmix64(self) -> None:
        # The first outputs of SplitMix64 from 1234567, as its reference implementation gives them.
        known = (6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431)
        with np.errstate(over="ignore"):
            state = np.uint64(1234567)
            for expected in known:
                state = state + maths.GOLDEN
                assert int(plain(scramble)(state)) == expected

    def test_plain_python_gives_the_same_numbers(self) -> None:
        with np.errstate(over="ignore"):
            for seed, stream, count in itertools.product((0.0, 3.0, 2.0**51 + 1), (0.0, 17.0), (-1.0, 0.0, 12345.0)):
                assert int(plain(random_bits)(seed, stream, count)) == int(random_bits(seed, stream, count))
                assert plain(uniform)(seed, stream, count) == uniform(seed, stream, count)
                assert plain(normals)(seed, stream, count) == pytest.approx(normals(seed, stream, count), abs=1e-14)

    @pytest.mark.parametrize("place", [0, 1, 2])
    def test_one_bit_of_any_input_moves_half_the_bits(self, place: int) -> None:
        words = np.random.default_rng(5).integers(0, 2**40, (300, 3))
        moved = []
        for word, bit in itertools.product(words, range(0, 40, 7)):
            other = word.copy()
            other[place] ^= 1 << bit
            with np.errstate(over="ignore"):  # the hash counts on integers that wrap
                moved.append(int(random_bits(*map(float, word)) ^ random_bits(*map(float, other))).bit_count())
        assert np.mean(moved) == pytest.approx(32.0, abs=5 * 4.0 / math.sqrt(len(moved)))
        assert min(moved) > 8

    def test_uniform_numbers_are_uniform(self) -> None:
        found = uniforms(1.0, 0.0, N)[:, 0]
        assert 0.0 <= found.min() < found.max() < 1.0
        counts, _ = np.histogram(found, bins=1000, range=(0.0, 1.0))
        assert stats.chisquare(counts).pvalue > 1e-4
        assert stats.kstest(found[:100_000], "uniform").pvalue > 1e-4

    def test_normal_numbers_have_the_moments_and_the_shape(self) -> None:
        found = pairs(2.0, 5.0, N).ravel()
        n = len(found)
        assert found.mean() == pytest.approx(0.0, abs=5 / math.sqrt(n))
        assert found.var() == pytest.approx(1.0, abs=5 * math.sqrt(2 / n))
        assert stats.skew(found) == pytest.approx(0.0, abs=5 * math.sqrt(6 / n))
        assert stats.kurtosis(found) == pytest.approx(0.0, abs=5 * math.sqrt(24 / n))
        assert stats.kstest(found[:100_000], "norm").pvalue > 1e-4
        assert np.abs(found).max() < 6.8

    def test_axes_counts_streams_and_seeds_are_independent(self) -> None:
        base = pairs(2.0, 5.0, N)
        others = [base[:, 1], pairs(3.0, 5.0, N)[:, 0], pairs(2.0, 6.0, N)[:, 0], pairs(2.0**33, 5.0, N)[:, 0]]
        others += [np.roll(base[:, 0], lag) for lag in (1, 2, 3, 10)]
        for other in others:
            assert np.corrcoef(base[:, 0], other)[0, 1] == pytest.approx(0.0, abs=5 / math.sqrt(N))
            assert np.corrcoef(base[:, 0] ** 2, other**2)[0, 1] == pytest.approx(0.0, abs=5 / math.sqrt(N))

    def test_the_logarithm_is_exact_to_rounding(self) -> None:
        x = np.concatenate([np.exp(np.linspace(-600, 600, 4001)), np.linspace(0.5, 2.0, 4001)])
        found = np.array([maths.log(v) for v in x])
        assert found == pytest.approx(np.log(x), rel=1e-15, abs=2e-16)
        assert math.isnan(maths.log(math.nan))


class TestTime:
    def test_a_sample_begins_with_its_step_in_spite_of_rounding(self) -> None:
        numbers = [maths.sample_number(i * 0.005, 0.1) for i in range(20_001)]
        assert numbers == [float(i // 20) for i in range(20_001)]

    def test_what_jumps_at_the_end_of_a_step_has_not_jumped_in_its_last_stage(self) -> None:
        last = 0.005 * (1.0 - 1e-8)
        assert [maths.sample_number(i * 0.005 + last, 0.1) for i in range(20_000)] == [
            float(i // 20) for i in range(20_000)
        ]

    def test_an_onset_is_a_ramp_or_a_step(self) -> None:
        assert [maths.onset(t, 2.0, 4.0) for t in (1.0, 2.0, 3.0, 6.0, 9.0)] == pytest.approx(
            [0, 0, 0.25, 1, 1], abs=1e-9
        )
        assert [maths.onset(t, 2.0, 0.0) for t in (1.9999999, 2.0, 2.5)] == [0.0, 1.0, 1.0]


THERE = Body3(5.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.5, 4.5, -1.0, 0.0, 0.0)


class TestSensors:
    def sights(self, index: float, **given: float) -> Any:
        p, see = sensor_noise.SensorNoise(**given), plain(sensor_noise.see)
        with np.errstate(over="ignore"):
            return np.array([see(0.2 * k + 0.05, index, (0.0,) * 6, (0.0,) * 3, THERE, p) for k in range(4000)])

    def test_deviations_are_those_asked_for_and_axes_independent(self) -> None:
        found = self.sights(0.0, sigma=0.3, sigma_v=0.1, period=0.2, seed=4.0)
        error = 5 / math.sqrt(2 * len(found))
        assert found[:, :6].std(axis=0) == pytest.approx([0.3] * 3 + [0.1] * 3, rel=error)
        assert found[:, 6].min() == 1.0
        off = np.corrcoef(found[:, :6].T) - np.eye(6)
        assert np.abs(off).max() < 5 / math.sqrt(len(found))

    def test_every_obstacle_has_noise_of_its_own(self) -> None:
        a, b = self.sights(0.0, sigma=1.0, period=0.2), self.sights(1.0, sigma=1.0, period=0.2)
        assert np.corrcoef(a[:, 0], b[:, 0])[0, 1] == pytest.approx(0.0, abs=5 / math.sqrt(len(a)))

    def test_it_holds_within_a_sample(self) -> None:
        p, see = sensor_noise.SensorNoise(sigma=1.0, period=0.2), plain(sensor_noise.see)
        with np.errstate(over="ignore"):
            found = [see(t, 0.0, (0.0,) * 6, (0.0,) * 3, THERE, p).x for t in (0.4, 0.45, 0.5999, 0.6)]
        assert found[0] == found[1] == found[2] != found[3]

    def test_navigation_noise_has_its_deviations(self) -> None:
        p, mistake = navigation_noise.NavigationNoise(2.0, 0.03, 0.5, 0.1, 9.0), plain(navigation_noise.mistake)
        with np.errstate(over="ignore"):
            found = np.array([mistake(0.1 * k, p) for k in range(4000)])
        assert found.std(axis=0) == pytest.approx([2.0, 2.0, 2.0, 0.03, 0.5], rel=5 / math.sqrt(2 * len(found)))
        assert np.abs(np.corrcoef(found.T) - np.eye(5)).max() < 5 / math.sqrt(len(found))

    def test_detections_are_missed_with_their_probability(self) -> None:
        p, see = missed_detection.MissedDetection(0.3, 0.1, 2.0), plain(missed_detection.see)
        with np.errstate(over="ignore"):
            seen = [see(0.1 * k, 0.0, (0.0,) * 6, (0.0,) * 3, THERE, p).visible for k in range(4000)]
        assert np.mean(seen) == pytest.approx(0.7, abs=5 * math.sqrt(0.21 / len(seen)))


class TestDryden:
    """Forming filters against the closed forms of MIL-F-8785C, in feet as it has them."""

    WIND, HEIGHT, SPEED = 15.4, 60.0, 17.0

    def given(self, **other: float) -> Any:
        asked = {"W": self.WIND, "h": self.HEIGHT, "V": self.SPEED} | other
        return dryden_gusts.Constants(*plain(dryden_gusts.derive)(dryden_gusts.DrydenGusts(**asked), ()))

    def closed_form(self) -> tuple[float, float, float, float]:
        """Deviation and time scale, horizontal and vertical."""
        h = self.HEIGHT / 0.3048
        s_w = 0.1 * self.WIND
        s_h = s_w / (0.177 + 0.000823 * h) ** 0.4
        length = h / (0.177 + 0.000823 * h) ** 1.2
        return s_h, 0.3048 * length / self.SPEED, s_w, 0.3048 * h / self.SPEED

    def filters(self) -> tuple[Any, Any, Any]:
        """dx/dt = A x + B n with unit noise, gusts = C x, read off the kernel (flying along x)."""
        p, blow, draw = self.given(period=1.0), plain(dryden_gusts.blow), plain(dryden_gusts.draw)
        with np.errstate(over="ignore"):
            at_rest = blow(0.0, (0.0,) * 3, (20.0, 0.0, 0.0), (0.0,) * 5, draw(0.0, p), p)
            units = [blow(0.0, (0.0,) * 3, (20.0, 0.0, 0.0), tuple(np.eye(5)[k]), draw(0.0, p), p) for k in range(5)]
            n_u, n_v = plain(normals)(p.seed, 0.0, 0.0)
            n_w, _ = plain(normals)(p.seed, 1.0, 0.0)
        a = np.array([np.subtract(u[1], at_rest[1]) for u in units]).T
        c = np.array([np.subtract(u[0][:3], at_rest[0][:3]) for u in units]).T
        driven = np.array(at_rest[1])
        b = np.zeros((5, 3))
        b[0, 0], b[1, 1], b[3, 2] = driven[0] / n_u, driven[1] / n_v, driven[3] / n_w
        assert driven[2] == driven[4] == 0.0
        return a, b, c

    def test_the_spectra_are_those_of_the_specification(self) -> None:
        a, b, c = self.filters()
        s_h, t_h, s_w, t_w = self.closed_form()
        for w in np.geomspace(1e-3, 1e2, 40):
            through = c @ np.linalg.solve(1j * w * np.eye(5) - a, b)
            found = np.abs(np.diag(through)) ** 2 / math.pi  # one-sided, noise of unit intensity
            asked = [
                s_h**2 * 2 * t_h / math.pi / (1 + (t_h * w) ** 2),
                s_h**2 * t_h / math.pi * (1 + 3 * (t_h * w) ** 2) / (1 + (t_h * w) ** 2) ** 2,
                s_w**2 * t_w / math.pi * (1 + 3 * (t_w * w) ** 2) / (1 + (t_w * w) ** 2) ** 2,
            ]
            assert found == pytest.approx(asked, rel=1e-6)
            assert np.abs(through - np.diag(np.diag(through))).max() < 1e-6 * np.abs(through).max()

    def test_the_stationary_variance_is_the_square_of_the_deviation(self) -> None:
        a, b, c = self.filters()
        covariance = c @ linalg.solve_continuous_lyapunov(a, -b @ b.T) @ c.T
        s_h, _, s_w, _ = self.closed_form()
        assert covariance == pytest.approx(np.diag([s_h**2, s_h**2, s_w**2]), rel=1e-6, abs=1e-5)

    def test_flights_start_in_the_stationary_state(self) -> None:
        a, b, _ = self.filters()
        asked = linalg.solve_continuous_lyapunov(a, -b @ b.T)
        with np.errstate(over="ignore"):
            starts = np.array([plain(dryden_gusts.wake)(self.given(seed=float(k))) for k in range(8000)])
        found = np.cov(starts.T)
        error = 5 * np.sqrt((np.outer(np.diag(asked), np.diag(asked)) + asked**2) / len(starts))
        assert (np.abs(found - asked) < error).all()

    @pytest.mark.nightly
    def test_simulated_in_steps_they_retain_variance_and_time_scale(self) -> None:
        gusts = _history(self.given(), 0.05, 1_000_000)
        s_h, t_h, s_w, t_w = self.closed_form()
        total = 0.05 * len(gusts)
        for g, s, scale, transverse in zip(gusts.T, (s_h, s_h, s_w), (t_h, t_h, t_w), (0, 1, 1), strict=True):
            error = 5 * math.sqrt(2 * scale / total)  # few independent pieces: total / (2 scale)
            assert g.mean() == pytest.approx(0.0, abs=s * error)
            assert g.var() == pytest.approx(s**2, rel=1.5 * error)
            for share in (0.5, 1.0):
                lag = round(share * scale / 0.05)
                x = lag * 0.05 / scale
                asked = math.exp(-x) * (1 - 0.5 * x * transverse)
                assert np.mean(g[lag:] * g[:-lag]) / g.var() == pytest.approx(asked, abs=error)

    def test_gusts_follow_the_direction_of_flight(self) -> None:
        p, blow, draw = self.given(), plain(dryden_gusts.blow), plain(dryden_gusts.draw)
        e = (1.0, 0.5, -0.2, 0.3, 0.1)
        with np.errstate(over="ignore"):
            north = blow(0.0, (0.0,) * 3, (10.0, 0.0, 0.0), e, draw(0.0, p), p)[0]
            east = blow(0.0, (0.0,) * 3, (0.0, 10.0, 0.0), e, draw(0.0, p), p)[0]
        assert (east.wind_x, east.wind_y) == pytest.approx((-north.wind_y, north.wind_x))
        assert east.wind_z == north.wind_z


def _history(p: Any, step: float, steps: int) -> Any:
    """The gusts (steps, 3) met flying along x, by the Runge-Kutta rule of the loop."""
    blow, draw, wake, tiny = dryden_gusts.blow, dryden_gusts.draw, dryden_gusts.wake, step * (1.0 - 1e-8)

    @njit(**FLAGS)  # type: ignore[untyped-decorator]
    def fly(p, out):  # type: ignore[no-untyped-def]
        q, v = (0.0, 0.0, 0.0), (20.0, 0.0, 0.0)
        x = np.array(wake(p))
        for i in range(out.shape[0]):
            t = i * step
            s, d = blow(t, q, v, (x[0], x[1], x[2], x[3], x[4]), draw(t, p), p)
            a = np.array(d)
            out[i, 0], out[i, 1], out[i, 2] = s.wind_x, s.wind_y, s.wind_z
            y = x + 0.5 * step * a
            b = np.array(blow(t + 0.5 * step, q, v, (y[0], y[1], y[2], y[3], y[4]), draw(t + 0.5 * step, p), p)[1])
            y = x + 0.5 * step * b
            c = np.array(blow(t + 0.5 * step, q, v, (y[0], y[1], y[2], y[3], y[4]), draw(t + 0.5 * step, p), p)[1])
            y = x + step * c
            d = np.array(blow(t + tiny, q, v, (y[0], y[1], y[2], y[3], y[4]), draw(t + tiny, p), p)[1])
            x = x + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)

    out = np.empty((steps, 3))
    fly(p, out)
    return out
