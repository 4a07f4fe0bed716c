"""Obstacles whose motion is not what their component declares, or begins late: nothing is taken as known about them."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from tests.given.beyond_horizon import GOAL, HORIZON, beyond, place
from tests.given.late_obstacles import JIB, LEGS, ORBIT, TRAIN
from worker.engine.kernels.component import Obstacle, Rate
from worker.engine.systems.closed_loop.parts import Installed
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import components, installed, source_of
from worker.running.opening import opened

LATE = 7.7 * HORIZON
CIRCLING: dict[str, Any] = {"centre": place(40.0, 40.0), "way": 5.0, "speed": 1.0}
TO_GOAL: dict[str, Any] = {"position": place(GOAL[0] + 6.0, GOAL[1]), "goal": place(GOAL[0] - 6.0, GOAL[1])}
AWAY: dict[str, Any] = {"position": place(60.0, 7.0), "goal": place(90.0, 7.0)}


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
