"""The deciding criterion along straight lines after the last sample: the vehicle is moved, and the bodies are asked."""

from __future__ import annotations

import math
from functools import cache
from itertools import product
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.results.validate import Beyond
from clearance.testing.problems import Problem
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import document as case1
from worker.engine.components.obstacles import circle
from worker.engine.kernels.component import Obstacle, Parameter, Rate, Reach
from worker.engine.kernels.maths import clip, kernel, norm2, sincos
from worker.engine.kernels.views import Body
from worker.engine.systems import optional
from worker.engine.systems.closed_loop import beyond
from worker.engine.systems.closed_loop.ahead import Ahead, Leg
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.parts import Installed
from worker.engine.systems.closed_loop.trace import Seen
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import catalogue, components

Points = np.ndarray[Any, np.dtype[np.float64]]
MIDDLE = (400.0, -300.0, -900.0)
SHAPES: dict[str, dict[str, float]] = {
    "circle": {"radius": 7.0},
    "box": {"length": 60.0, "width": 0.5, "angle": 0.4},
    "sphere": {"radius": 7.0},
    "cylinder": {"radius": 5.0, "height": 300.0},
    "box_3d": {"length": 3.0, "width": 80.0, "height": 200.0, "angle": -0.7},
}
SOLID = ("sphere", "cylinder", "box_3d")
CRITERIA = ("separation", "surface_separation")


def slabs(outside: Points) -> Points:
    """The distance to a box, negative inside, from those outside each of its slabs (n, axes)."""
    return np.linalg.norm(np.maximum(outside, 0.0), axis=1) + np.minimum(outside.max(axis=1), 0.0)


def truth(shape: str, criterion: str, q: Points) -> Points:
    """The distances of points (n, axes) to a shape by its definition."""
    own, away = SHAPES[shape], q - np.array(MIDDLE[: q.shape[1]])
    if shape == "cylinder":
        flat, beyond = np.linalg.norm(away[:, :2], axis=1), np.abs(away[:, 2]) - 0.5 * own["height"]
        if criterion == "separation":
            return np.hypot(flat, np.maximum(beyond, 0.0))
        return slabs(np.stack([flat - own["radius"], beyond], axis=1))
    if criterion == "separation":
        return np.linalg.norm(away, axis=1)
    if "radius" in own:
        return np.linalg.norm(away, axis=1) - own["radius"]
    c, s = math.cos(own["angle"]), math.sin(own["angle"])
    turned = np.array(away)
    turned[:, 0], turned[:, 1] = away[:, 0] * c + away[:, 1] * s, away[:, 1] * c - away[:, 0] * s
    sides = [own[name] for name in ("length", "width", "height") if name in own]
    return slabs(np.abs(turned) - 0.5 * np.array(sides))


@cache
def flight(shape: str, criterion: str) -> tuple[Ahead, int]:
    """A flight that has only begun, and its number of axes."""
    made = load_file(library()["uav_static"]).document() if shape in SOLID else case1()
    axes = 3 if shape in SOLID else 2
    position = dict(zip("xyz"[:axes], MIDDLE, strict=False))
    scenario = made["scenario"]
    scenario["obstacles"].append({"component": shape, "parameters": {"position": position, **SHAPES[shape]}})
    scenario |= {"horizon": 100.0}
    made["criterion"] = {"component": criterion, "threshold": 0.1}
    if criterion == "separation":
        made["criterion"]["from_centre"] = True
    problem = Problem(load_document(made), compiled=False)
    system: Any = problem.system
    row = problem.vectors(problem.nominal_point[None, :])[0]
    states = system.loop.simulate(row[None, :], system.step, 1, 1, traced=1).trace[0]
    seen = Seen(system, system.loop.observe(states, row, system.step), row)
    return Ahead(system, row, states[1], seen, system.step), axes


@pytest.mark.by_day(8)
@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("seed", nightly_but(range(20), range(3)))
def test_the_lowest_value_on_a_line_is_that_of_the_shape(shape: str, criterion: str, seed: int) -> None:
    """Level, climbing and descending lines that meet the shape, pass it, or end before it."""
    ahead, axes = flight(shape, criterion)
    random = np.random.default_rng(seed)
    aim = np.array(MIDDLE) + random.normal(0.0, (2.0, 40.0, 100.0)[seed % 3], 3)
    begin, velocity = aim + random.uniform(-800.0, 800.0, 3), np.zeros(3)
    velocity[:axes] = (aim - begin)[:axes] / (130.0 if seed % 5 == 4 else 60.0)
    begin[axes:] = 0.0
    lowest, time = ahead.lowest(1, Leg(0.0, 100.0, begin, velocity))
    times = np.linspace(0.0, 100.0, 100_001)
    values = truth(shape, criterion, (begin + times[:, None] * velocity)[:, :axes])
    least = float(np.linalg.norm(velocity)) * 100.0 / 100_000
    assert lowest <= values.min() + 1e-9
    assert lowest >= values.min() - least
    assert 0.0 <= time <= 100.0 + 1e-9
    at = truth(shape, criterion, (begin + time * velocity)[None, :axes])
    assert lowest == pytest.approx(float(at[0]), abs=1e-6)


