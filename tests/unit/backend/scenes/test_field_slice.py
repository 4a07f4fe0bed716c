"""The avoider's field as drawn: grid, axes, scale, legend. The demands are tested in `test_field`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from backend.scenes.base.axes import Axes
from backend.scenes.drawing.world import Frame
from backend.scenes.panel.field_slice import PLACES, VIRIDIS, Grid, Slice, arrows, colours, legend, picture, read


class Planar:
    """As much of a setting as the words need."""

    def __init__(self, planar: bool = True) -> None:
        self.planar = planar
        self.document = {"scenario": {"avoider": {"component": "potential_field"}}}


GRID = Grid(3, 2, 10.0, (100.0, 50.0))


def answer(demand: list[list[float] | None], **changes: Any) -> dict[str, Any]:
    told = {"time": 2.5, "place": [1.0, 2.0, -30.0], "kind": "velocity", "unit": "m/s", "memory": 0}
    return told | {"own": [3.0, 4.0, 0.0], "demand": demand} | changes


def sliced(magnitudes: list[float | None], **changes: Any) -> Slice:
    return read(answer([None if m is None else [m, 0.0, 0.0] for m in magnitudes], **changes), GRID, Axes())


def test_a_grid_covers_the_scene_with_square_cells_and_a_margin() -> None:
    frame = Frame.around([np.array([[0.0, -5.0, 0.0], [600.0, 15.0, 80.0]])], 10.0)
    grid = Grid.over(frame)
    assert 0.9 * PLACES < grid.columns * grid.rows < 1.1 * PLACES
    places = grid.places
    assert places.shape == (grid.rows, grid.columns, 2)
    assert np.diff(places[0, :, 0]) == pytest.approx(grid.cell)
    assert np.diff(places[:, 0, 1]) == pytest.approx(grid.cell)
    assert places.mean(axis=(0, 1)) == pytest.approx([300.0, 5.0])
    assert places[..., 0].min() < -40.0
    assert places[..., 1].max() > 100.0, "a long and narrow scene has a plane that is not so narrow"


def test_north_east_down_is_drawn_as_east_north_up() -> None:
    found = read(answer([[1.0, 2.0, -3.0]] * 6), GRID, Axes("ned"))
    assert found.height == 30.0
    assert found.demand[1, 2].tolist() == [2.0, 1.0, 3.0]
    assert found.own is not None
    assert found.own.tolist() == [4.0, 3.0, 0.0]
    assert arrows(found).shape == (0, 2, 3), "two rows are too few for an arrow in every fourth"


def test_colours_are_of_the_logarithm_and_large_demands_stand_out() -> None:
    found = sliced([1.0, 10.0, 100.0, None, 0.0, 10.0])
    low, high = found.ends or (0.0, 0.0)
    assert 1.0 <= low < 1.5
    assert 90.0 < high <= 100.0
    shares = found.shares()
    assert shares[0, 0] == pytest.approx(0.0, abs=0.05)
    assert shares[0, 1] == pytest.approx(0.5, abs=0.03)
    assert shares[0, 2] == 1.0
    drawn = picture(found, dark=False)
    assert drawn[0, 2, :3].tolist() == VIRIDIS[0].tolist()
    assert drawn[1, 0, 3] == 0, "no answer, no colour"
    assert (drawn[0, :, 3] > 0).all()


def test_a_pole_does_not_take_all_the_colours() -> None:
    found = sliced([1.0, 2.0, 3.0, 4.0, 5.0, 1e9])
    _, high = found.ends or (0.0, 0.0)
    assert high == pytest.approx(350.0)
    assert "largest 1e+09 m/s" in legend(found, "Worst", Planar(), dark=False)  # type: ignore[arg-type]


def test_the_words_say_what_is_shown() -> None:
    words = legend(sliced([1.0, 10.0, 100.0, None, 0.0, 10.0]), "F2", Planar(), dark=True)  # type: ignore[arg-type]
    shown = [
        "Velocity [m/s] that the avoider (potential field) demands over the plane, at t = 2.50 s of F2",
        "1 of 6 positions have no demand",
        "1 of 6 positions have zero demand",
        "At the vehicle: 5 m/s",
    ]
    assert [words.count(text) for text in shown] == [1, 1, 1, 1]
    assert "memory" not in words
    aloft = Planar(False)
    told = legend(sliced([7.0] * 6, memory=2), "F1", aloft, dark=True)  # type: ignore[arg-type]
    assert "Uniform: 7 m/s" in told
    assert [text in told for text in ("memory at that time", "at the height of \u221230 m")] == [True, True]
    nothing = legend(sliced([0.0] * 6), "F1", aloft, dark=True)  # type: ignore[arg-type]
    assert "The demand is zero everywhere" in nothing


@pytest.mark.parametrize("dark", [False, True])
def test_the_scale_is_the_pages_own(dark: bool) -> None:
    """`frontend/src/run/space/space.test.ts` tests the pages' version."""
    ends = colours([-1.0, 0.0, 1.0, 2.0], dark)
    assert (ends[0] == ends[1]).all()
    assert (ends[2] == ends[3]).all()
    assert ends[1].tolist() == VIRIDIS[-1 if dark else 0].tolist()
    light = colours(np.linspace(0, 1, 20), dark) @ np.array([0.2126, 0.7152, 0.0722])
    assert (np.diff(light) < 0).all() if dark else (np.diff(light) > 0).all(), "told apart in grey as well"
