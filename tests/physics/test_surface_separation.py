"""The distance to surfaces: closed forms along straight paths, sign, and extents of obstacles."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from clearance.testing.problems import Problem
from tests.given.at_night import nightly_but
from tests.physics.bodies import OBSTACLES, _body, centre
from tests.physics.drifting import AVOIDER, CONTROLLER, VEHICLE
from tests.physics.scenes import cost, uncompiled
from worker.engine.kernels.component import Obstacle, declared
from worker.engine.kernels.layout import Parts
from worker.engine.reference.reference import Reference
from worker.engine.systems.closed_loop.assemble import Loop
from worker.engine.systems.closed_loop.trace import trace
from worker.running.catalogue.installed import catalogue, components

EACH = pytest.mark.parametrize("obstacle", OBSTACLES, ids=lambda o: o.name)
SPHERE = {"position.x": 5.0037, "position.y": 2.0, "position.z": 1.0, "radius": 0.5}
CYLINDER = {"position.x": 5.0, "position.y": 3.0, "position.z": 0.0, "radius": 1.0, "height": 4.0}
BOX = {"position.x": 5.0, "position.y": 0.0, "position.z": 3.0, "length": 2.0, "width": 8.0, "height": 2.0}


def nearest(*obstacles: tuple[str, dict[str, float]], step: float = 0.01, body: float = 0.0, **given: float) -> float:
    """c_min of a straight path along the x axis from 0 to 10 m, at 1 m/s unless `given` says otherwise."""
    known: Any = components()
    bodies = tuple(known["obstacle", name] for name, _ in obstacles)
    parts = Parts(VEHICLE, CONTROLLER, AVOIDER, bodies, known["criterion", "surface_separation"])
    loop = Loop(parts, lanes=1, compiled=False)
    values = {"criterion.threshold": -1e3, "criterion.body_radius": body} | given
    values |= {f"obstacles.{i}.{name}": v for i, (_, own) in enumerate(obstacles) for name, v in own.items()}
    defaults = {f"{s.prefix}.{p.name}": p.default for s in loop.sections for p in s.parameters}
    assert values.keys() <= defaults.keys()
    result = loop.simulate(np.array([list((defaults | values).values())], dtype=float), step, round(10.0 / step))
    assert result.status[0] == 0.0
    return float(result.costs[0, 0])


@pytest.mark.by_day(3)
@pytest.mark.parametrize(
    ("name", "own", "expected"),
    [
        ("sphere", SPHERE, math.sqrt(5.0) - 0.5),
        ("sphere", SPHERE | {"radius": 3.0}, math.sqrt(5.0) - 3.0),
        ("cylinder", CYLINDER, 2.0),
        ("cylinder", CYLINDER | {"position.z": 6.0}, math.hypot(2.0, 4.0)),
        ("cylinder", CYLINDER | {"position.y": 0.25}, -0.75),
        ("box_3d", BOX, 2.0),
        ("box_3d", BOX | {"position.y": 7.0}, math.hypot(3.0, 2.0)),
        ("box_3d", BOX | {"position.z": 0.4}, -0.6),
        ("box_3d", BOX | {"position.y": 7.0, "angle": math.pi / 2}, math.hypot(6.0, 2.0)),
    ],
)
def test_straight_past_it_is_the_distance_to_the_nearest_surface(name: str, own: Any, expected: float) -> None:
    # Inside a box the distance has ridges, where the parabola is lower by up to an eighth of the distance per step.
    assert nearest((name, own)) == pytest.approx(expected, abs=2e-5 if expected > 0 else 0.01 / 8 + 2e-5)


def test_between_the_steps_it_is_refined() -> None:
    """At the steps alone a step of 0.2 m past a point 1 m away would be up to 5e-3 m too far."""
    for x in (5.0, 5.02, 5.07, 5.1):
        own = {"position.x": x, "position.y": 1.0, "position.z": 0.0, "radius": 0.3}
        assert nearest(("sphere", own), step=0.2) == pytest.approx(0.7, abs=2e-4)


def test_the_body_of_the_vehicle_and_the_nearest_of_several_count() -> None:
    one = nearest(("sphere", SPHERE))
    assert nearest(("sphere", SPHERE), body=0.25) == pytest.approx(one - 0.25, abs=1e-12)
    assert nearest(("box_3d", BOX), ("sphere", SPHERE), ("cylinder", CYLINDER)) == one


def test_an_intruder_met_head_on_is_measured_where_it_is() -> None:
    own = {"position.x": 10.0, "position.y": 1.5, "position.z": 0.0, "speed": 1.0, "heading": math.pi, "radius": 0.5}
    assert nearest(("moving_sphere", own)) == pytest.approx(1.0, abs=1e-6)


def drawn(obstacle: Obstacle, seed: int) -> dict[str, float]:
    """Sizes and angles at random."""
    chance = np.random.default_rng(seed)
    sizes = {
        "radius": (0.2, 3.0),
        "length": (0.5, 9.0),
        "width": (0.1, 4.0),
        "height": (0.5, 9.0),
        "angle": (-3.0, 3.0),
    }
    known = {p.field for p in declared(obstacle.parameters)}
    return {name: float(chance.uniform(*sizes[name])) for name in sizes if name in known}


@pytest.mark.by_day(5)
@EACH
@pytest.mark.parametrize("seed", nightly_but((1,), [1, 2]))
def test_it_is_a_signed_distance_and_inside_is_within_the_declared_reach(obstacle: Obstacle, seed: int) -> None:
    given, n = drawn(obstacle, seed), obstacle.dimension
    at = _body(obstacle, given)
    entry = catalogue().component("obstacle", obstacle.name)
    assert entry is not None
    assert entry.reach is not None
    reach = entry.reach.times * math.hypot(*(given[name] for name in entry.reach.of))
    middle = centre(at(0.3, (0.0,) * n), n)
    chance = np.random.default_rng(seed)
    farthest = 0.0
    for q in middle + chance.uniform(-1.0, 1.0, (400, n)) * reach * 1.2:
        here = at(0.3, tuple(q))
        to = q + chance.normal(size=n) * reach * 0.1
        there = at(0.3, tuple(to))
        assert abs(here.gap - there.gap) <= float(np.linalg.norm(to - q)) + 1e-9, "no distance changes faster"
        away = float(np.linalg.norm(q - centre(here, n)))
        assert away - here.gap <= reach + 1e-9
        farthest = max(farthest, away - here.gap)
    assert farthest >= 0.75 * reach, "a reach that nothing comes near refuses campaigns for nothing"


@EACH
def test_it_is_the_same_from_every_side_that_looks_the_same(obstacle: Obstacle) -> None:
    at, n = _body(obstacle, {}), obstacle.dimension
    middle = centre(at(0.3, (0.0,) * n), n)
    for offset in np.random.default_rng(4).normal(size=(20, n)) * 5.0:
        if obstacle.name == "cylinder":  # its centre is the nearest point of the axis
            middle[2] = 3.8
        assert at(0.3, tuple(middle + offset)).gap == pytest.approx(at(0.3, tuple(middle - offset)).gap, abs=1e-9)


def wall(criterion: dict[str, Any]) -> Problem:
    """A robot without avoidance whose straight path crosses a long thin wall."""
    document = load_file(library()["unicycle_static"]).document()
    document["scenario"]["avoider"]["parameters"] |= {"k_rep": 0.0}
    document["scenario"] |= {"start": {"x": 2.6, "y": 3.0, "theta": 0.8, "v": 0.4}, "horizon": 2.5}
    parameters = {"position.x": 9.0, "position.y": 3.5, "length": 16.0, "width": 0.2}
    document["scenario"]["obstacles"] = [{"component": "box", "parameters": parameters}]
    return uncompiled(load_document(document | {"criterion": criterion}))


def test_a_path_through_a_wall_is_not_clear() -> None:
    centres = wall({"component": "separation", "threshold": 0.5, "from_centre": True})
    assert cost(centres) > 4.0
    surfaces = wall({"component": "surface_separation", "threshold": 0.0})
    assert cost(surfaces) == pytest.approx(-0.1, abs=2e-3)
    flight = Reference(surfaces.system).simulate(surfaces.system.nominal)
    assert flight.cost == pytest.approx(-0.1, abs=2e-3)


def test_a_trace_states_the_protected_volume_and_its_closest_approach_has_the_cost() -> None:
    surfaces = wall({"component": "surface_separation", "threshold": 0.0})
    flight = trace(surfaces.system, "nominal", {})
    assert flight.meta.obstacles[0].free_radius is None, "no disc"
    assert flight.meta.closest is not None
    assert flight.meta.closest.value == pytest.approx(flight.meta.cost, abs=1e-9)
    centres = wall({"component": "separation", "threshold": 0.5, "from_centre": True})
    assert trace(centres.system, "nominal", {}).meta.obstacles[0].free_radius == 0.5
    criterion = {"component": "surface_separation", "threshold": 0.3, "parameters": {"body_radius": 0.2}}
    document = load_file(library()["unicycle_static"]).document() | {"criterion": criterion}
    document["scenario"]["horizon"] = 0.1
    free = trace(uncompiled(load_document(document)).system, "nominal", {}).meta.obstacles[0].free_radius
    assert free == pytest.approx(0.5 + 0.3 + 0.2)
