"""Vehicles that fly relative to the air: the limits of the flow and the air data, whatever wind and navigation are.

Second formulation: velocities through the air by SciPy's rotations.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from campaigns import library, load_file
from campaigns.results.base import FAILED, OK
from clearance.testing.problems import Problem
from tests.physics.scenes import changed, flight, uncompiled
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Vehicle
from worker.engine.physics import aircraft
from worker.engine.systems.base import Floats
from worker.running.catalogue.installed import components

CRUISE = load_file(library()["uav_aca_no_avoidance"])
AIRBORNE = [c for c in components().values() if isinstance(c, Vehicle) and c.felt is not None]
EVERY = pytest.mark.parametrize("vehicle", AIRBORNE, ids=lambda v: v.name)
BIAS = {"dx": 3.0, "dy": -2.0, "dz": 1.0, "dpsi": 0.9, "du": 0.7}


def in_wind(vehicle: str = "fixed_wing", **scenario: Any) -> Problem:
    wind = [{"component": "steady_wind", "parameters": {"x": 7.0, "y": -11.0, "z": 4.0}}]
    return uncompiled(changed(CRUISE, vehicle={"component": vehicle}, **({"environment": wind} | scenario)))


def turned(x: Floats, wind: Floats) -> Floats:
    """A wind in the body axes of a state."""
    return np.asarray(Rotation.from_euler("ZYX", [x[5], x[4], x[3]]).inv().apply(wind))


def states(count: int) -> Floats:
    """Random states whose velocity, read as one through the air, is inside and beyond each limit of the flow."""
    random = np.random.default_rng(5)
    x = random.uniform(-1.0, 1.0, (count, 12)) * ([100.0] * 3 + [1.5, 1.2, 3.1] + [0.0, 25.0, 25.0] + [10.0] * 3)
    x[::2, 7:9] *= 0.04
    x[:, 6] = random.choice([2.0, 20.0, 40.0, 101.0], count)
    return x


@EVERY
def test_the_envelope_is_that_of_the_flow(vehicle: Vehicle) -> None:
    """Galilean symmetry: with any wind the same limits as in still air at the same velocity through the air."""
    loop, vector = in_wind(vehicle.name).system.loop, in_wind(vehicle.name).vector
    still, random, found = plain(vehicle.outside), np.random.default_rng(6), []
    for x in states(200):
        wind = random.uniform(-30.0, 30.0, 3)
        p = loop.extend(vector({f"environment.0.{axis}": w for axis, w in zip("xyz", wind, strict=True)}))
        over_ground = x.copy()
        over_ground[6:9] += turned(x, wind)
        found.append(loop.part("envelope")(0.0, (*over_ground, *(0.0,) * (loop.n_state - 12)), p))
        assert found[-1] == still(tuple(x), ())
    assert {0.0, 3.0, 4.0, 5.0, 6.0} <= set(found)


@EVERY
def test_a_turn_in_wind_is_that_in_still_air_carried_along(vehicle: Vehicle) -> None:
    """Galilean symmetry: a velocity over ground changes as that through the air, and by the turn of the wind."""
    problem = in_wind(vehicle.name)
    loop, random = problem.system.loop, np.random.default_rng(7)
    calm = loop.extend(problem.vector({f"environment.0.{axis}": 0.0 for axis in "xyz"}))
    for x in states(50):
        wind = random.uniform(-30.0, 30.0, 3)
        p = loop.extend(problem.vector({f"environment.0.{axis}": w for axis, w in zip("xyz", wind, strict=True)}))
        over_ground, body_wind = x.copy(), turned(x, wind)
        over_ground[6:9] += body_wind
        rest, g = (0.0,) * (loop.n_state - 12), loop.part("initial_guidance")(p)
        still, found = (
            np.array(loop.part("closed_loop")(0.0, (*y, *rest), g, q)[0]) for y, q in ((x, calm), (over_ground, p))
        )
        still[:3] += wind
        still[6:9] -= np.cross(x[9:12], body_wind)
        assert found == pytest.approx(still, rel=1e-9, abs=1e-9)


@EVERY
def test_a_flight_starts_as_trimmed_in_still_air(vehicle: Vehicle) -> None:
    windy, still = in_wind(vehicle.name), in_wind(vehicle.name, environment=[])
    begun = [p.system.loop.part("initial")(p.system.loop.extend(p.system.nominal))[:12] for p in (windy, still)]
    assert begun[0] == begun[1]
    (speed,) = (p for p in windy.system.parameters if p.path == "start.speed")
    assert "over ground" in speed.text


REASONS: dict[str, Callable[[Any], float]] = {
    "the pitch": lambda x: abs(x[4]),
    "the bank": lambda x: abs(x[3]),
    "the forward speed through the air is below": lambda x: -x[6],
    "the forward speed through the air exceeds": lambda x: x[6],
    "the sideways speed through the air exceeds the forward speed": lambda x: abs(x[7]) - x[6],
    "the angle of attack through the air": lambda x: abs(math.degrees(math.atan2(x[8], x[6]))),
    "the magnitudes of the turn rates p, q, r add up to": lambda x: np.abs(x[9:12]).sum(),
    "the speed": lambda x: abs(x[3]),
    "the turn rate": lambda x: abs(x[4]),
}
"""What a reason is about, which must be beyond the number in it, if there is one."""


@pytest.mark.parametrize(
    "vehicle", [c for c in components().values() if isinstance(c, Vehicle) and c.limits], ids=lambda v: v.name
)
def test_the_reason_of_a_failure_is_true(vehicle: Vehicle) -> None:
    random, found, size = np.random.default_rng(8), set(), 12 if vehicle in AIRBORNE else 5
    for _ in range(4000):
        x = random.uniform(-1.0, 1.0, size) * random.choice([0.01, 1.0, 30.0, 120.0, 2000.0], size)
        number = int(plain(vehicle.outside)(tuple(x.tolist()), ()))
        if number:
            found.add(number)
            reason = vehicle.limits[number - 1].text
            about = max((text for text in REASONS if reason.startswith(text)), key=len)
            limit = re.search(r"[\d.]+", reason)
            assert REASONS[about](x) > (float(limit[0]) * (-1.0 if "below" in reason else 1.0) if limit else 0.0), (
                reason
            )
    assert found == set(range(1, len(vehicle.limits) + 1))


@EVERY
def test_errors_of_navigation_leave_the_airspeed_alone(vehicle: Vehicle) -> None:
    """Only an error of speed is one of the airspeed; position and heading are off by their own errors."""
    problem = in_wind(vehicle.name, faults=[{"component": "navigation_bias", "parameters": BIAS}])
    loop = problem.system.loop
    p, surroundings = loop.extend(problem.vector({})), loop.part("surroundings")
    for x in states(50):
        env, _ = surroundings(0.0, tuple(x[:3]), (0.0, 0.0, 0.0), (), p)
        read = loop.part("air_data")(0.0, tuple(x), env, p)
        air = x[6:9] - turned(x, np.array([7.0, -11.0, 4.0]))
        errors = (BIAS["dx"], BIAS["dy"], BIAS["dz"], 0.0, 0.0, BIAS["dpsi"])
        assert read[:6] == pytest.approx(x[:6] + errors)
        assert read[6:] == pytest.approx([air[0] + BIAS["du"], *air[1:], *x[9:]])


def test_a_heading_error_in_wind_does_not_change_the_airspeed_that_is_held() -> None:
    wind = {"component": "steady_wind", "parameters": {"x": 0.0, "y": 6.0}}
    ends = []
    for dpsi in (0.0, 0.5):
        problem = in_wind(
            environment=[wind], faults=[{"component": "navigation_bias", "parameters": {"dpsi": dpsi}}], horizon=60.0
        )
        end = flight(problem)[-1]
        ends.append(np.linalg.norm(end[6:9] - turned(end, np.array([0.0, 6.0, 0.0]))))
    assert ends[1] == pytest.approx(ends[0], abs=0.02)


def gust(horizon: float, **values: float) -> Problem:
    return in_wind(environment=[{"component": "discrete_gust", "parameters": values}], horizon=horizon)


def test_a_gust_across_leaves_the_envelope_by_its_sideslip() -> None:
    problem = gust(3.0, y=22.0, at=0.5, rise=0.3, hold=2.0)
    batch, reasons = problem.system.simulate_vectors(problem.vector({})[None])
    assert batch.status[0] == FAILED
    assert aircraft.LIMITS[3].text in reasons[0]
    assert all("through the air" in limit.text for limit in aircraft.LIMITS[2:6])


def test_an_aircraft_that_stands_over_ground_in_a_headwind_flies() -> None:
    problem = gust(45.0, x=-18.5, rise=20.0, hold=100.0)
    north = {"start.psi": 0.0, "goal.heading": 0.0}
    batch, reasons = problem.system.simulate_vectors(problem.vector(north)[None])
    assert batch.status[0] == OK, reasons
    assert flight(problem, north)[:, 6].min() < 3.0
