"""Every parameter that is rounded acts as the nearest whole number, halfway as one of the two."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import library, load_file
from clearance.testing.problems import Problem
from tests.physics.in_space import OBSTACLES
from tests.physics.scenes import changed, flight, uncompiled
from worker.engine.kernels.parameters import declared
from worker.running.catalogue.installed import components

PLANAR = {"position.x": 6.0, "position.y": 1.0, "waypoint1.x": 4.0, "waypoint1.y": 1.0, "waypoint2.x": 4.0,
    "waypoint2.y": 2.0, "waypoint3.x": 5.0, "waypoint3.y": 2.0, "waypoint4.x": 5.0, "waypoint4.y": 9.0}  # fmt: skip
SPATIAL = OBSTACLES["waypoint_sphere"] | {"waypoint3.x": 300.0, "waypoint4.y": 100.0, "speed": 60.0}
SCENES: dict[str, tuple[str, dict[str, Any]]] = {
    "gnron": ("unicycle_static", {"avoider": {"component": "gnron"}}),
    "gnron_3d": ("uav_static", {"avoider": {"component": "gnron_3d", "parameters": {"d_0": 300.0}}}),
    "minimum_deviation_3d": (
        "uav_aca",
        {
            "avoider": {"component": "minimum_deviation_3d", "parameters": {"range": 1e4, "instant": 1.0}},
            "horizon": 30.0,
        },
    ),
    "right_of_way_3d": ("uav_aca_right_of_way", {}),
    "waypoint_circle": ("unicycle_static", {"obstacles": [{"component": "waypoint_circle", "parameters": PLANAR}]}),
    "waypoint_sphere": ("uav_aca", {"obstacles": [{"component": "waypoint_sphere", "parameters": SPATIAL}]}),
}
"""The component in a flight in which the parameter has an effect."""
ROUNDED = [
    (c, p)
    for c in components().values()
    if c.role != "vehicle" and c.role != "controller"
    for p in declared(c.parameters)
    if "rounded" in p.text
]


def seen_and_demanded(problem: Problem, states: Any, values: dict[str, float]) -> list[Any]:
    """What the avoider sees and demands along the same states."""
    loop = problem.system.loop
    p, g = loop.extend(problem.vector(values)), loop.part("initial_guidance")(problem.vector(values))
    found: list[Any] = []
    for k in range(0, len(states), 50):
        t, x = k * problem.system.step, tuple(states[k, : loop.n_state].tolist())
        g = loop.part("guide")(t, x, g, p)
        found.append((g, loop.part("measurements")(t, x, p)[-1]))
    return found


BY_DAY = {"waypoint_sphere-legs", "gnron_3d-n", "right_of_way_3d-instant", "minimum_deviation_3d-gate"}
"""Each kind of parameter once; the others are those of the plane, or the same by another name."""
SOME = [
    pytest.param(c, p, id=name, marks=() if name in BY_DAY else pytest.mark.nightly)
    for c, p in ROUNDED
    for name in [f"{c.name}-{p.name}"]
]


@pytest.mark.parametrize(("component", "parameter"), SOME)
def test_between_whole_numbers_it_is_the_nearest(component: Any, parameter: Any) -> None:
    name, scenario = SCENES[component.name]
    problem = uncompiled(changed(load_file(library()[name]), **({"horizon": 16.0} | scenario)))
    path = f"{'obstacles.0' if component.role == 'obstacle' else 'avoider'}.{parameter.name}"
    states, numbers = flight(problem), range(int(parameter.low), int(parameter.high) + 1)

    def effect(value: float) -> list[Any]:
        return seen_and_demanded(problem, states, {path: value})

    effects = [effect(float(number)) for number in numbers]
    for number, below, above in zip(numbers, effects, effects[1:], strict=False):
        assert effect(number + 0.3) == effect(number + 0.49) == below
        assert effect(number + 0.51) == above
        assert effect(number + 0.5) in (below, above)
    assert len(set(map(str, effects))) > 1, "it has no effect in this scene"


def test_those_that_are_rounded() -> None:
    assert {p.name for _, p in ROUNDED} == {"n", "side", "gate", "instant", "legs"}
