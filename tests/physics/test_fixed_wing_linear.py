"""The linear aircraft: derivatives and modes against the reconstruction's tables, scaling, its limit.

Values: the tables of the linear form (equation 3.44) at 15 and 20 m/s.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.physics.airframe import CALM, aircraft, flown, linear
from worker.engine.components.vehicles import fixed_wing, fixed_wing_linear
from worker.engine.kernels.bind import plain
from worker.engine.physics import trim
from worker.engine.physics.aerodynamics import Airframe
from worker.engine.systems.base import Floats

TABLES = {
    20.0: """
        -.1681   .7416  -.5636 -9.8055    .6488   6.4158
        -.7006 -9.2398 18.4529  -.2976  -3.9077   0
         .0215 -4.2045 -11.0474  0   -148.2112   3.8832
        -1.0638  .5592 -19.8006 9.8055   0       7.6396
        -2.9372 -15.3866 3.7166  0     177.4203 12.3957
         2.0942  2.2260 -3.4518  0     -34.1435 -107.3213""",
    15.0: """
        -.1146   .9138 -1.0355 -9.7845    .3886   6.4158
        -.8055 -6.9577 13.8074  -.7066  -2.1858   0
         .1410 -3.1522 -8.2855   0     -83.3695   3.8832
        -.8033  1.0448 -14.8184 9.7845   0       4.2973
        -2.2029 -11.54   2.7875  0      99.7989   6.9726
         1.5703  1.6695 -2.5888  0     -19.2057 -60.3682""",
}
"""X, Z, M over u, w, q, theta, elevator, throttle; Y, L, N over v, p, r, phi, aileron, rudder."""
MODES = {"short period": -10.1 + 8.8j, "phugoid": -0.09 + 0.40j, "roll": -15.3, "Dutch roll": -2.26 + 5.73j}


def table(speed: float) -> Floats:
    return np.array([[float(v) for v in row.split()] for row in TABLES[speed].strip().splitlines()])


def matrix(derivatives: Floats) -> Floats:
    """A row per axis in the order of the table."""
    axes = {axis: [trim.STATES.index(s) for s in states] for axis, states in fixed_wing_linear.AXES.items()}
    return np.array([derivatives["XYZLMN".index(axis), columns] for axis, columns in axes.items()])


class TestLinear:
    @pytest.mark.parametrize("speed", TABLES)
    def test_derivatives_are_the_tabulated_ones(self, speed: float) -> None:
        found = trim.derivatives(Airframe(), speed, trim.trimmed(Airframe(), speed))
        assert matrix(found) == pytest.approx(table(speed), abs=6e-5)

    @pytest.mark.parametrize("speed", TABLES)
    def test_they_are_those_of_the_vehicle(self, speed: float) -> None:
        # the component's own right-hand side, differenced about its trim
        p, f = linear(speed), plain(fixed_wing_linear.derivative)
        x = np.array(plain(fixed_wing_linear.component.begin)(fixed_wing.Start(speed=speed), p))
        u = np.array([p.elevator, 0.0, 0.0, p.throttle])

        def slopes(of: Floats, k: int) -> Floats:
            ends = []
            for h in (1e-5, -1e-5):
                of[k] += h
                ends.append(np.array(f(0.0, tuple(x.tolist()), tuple(u.tolist()), CALM, p)))
                of[k] -= h
            return np.asarray((ends[0] - ends[1]) / 2e-5)

        longitudinal = np.column_stack([slopes(x, k) for k in (6, 8, 10, 4)] + [slopes(u, k) for k in (0, 3)])
        lateral = np.column_stack([slopes(x, k) for k in (7, 9, 11, 3)] + [slopes(u, k) for k in (1, 2)])
        assert longitudinal[[6, 8, 10]] == pytest.approx(table(speed)[:3], abs=6e-5)
        assert lateral[[7, 9, 11]] == pytest.approx(table(speed)[3:], abs=6e-5)

    @pytest.mark.parametrize("speed", TABLES)
    def test_modes_are_those_of_the_table(self, speed: float) -> None:
        found = trim.derivatives(Airframe(), speed, trim.trimmed(Airframe(), speed))
        ours = modes(matrix(found))
        for name, value in modes(table(speed)).items():
            assert ours[name] == pytest.approx(value, rel=0.01), name
        if speed == 20.0:
            for name, value in MODES.items():
                assert ours[name] == pytest.approx(value, rel=0.01, abs=0.05 if name == "short period" else 0.005)
            assert ours["spiral"] == pytest.approx(-0.04, abs=0.005)

    def test_mass_and_two_coefficients_scale_as_stated(self) -> None:
        at = fixed_wing_linear.solve(
            {f"vehicle.{k}": v for k, v in Airframe()._asdict().items()}
            | {"vehicle.reference_speed": 20.0, "start.speed": 20.0}
        )
        derive = plain(fixed_wing_linear.derive)
        nominal = fixed_wing_linear.Constants(*derive(fixed_wing_linear.FixedWingLinear(*Airframe(), 20.0), at))
        heavier = Airframe()._replace(m=2.28, C_mde=-1.356, C_dt=9.752, C_La=5.0)
        other = fixed_wing_linear.Constants(*derive(fixed_wing_linear.FixedWingLinear(*heavier, 20.0), at))
        ratio = {k: v / getattr(nominal, k) for k, v in other._asdict().items() if getattr(nominal, k) != 0.0}
        light = {"X_u", "X_w", "Z_u", "Z_w", "Z_de", "Y_v", "Y_dr"}
        expected = dict.fromkeys(light, 1.9 / 2.28) | {"X_dt": 1.9 / 2.28 * 0.8, "M_de": 1.2}
        assert ratio == pytest.approx({k: expected.get(k, 1.0) for k in ratio}, rel=1e-12)

    def test_is_the_limit_of_the_nonlinear_one(self) -> None:
        # halving a disturbance must quarter the difference: what is left is of second order
        p, q = aircraft(), linear(20.0)
        x = np.array(plain(fixed_wing.begin)(fixed_wing.Start(), p))
        apart = []
        for size in (0.04, 0.02):
            y = x.copy()
            y[[4, 6, 8, 10]] += size * np.array([0.1, 3.0, 1.0, 0.3])
            u = (p.elevator + 0.05 * size, 0.0, 0.0, p.throttle + 0.3 * size)
            end = flown(p, y, u, 1.0) - flown(q, y, u, 1.0, vehicle=fixed_wing_linear)
            apart.append(float(np.abs(end[[4, 6, 8, 10]]).max()))
        assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.1)


def modes(rows: Floats) -> dict[str, complex]:
    """The modes of six rows X, Z, M, Y, L, N, theta and phi following q and p."""
    long, lateral = (
        np.vstack([half[:, :4], row]) for half, row in ((rows[:3], [0, 0, 1, 0]), (rows[3:], [0, 1, 0, 0]))
    )
    fast, slow = sorted((v for v in np.linalg.eigvals(long) if v.imag > 0), key=abs, reverse=True)
    real = sorted(v.real for v in np.linalg.eigvals(lateral) if abs(v.imag) < 1e-9)
    swinging = next(v for v in np.linalg.eigvals(lateral) if v.imag > 1e-9)
    return {"short period": fast, "phugoid": slow, "roll": real[0], "Dutch roll": swinging, "spiral": real[1]}
