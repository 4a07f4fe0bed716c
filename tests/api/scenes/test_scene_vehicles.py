"""How a vehicle is drawn, and what its flight is labelled with."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import viser

from backend.scenes.base.axes import Axes
from backend.scenes.base.flight import Flight, from_live
from backend.scenes.base.palette import LIGHT
from backend.scenes.base.setting import Setting
from backend.scenes.drawing import drawn, shapes
from backend.scenes.drawing.drawn import Drawn, Style
from backend.scenes.drawing.world import World
from campaigns.results.scene import Scene
from tests.given.finished_runs import encounter, straight


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    made = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield made
    made.stop()


def setting(**given: Any) -> Setting:
    shared: dict[str, Any] = dict.fromkeys(("run", "title", "digest", "vehicle", "quantity"), "x")
    plain: dict[str, Any] = {
        "document": {}, "planar": False, "axes": Axes(), "start": np.zeros(3), "goal": np.ones(3), "course": None,
        "values": {}, "moving": [True], "threshold": 0.5, "to_surface": False, "unit": "m", "horizon": 20.0,
        "uncertain": [], "methods": [],
    }  # fmt: skip
    return Setting(**(shared | plain | given))


def flight(status: str) -> Flight:
    trace = encounter("nominal", "enu", straight(100, 0, 0, -1.0, 0, 0))
    meta = trace.meta.model_dump() | {"status": status}
    found = from_live(
        {
            "columns": [column.model_dump() for column in trace.columns],
            "data": {column.name: trace.data[:, k] for k, column in enumerate(trace.columns)},
            "meta": meta,
            "identity": {},
        }
    )
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("status", "label"),
    [
        ("ok", "Nominal 5.0062 m"),
        ("failed", "Nominal: failed at 20.00 s"),
        ("timeout", "Nominal: timeout at 20.00 s"),
        ("excluded", "Nominal: excluded at 20.00 s"),
    ],
)
def test_a_flight_is_labelled_with_its_closest_approach_or_why_it_has_none(
    server: viser.ViserServer, status: str, label: str
) -> None:
    shown = setting()
    one = Drawn(server, shown, World(server, shown, LIGHT), Style("nominal", "Nominal", LIGHT.nominal, 0, "bottom"))
    found = flight(status)
    one.draw(found, 0.0)
    assert one.tag is not None
    assert one.tag.label.text == label
    assert (found.closest is None) == (status != "ok")


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize(
    ("vehicle", "mesh"),
    [
        ({}, shapes.ball),
        ({"angles": ["roll", "pitch", "yaw"]}, shapes.body),
        ({"quaternion": ["w", "i", "j", "k"]}, shapes.body),
        ({"angles": [0, 0, "yaw"], "mesh": "aircraft"}, shapes.aircraft),
        ({"mesh": "robot"}, shapes.unicycle),
    ],
)
def test_the_vehicle_of_a_simulator_is_neutral_unless_it_declares_a_mesh(
    planar: bool, vehicle: dict[str, Any], mesh: Any
) -> None:
    scene = Scene.model_validate({"frame": "z_up", "vehicle": {"position": ["x", "y", 0]} | vehicle})
    found = drawn._shape(setting(planar=planar, scene=scene))
    for part, expected in zip(found, mesh(), strict=True):
        assert np.array_equal(part.vertices, expected.vertices)
