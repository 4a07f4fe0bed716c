"""Parameters in space that are made from planar ones."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.parameters import Declared, Parameter, declared, in_space


class Planar(NamedTuple):
    way_x: Annotated[float, Parameter("m", "End, x", -1e3, 1e3, "x_1", "way.x")]
    way_y: Annotated[float, Parameter("m", "End, y", -1e3, 1e3, "y_1", "way.y")]
    y: Annotated[float, Parameter("m", "Goal, y", -5.0, 5.0)] = 1.0
    delay: Annotated[float, Parameter("s", "Delay of any body", 0.0, 9.0)] = 2.0


def test_a_z_like_it_follows_every_y() -> None:
    assert declared(in_space(Planar, delay=3.0)) == (
        Declared("way_x", "way.x", "x_1", "m", "End, x", -1e3, 1e3, None),
        Declared("way_y", "way.y", "y_1", "m", "End, y", -1e3, 1e3, None),
        Declared("way_z", "way.z", "z_1", "m", "End, z", -1e3, 1e3, None),
        Declared("y", "y", "y", "m", "Goal, y", -5.0, 5.0, 1.0),
        Declared("z", "z", "z", "m", "Goal, z", -5.0, 5.0, 1.0),
        Declared("delay", "delay", "delay", "s", "Delay of any body", 0.0, 9.0, 3.0),
    )


def test_the_planar_ones_stay_as_they_are() -> None:
    before = declared(Planar)
    in_space(Planar, delay=3.0)
    assert declared(Planar) == before