STEP, HORIZON, AFTER = 0.05, 9.0, 8.0
"""The obstacle is met `AFTER` s past the last sample, which is one of twice the horizon."""


def glide(goal: float, obstacles: list[dict[str, Any]], criterion: str) -> Problem:
    """An aircraft that goes for a goal far away, below or above it, and sees no obstacle after the horizon."""
    made = load_file(library()["uav_static"]).document()
    scenario = made["scenario"]
    scenario["goal"] = {"x": 5489.0, "y": 5818.0, "z": goal}
    scenario |= {"horizon": HORIZON, "step": STEP, "obstacles": scenario["obstacles"][:1] + obstacles}
    scenario["faults"] = [{"component": "blackout", "parameters": {"at": 0.0, "duration": 1e4}}]
    made["criterion"] = {"component": criterion, "threshold": 2.0}
    if criterion == "separation":
        made["criterion"]["from_centre"] = True
    return Problem(load_document(made), compiled=False)


def tower(x: float, y: float, z: float) -> dict[str, Any]:
    position = {"x": x, "y": y, "z": z}
    return {"component": "cylinder", "parameters": {"position": position, "radius": 20.0, "height": 600.0}}


def met(made: Problem) -> tuple[Beyond, Seen]:
    """What the nominal flight meets, and its last two samples at twice the horizon."""
    system: Any = made.system
    vector = made.vectors(made.nominal_point[None, :])
    steps, every = system.counts(STEP)
    states = system.loop.simulate(vector, STEP, 2 * steps, every, traced=1).trace[0][-2:]
    seen = Seen(system, system.loop.observe(states, vector[0], STEP, 2 * steps - 1), vector[0])
    found = optional.beyond(system, ["nominal"], vector, [None], 15.0, lambda: False)
    assert found is not None
    return found, seen


@pytest.mark.by_day(1)
@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("goal", [1780.0, -1780.0])
def test_an_aircraft_that_descends_or_climbs_to_the_height_of_a_cylinder_meets_it(goal: float, criterion: str) -> None:
    """Its top is below the aircraft at the last sample, or its bottom above: the nearest point of its axis moves."""
    _, seen = met(glide(goal, [], criterion))
    here, velocity = seen.positions[1], (seen.positions[1] - seen.positions[0]) / STEP
    away = math.copysign(302.0, goal)
    assert abs(velocity[2]) > 0.5
    assert velocity[2] * goal > 0.0
    x, y, _ = here + AFTER * velocity
    found, _ = met(glide(goal, [tower(x, y, here[2] + away)], criterion))
    assert (found.closer, found.unknown) == (1, None)
    assert found.lowest is not None
    assert not found.lowest.simulated
    assert found.lowest.obstacle == 1
    lowest = 0.0 if criterion == "separation" else -20.0
    assert found.lowest.value == pytest.approx(max(lowest, -AFTER * abs(velocity[2]) + 2.0), abs=0.5)
    assert found.lowest.time == pytest.approx(HORIZON + AFTER, abs=0.5)
    missed, _ = met(glide(goal, [tower(x, y, here[2] - away)], criterion))
    assert missed.closer == 0
    assert missed.unknown is not None
    assert missed.unknown.goal is not None  # it is under way to its goal


class Bar(NamedTuple):
    x: Annotated[float, Parameter("m", "Middle, x", -1e6, 1e6)]
    y: Annotated[float, Parameter("m", "Middle, y", -1e6, 1e6)]
    v: Annotated[float, Parameter("m/s", "Velocity, along x", -1e3, 1e3)] = 0.0
    way: Annotated[float, Parameter("m", "Radius of its path", 0.0, 1e5)] = 0.0
    turn: Annotated[float, Parameter("rad/s", "Rate on its path", 0.0, 1e3)] = 0.0
    half: Annotated[float, Parameter("m", "Half of its length, along y", 0.0, 1e5)] = 12.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5)] = 0.2


@kernel
def leaning(t: float, o: tuple[()], q: tuple[float, float], p: Bar) -> Body:
    """Its centre is the nearest point of its axis, as that of a cylinder is."""
    s, c = sincos(p.turn * t)
    x, middle = p.x + p.v * t + p.way * c, p.y + p.way * s
    y = middle + clip(q[1] - middle, -p.half, p.half)
    d = norm2(q[0] - x, q[1] - y)
    return Body(x, y, p.v, 0.0, p.radius, d - p.radius, (q[0] - x) / (d + 1e-12), (q[1] - y) / (d + 1e-12))


