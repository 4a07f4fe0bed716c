"""The declared rate of an obstacle is compared with how its velocity and its shape turn."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest

from tests.given.late_obstacles import JIB, ORBIT, TRAIN
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Obstacle, Rate
from worker.running.catalogue.installed import components
from worker.running.examination.mistake import Mistake
from worker.running.examination.turns import check_rate

PLACE = {"position.x": 30.0, "position.y": 30.0}
OMEGA = {**PLACE, "radius": 0.1, "length": 12.0, "omega": 0.02, "at": 0.0}
CIRCLE = {"centre.x": 30.0, "centre.y": 30.0, "way": 5.0, "phase": 0.0, "speed": 1.0, "radius": 0.5}
THERE = {**PLACE, "goal.x": 90.0, "goal.y": 60.0, "speed": 1.0, "radius": 0.1, "at": 7.0, "back": 1e6}
WAYPOINTS: Any = components()["obstacle", "waypoint_circle"]
ZIGZAG = {**PLACE, **{f"waypoint{k}.{axis}": 30.0 + 4.0 * ((k + j) % 2) for k in (1, 2, 3, 4) for j, axis in
                      enumerate("xy")}, "legs": 4.0, "speed": 1.0, "radius": 0.5}  # fmt: skip


def checked(obstacle: Obstacle, values: dict[str, float], rate: Rate | None = None) -> None:
    """Compare a rate, by default its own, with the motion of an obstacle with these values."""
    made = dataclasses.replace(obstacle, rate=rate or obstacle.rate)
    p = made.parameters(*values.values())
    if made.derived is not None:
        p = made.derived.constants(*plain(made.derived.derive)(p, ()))
    check_rate(made, (0.0, (), (0.0, 0.0), p), values, 1)


@pytest.mark.parametrize(
    ("obstacle", "values"),
    [
        (JIB, OMEGA),
        (JIB, OMEGA | {"omega": 3.0}),
        (JIB, OMEGA | {"omega": 0.0}),
        (ORBIT, CIRCLE),
        (ORBIT, CIRCLE | {"speed": -300.0}),
        (ORBIT, CIRCLE | {"speed": 1e-3}),
        (TRAIN, THERE),
        (TRAIN, THERE | {"back": 200.0}),
        (WAYPOINTS, ZIGZAG),
    ],
)
def test_a_rate_that_covers_the_motion_is_accepted(obstacle: Obstacle, values: dict[str, float]) -> None:
    checked(obstacle, values)


@pytest.mark.parametrize(
    ("obstacle", "values", "rate", "what"),
    [
        (JIB, OMEGA, Rate(times=0.0), "shape"),
        (JIB, OMEGA | {"at": 500.0}, Rate(times=0.0), "shape"),
        (JIB, OMEGA, Rate(("omega",), times=0.3), "shape"),
        (ORBIT, CIRCLE, Rate(times=0.0), "velocity"),
        (ORBIT, CIRCLE, Rate(("speed",), ("way",), times=0.9), "velocity"),
        (ORBIT, CIRCLE | {"speed": 1e3}, Rate(times=1e-6), "velocity"),
        (TRAIN, THERE | {"back": 200.0}, Rate(times=0.0), "velocity"),
        (WAYPOINTS, ZIGZAG, Rate(times=0.1), "velocity"),
    ],
)
def test_a_rate_below_the_measured_turning_is_refused(
    obstacle: Obstacle, values: dict[str, float], rate: Rate, what: str
) -> None:
    with pytest.raises(Mistake, match=rf"its {what} turns") as raised:
        checked(obstacle, values, rate)
    asked = float(raised.value.text.partition("at least ")[2].split()[0])
    assert 0.0 < asked < math.inf
