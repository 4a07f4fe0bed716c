"""What is lowest between two steps is found: within the first and the last one, beside thin obstacles, at corners.

A vehicle drifts along the x axis; expected values are those of straight lines.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from clearance.testing.problems import Problem
from tests.physics.drifting import AVOIDER, CONTROLLER, PLANAR_AVOIDER, PLANAR_VEHICLE, VEHICLE
from tests.physics.scenes import uncompiled
from worker.engine.kernels.layout import Parts
from worker.engine.systems.closed_loop.assemble import Loop
from worker.engine.systems.closed_loop.trace import trace
from worker.running.catalogue.installed import components

SPEED, STEP = 20.0, 0.05
LENGTH = SPEED * STEP
"""The distance between two steps [m]."""
PHASES = pytest.mark.parametrize("phase", np.linspace(0.0, 1.0, 6).tolist())
EITHER_END = pytest.mark.parametrize("x", [0.2, 0.45, 19.55, 19.8])
"""Within the first or the last half step of a flight over 20 m."""


def lowest(criterion: str, obstacle: str, horizon: float = 1.0, threshold: float = -1e3, **given: Any) -> float:
    """The value of a criterion of one flight past one obstacle, or of a vehicle that stands with vx=0."""
    known: Any = components()
    beside = known["obstacle", obstacle]
    vehicle, avoider = (VEHICLE, AVOIDER) if beside.dimension == 3 else (PLANAR_VEHICLE, PLANAR_AVOIDER)
    parts = Parts(vehicle, CONTROLLER, avoider, (beside,), known["criterion", criterion])
    loop = Loop(parts, lanes=1, compiled=False)
    values = {"vehicle.vx": given.pop("vx", SPEED), "criterion.threshold": threshold}
    values |= {f"obstacles.0.{name.replace('__', '.')}": value for name, value in given.items()}
    defaults = {f"{s.prefix}.{p.name}": p.default for s in loop.sections for p in s.parameters}
    assert values.keys() <= defaults.keys()
    result = loop.simulate(np.array([list((defaults | values).values())], dtype=float), STEP, round(horizon / STEP))
    assert result.status[0] == 0.0
    return float(result.costs[0, 0])


@EITHER_END
def test_the_closest_point_is_found_within_the_first_and_the_last_step(x: float) -> None:
    place = {"position__x": x, "position__y": 1.0, "position__z": 0.0}
    assert lowest("separation", "sphere", threshold=0.1, **place) == pytest.approx(1.0, abs=1e-9)
    assert lowest("surface_separation", "sphere", radius=0.4, **place) == pytest.approx(0.6, abs=1e-4)


def test_nothing_is_extrapolated_beyond_either_end() -> None:
    for x, expected in ((-0.3, math.hypot(0.3, 1.0)), (20.4, math.hypot(0.4, 1.0))):
        found = lowest("separation", "sphere", threshold=0.1, position__x=x, position__y=1.0, position__z=0.0)
        assert found == pytest.approx(expected, abs=1e-12)


@PHASES
def test_no_obstacle_is_too_thin_to_be_seen(phase: float) -> None:
    place = {"position__x": 10.0 + phase * LENGTH, "position__y": 0.0, "position__z": 0.0}
    within = 1e-4 * LENGTH
    for name, own, expected in (
        ("sphere", {"radius": 0.3}, -0.3),
        ("cylinder", {"radius": 0.2, "height": 10.0}, -0.2),
        ("box_3d", {"length": 0.02, "width": 20.0, "height": 20.0}, -0.01),
        ("box_3d", {"length": 20.0, "width": 0.02, "height": 20.0, "angle": math.pi / 2}, -0.01),
    ):
        assert lowest("surface_separation", name, **place, **own) == pytest.approx(expected, abs=within), name


@PHASES
@pytest.mark.parametrize("aside", [0.05, 0.3, 0.7, 1.5])
def test_the_distance_to_a_round_surface_is_that_of_a_straight_line(phase: float, aside: float) -> None:
    place = {"position__x": 10.0 + phase * LENGTH, "position__y": aside, "position__z": 0.0}
    found = lowest("surface_separation", "sphere", radius=0.3, **place)
    assert found == pytest.approx(aside - 0.3, abs=1e-4 * LENGTH)


@PHASES
@pytest.mark.parametrize("criterion", ["separation", "surface_separation"])
def test_an_obstacle_that_turns_back_within_a_step_has_been_where_it_turned(phase: float, criterion: str) -> None:
    way = {
        "position__x": 5.0 + phase * LENGTH,
        "waypoint1__x": 1.0,
        "waypoint2__x": 10.0,
        "legs": 2.0,
        "speed": SPEED,
        "radius": 0.5,
    }
    level = {f"{point}__{axis}": 0.0 for point in ("position", "waypoint1", "waypoint2") for axis in "yz"}
    found = lowest(
        criterion, "waypoint_sphere", vx=0.0, threshold=-1e3 if "surface" in criterion else 0.1, **way, **level
    )
    assert found == pytest.approx(0.5 if "surface" in criterion else 1.0, abs=1e-4 * LENGTH)


@PHASES
@pytest.mark.parametrize("vx", [0.0, 1.0, -3.0])
@pytest.mark.parametrize("criterion", ["separation", "surface_separation"])
def test_an_obstacle_that_stops_within_a_step_has_been_where_it_stops(phase: float, vx: float, criterion: str) -> None:
    """It follows the vehicle and stops 2 m behind it, or passes the place at which it ends."""
    speed, distance = 10.0, 2.0
    until = 0.5 + phase * STEP
    goal = vx * until - distance
    way = {"position__x": goal - speed * until, "goal__x": goal, "speed": speed, "radius": 0.5}
    level = {"position__y": 0.0, "goal__y": 0.0}
    found = lowest(criterion, "moving_circle", vx=vx, threshold=-1e3 if "surface" in criterion else 0.1, **way, **level)
    times = np.linspace(0.0, 1.0, 100_001)
    away = np.abs(vx * times - np.minimum(way["position__x"] + speed * times, goal))
    assert found == pytest.approx(away.min() - (0.5 if "surface" in criterion else 0.0), abs=1e-3 * speed * STEP)


def test_only_the_steps_about_a_stop_are_searched() -> None:
    """Elsewhere it is the parabola that gives a distance: what has been evaluated keeps its bits."""
    past = {"position__x": 4.0, "position__y": 1.0, "goal__y": 1.0, "speed": 1.0}
    expected = lowest("separation", "moving_circle", threshold=0.1, goal__x=400.0, **past)
    assert lowest("separation", "moving_circle", threshold=0.1, goal__x=4.9, **past) == expected
    assert expected == pytest.approx(1.0, abs=1e-5)


def test_every_obstacle_on_one_leg_states_when_it_ends() -> None:
    """Without it the distances from it are searched at every step."""
    known: Any = components()
    for (kind, name), component in known.items():
        if kind == "obstacle" and component.rate is not None and len(component.rate.legs) == 2:
            assert component.rate.stops in component.derived.constants._fields, name


def wall(**criterion: Any) -> Problem:
    """A robot without avoidance that drives through a wall of 2 cm within one step."""
    document = load_file(library()["unicycle_static"]).document()
    document["scenario"]["avoider"]["parameters"] |= {"k_rep": 0.0}
    document["scenario"] |= {"start": {"x": 2.6, "y": 3.0, "theta": 0.8, "v": 0.4}, "horizon": 2.5}
    parameters = {"position.x": 9.0, "position.y": 3.5, "length": 16.0, "width": 0.02}
    document["scenario"]["obstacles"] = [{"component": "box", "parameters": parameters}]
    named = {"component": "surface_separation", "threshold": 0.0, **criterion}
    return uncompiled(load_document(document | {"criterion": named}))


def test_the_closest_approach_of_a_trace_lies_in_the_wall_that_the_cost_is_of() -> None:
    flight = trace(wall().system, "nominal", {})
    closest = flight.meta.closest
    assert closest is not None
    assert closest.value == flight.meta.cost == pytest.approx(-0.01, abs=1e-4)
    assert closest.position[1] == pytest.approx(3.5, abs=1e-3), "the middle of the wall"
    assert flight.data[closest.row, 0] <= closest.time <= flight.data[closest.row + 1, 0]


def test_a_flight_has_the_same_bits_in_a_batch_and_alone() -> None:
    flights = wall().system
    loop = Loop(flights.parts, lanes=4)
    rows = np.tile(flights.nominal, (9, 1))
    chance = np.random.default_rng(3)
    for name, low, high in (("position.y", 3.1, 3.7), ("width", 0.01, 0.3), ("angle", -1.0, 1.0)):
        rows[:, flights.paths[f"obstacles.0.{name}"]] = chance.uniform(low, high, 9)
    rows[:, flights.paths["criterion.threshold"]] = -1e3
    steps = round(2.5 / flights.step)
    together = loop.simulate(rows, flights.step, steps).costs
    alone = np.concatenate([loop.simulate(row[None], flights.step, steps).costs for row in rows])
    assert np.array_equal(together, alone)
    assert len(np.unique(together)) == len(together)
    assert together == pytest.approx(flights.loop.simulate(rows, flights.step, steps).costs, abs=1e-9)