@kernel
def plain(t: float, o: tuple[()], q: tuple[float, float], p: Bar) -> Body:
    """Its centre is its middle, and it extends much farther in one direction than in the other."""
    s, c = sincos(p.turn * t)
    shown = leaning(t, o, q, p)
    return Body(p.x + p.v * t + p.way * c, p.y + p.way * s, p.v, 0.0, p.half, shown.gap, shown.nx, shown.ny)


BODIES = {"leaning": (leaning, Reach(("radius",))), "plain": (plain, None)}
MOTIONS: dict[str, tuple[Rate | None, dict[str, float]]] = {
    "at rest": (None, {"x": 5.0}),
    "towards it": (Rate(times=0.0), {"x": 12.0, "v": -0.2}),
    "behind it, and slower": (Rate(times=0.0), {"x": -8.0, "v": 0.3}),
    "turning": (Rate(("turn",)), {"x": 7.0, "way": 4.0, "turn": 0.3}),
}
"""Where the bar is relative to the vehicle at the last sample, by what the vehicle covers in a second."""
END, EACH = 5.0, 0.02


def among(entry: Obstacle, values: dict[str, float], criterion: str) -> Flights:
    """The unicycle, which sees no obstacle, with a bar."""
    known: Any = catalogue()
    described = known.model_copy(update={"components": [*known.components, component_entry(entry, circle)]})
    made = case1(scenario__horizon=END, scenario__goal={"x": 60.0, "y": 8.0}, scenario__step=EACH)
    made["scenario"]["guidance"] = {"period": EACH}
    made["scenario"]["vehicle"]["parameters"] = {"J": 0.5}  # stable with that step
    made["stages"]["search"] = [{"method": "direct", "evaluations": 50}]
    made["scenario"]["obstacles"].append({"component": "bar", "parameters": values})
    made["scenario"]["faults"] = [{"component": "blackout", "parameters": {"at": 0.0, "duration": 1e4}}]
    made["criterion"] = {"component": criterion, "threshold": 0.1}
    if criterion == "separation":
        made["criterion"]["from_centre"] = True
    return Flights(
        load_document(made), Installed(components() | {("obstacle", "bar"): entry}, described), compiled=False, lanes=1
    )


@cache
def last(criterion: str) -> tuple[Points, Points]:
    """Position and velocity of the nominal flight at twice the horizon, where the bar is far away."""
    flights = among(Obstacle("bar", "Bar", 2, Bar, leaning), {"x": 1e5, "y": 0.0}, criterion)
    row, (steps, every) = flights.vector({}), flights.counts(EACH)
    states = flights.loop.simulate(row[None, :], EACH, 2 * steps, every, traced=1).trace[0]
    positions = Seen(flights, flights.loop.observe(states[-2:], row, EACH, 2 * steps - 1), row).positions[:, :2]
    return positions[1], (positions[1] - positions[0]) / EACH


@pytest.mark.by_day(3)
@pytest.mark.parametrize(("body", "moves", "criterion"), [*product(BODIES, MOTIONS, CRITERIA)])
def test_an_obstacle_of_ones_own_is_met_as_its_body_shows_it(body: str, moves: str, criterion: str) -> None:
    """Its extent is not declared, or its centre depends on the place from which it is seen."""
    (function, reach), (rate, by) = BODIES[body], MOTIONS[moves]
    own = Obstacle("bar", "Bar", 2, Bar, function, reach=reach, rate=rate)
    if rate is None:
        object.__setattr__(own, "moving", False)  # it reads the time, at which it is where it was
    here, velocity = last(criterion)
    speed = float(np.linalg.norm(velocity))
    values = {name: by[name] * speed for name in ("v", "way") if name in by} | {"turn": by.get("turn", 0.0)}
    place = here + by["x"] * velocity
    values |= {"x": float(place[0]) - 2.0 * END * values.get("v", 0.0), "y": float(place[1]) + 3.0}
    flights = among(own, values, criterion)
    lowest, p = math.inf, Bar(**values)
    for v, after in product(
        (0.0 * velocity, velocity), np.arange(0.0, 2.0 * math.pi / p.turn if p.turn else 60.0, 1e-2)
    ):
        q = here + min(after, END) * v
        shown = function(2.0 * END + after, (), (float(q[0]), float(q[1])), p)
        lowest = min(lowest, shown.gap if criterion == "surface_separation" else math.dist(q, (shown.x, shown.y)))
    found = beyond.met(flights, ["nominal"], flights.vector({})[None, :], [None], lowest + 1e-3, lambda: False)
    assert found is not None
    assert found.unknown is None
    assert found.lowest is not None
    assert found.lowest.obstacle == 1
    assert lowest - 0.1 <= found.lowest.value <= lowest + 1e-6
