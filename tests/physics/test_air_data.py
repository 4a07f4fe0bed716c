"""Vehicles that fly relative to the air: the limits of the flow and the air data, whatever wind and navigation are.

Second formulation: velocities through the air by SciPy's rotations.
"""

from __future__ import annotations

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
