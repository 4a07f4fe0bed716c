"""The 3D view draws the required distance from an obstacle's surface if the criterion measures to surfaces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import viser

from backend.scenes.base.axes import Axes
from backend.scenes.base.palette import LIGHT
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.obstacles import Obstacles
from backend.scenes.drawing.world import World

ROUND = {"obstacles.0.position.x": 3.0, "obstacles.0.position.y": 2.0, "obstacles.0.radius": 1.0}
BOX = ROUND | {"obstacles.0.length": 4.0, "obstacles.0.width": 2.0, "obstacles.0.height": 6.0}
CYLINDER = ROUND | {"obstacles.0.height": 6.0}


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    made = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield made
    made.stop()


def setting(values: dict[str, float], planar: bool, to_surface: bool) -> Setting:
    shared: dict[str, Any] = dict.fromkeys(("run", "title", "digest", "vehicle", "quantity"), "x")
    return Setting(
        **shared,
        document={},
        planar=planar,
        axes=Axes(),
        start=np.zeros(3),
        goal=np.ones(3),
        course=None,
        values=values | {"criterion.body_radius": 0.25},
        moving=[False],
        threshold=0.5,
        to_surface=to_surface,
        unit="m",
        horizon=1.0,
        uncertain=[],
        methods=[],
    )


def drawn(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch, *made: Any) -> dict[str, list[Any]]:
    """What each part of the obstacle was drawn with."""
    shown = setting(*made)
    obstacles = Obstacles(server, shown, LIGHT, World(server, shown, LIGHT))
    calls: dict[str, list[Any]] = {}
    for kind in ("cylinder", "ball", "line", "mesh", "box"):
        plainly = getattr(obstacles._solids, kind)

        def seen(name: str, *given: Any, plainly: Any = plainly, **more: Any) -> Any:
            calls[name.rpartition("/")[2]] = list(given)
            return plainly(name, *given, **more)

        monkeypatch.setattr(obstacles._solids, kind, seen)
    obstacles.update([], 0.0)
    return calls


@pytest.mark.parametrize("planar", [True, False])
def test_about_a_round_one_it_is_a_larger_round_one(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch, planar: bool
) -> None:
    assert drawn(server, monkeypatch, ROUND, planar, False)["safety"][0] == pytest.approx(0.5)
    assert drawn(server, monkeypatch, ROUND, planar, True)["safety"][0] == pytest.approx(1.75)


def test_about_a_box_from_above_it_is_its_outline(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch) -> None:
    parts = drawn(server, monkeypatch, BOX, True, True)
    assert "safety" not in parts
    assert np.abs(parts["ring"][0][..., :2]).max(axis=(0, 1)) == pytest.approx((2.75, 1.75), abs=0.02)
    assert drawn(server, monkeypatch, BOX, True, False)["safety"][0] == pytest.approx(0.5)


@pytest.mark.filterwarnings("ignore:Invalid combination:UserWarning")  # of wire frames that are flat-shaded too
@pytest.mark.parametrize("values", [BOX, CYLINDER])
def test_in_space_nothing_is_drawn_that_is_not_the_outline(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch, values: dict[str, float]
) -> None:
    assert "safety" not in drawn(server, monkeypatch, values, False, True)
    assert "safety" in drawn(server, monkeypatch, values, False, False)
