"""Obstacles whose motion is not what their component declares, or begins late: nothing is taken as known about them."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Any, NamedTuple

import pytest

from tests.unit.engine.systems.test_beyond import GOAL, HORIZON, beyond, place
from worker.engine.kernels.component import Obstacle, Parameter, Rate, Reach
from worker.engine.kernels.maths import kernel, norm2, sincos
from worker.engine.kernels.views import Body
from worker.engine.physics.shapes import outward, rectangle
from worker.engine.physics.vectors import round_body
from worker.engine.systems.closed_loop.parts import Installed
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import components, installed, source_of
from worker.running.opening import opened

LATE = 7.7 * HORIZON
NEVER = 1e6


class Train(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Start, x", -1e6, 1e6, name="position.x")]
    position_y: Annotated[float, Parameter("m", "Start, y", -1e6, 1e6, name="position.y")]
    goal_x: Annotated[float, Parameter("m", "Goal, x", -1e6, 1e6, name="goal.x")]
    goal_y: Annotated[float, Parameter("m", "Goal, y", -1e6, 1e6, name="goal.y")]
    speed: Annotated[float, Parameter("m/s", "Speed", 0.0, 1e3)] = 1.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e3)] = 0.1
    at: Annotated[float, Parameter("s", "Departure", -1e6, 1e6)] = 0.0
    back: Annotated[float, Parameter("s", "Departure from the goal", 0.0, 1e6)] = NEVER


@kernel
def train(t: float, o: tuple[()], q: Any, p: Train) -> Any:
    dx, dy = p.goal_x - p.position_x, p.goal_y - p.position_y
    takes = norm2(dx, dy) / (p.speed + 1e-12)
    there, returned = (t - p.at) / takes, (t - p.back) / takes
    there, returned = min(max(there, 0.0), 1.0), min(max(returned, 0.0), 1.0)
    along = there - returned
    return round_body((p.position_x + along * dx, p.position_y + along * dy), (0.0, 0.0), p.radius, q)


class Jib(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Pivot, x", -1e6, 1e6, name="position.x")]
    position_y: Annotated[float, Parameter("m", "Pivot, y", -1e6, 1e6, name="position.y")]
    radius: Annotated[float, Parameter("m", "Half the width", 1e-3, 1e5)] = 0.1
    length: Annotated[float, Parameter("m", "Length", 1e-3, 1e5)] = 12.0
    omega: Annotated[float, Parameter("rad/s", "Turn rate", -10.0, 10.0)] = 0.02
    at: Annotated[float, Parameter("s", "Start", 0.0, 1e6)] = 0.0


@kernel
def jib(t: float, o: tuple[()], q: Any, p: Jib) -> Any:
    sin, cos = sincos(p.omega * max(t - p.at, 0.0))
    dx, dy = q[0] - p.position_x, q[1] - p.position_y
    gap, nx, ny = rectangle(outward(dx * cos + dy * sin, 0.5 * p.length), outward(dy * cos - dx * sin, p.radius))
    return Body(p.position_x, p.position_y, 0.0, 0.0, 0.5 * p.length, gap, nx * cos - ny * sin, nx * sin + ny * cos)


LEGS = Rate(("speed",), legs=("position", "goal"))
TRAIN = Obstacle("train", "Train", 2, Train, train, moving=True, reach=Reach(("radius",)), rate=LEGS)
JIB = Obstacle("jib", "Jib", 2, Jib, jib, moving=True, reach=Reach(("length",), 0.52), rate=Rate(("omega",)))
ORBIT: Any = components()["obstacle", "orbiting_circle"]
CIRCLING = {"centre": place(40.0, 40.0), "way": 5.0, "speed": 1.0}
TO_GOAL = {"position": place(GOAL[0] + 6.0, GOAL[1]), "goal": place(GOAL[0] - 6.0, GOAL[1])}
AWAY = {"position": place(60.0, 7.0), "goal": place(90.0, 7.0)}


def known(
    monkeypatch: pytest.MonkeyPatch, obstacle: Obstacle, criterion: str = "separation", **parameters: Any
) -> bool:
    """Whether everything is known about this obstacle beyond the horizon."""
    own = dataclasses.replace(obstacle, name="own", title="Own")
    every, catalogue = components(), installed().catalogue
    entry = component_entry(own, source_of(ORBIT))
    made = Installed(
        {**every, ("obstacle", "own"): own}, catalogue.model_copy(update={"components": [*catalogue.components, entry]})
    )
    monkeypatch.setattr(opened, "installed", lambda: made)
    return beyond("own", criterion, **parameters).unknown is None


@pytest.mark.by_day(2)
@pytest.mark.parametrize("rate", [LEGS, Rate(("speed",), ("radius",)), Rate(("speed",))], ids=str)
@pytest.mark.parametrize("parameters", [TO_GOAL, AWAY], ids=["to the goal", "elsewhere"])
def test_an_obstacle_that_sets_off_later_is_unknown(
    rate: Rate, parameters: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not known(monkeypatch, dataclasses.replace(TRAIN, rate=rate), **parameters, at=LATE)


def test_an_obstacle_that_rests_at_its_goal_and_leaves_it_later_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not known(monkeypatch, TRAIN, **AWAY, speed=5.0, back=LATE)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("at", [0.0, -100.0, 2.5 * HORIZON])
def test_an_obstacle_that_reaches_its_last_corner_is_known(at: float, monkeypatch: pytest.MonkeyPatch) -> None:
    assert known(monkeypatch, TRAIN, **AWAY, speed=10.0, at=at)


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("name", "parameters"),
    [("moving_circle", AWAY | {"speed": 0.0}), ("orbiting_circle", CIRCLING | {"speed": 0.0})],
)
def test_an_obstacle_whose_rate_is_zero_is_known_at_rest(name: str, parameters: dict[str, Any]) -> None:
    assert beyond(name, **parameters).unknown is None


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("speed", "straight"), [(1.0, False), (0.0, True), (1000.0, False)])
def test_a_circle_that_is_declared_straight_is_unknown(
    speed: float, straight: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At 1000 m/s it is back where it was after every half a step."""
    obstacle = dataclasses.replace(ORBIT, rate=Rate(times=0.0))
    way = 1.5915494309189533
    assert known(monkeypatch, obstacle, **CIRCLING | {"speed": speed, "way": way}) == straight


@pytest.mark.by_day(2)
@pytest.mark.parametrize("rate", [Rate(times=0.0), Rate(("omega",))], ids=["straight", "honest"])
@pytest.mark.parametrize("parameters", [{}, {"omega": 0.0}, {"omega": 0.4}, {"at": LATE}], ids=str)
def test_a_shape_that_turns_about_a_fixed_centre_is_known_only_by_its_rate(
    rate: Rate, parameters: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    turns, honest = parameters.get("omega") != 0.0, rate != Rate(times=0.0)
    expected = not turns or (honest and "at" not in parameters)
    obstacle = dataclasses.replace(JIB, rate=rate)
    seen = known(monkeypatch, obstacle, "surface_separation", position=place(40.0, 40.0), **parameters)
    assert seen == expected
