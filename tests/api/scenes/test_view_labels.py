"""Labels in 3D: none covers another at the cameras of the view, and none moves without need."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
import pytest

from backend.scenes.base.address import CAMERAS
from backend.scenes.base.axes import Axes
from backend.scenes.base.flight import Flight, from_live
from backend.scenes.base.palette import LIGHT
from backend.scenes.base.setting import Setting
from backend.scenes.control.relay import open_server
from backend.scenes.drawing import labels
from backend.scenes.drawing.cameras import Scene, Sight, pose
from backend.scenes.drawing.labels import Label, Labels, Spot, Tag, View, arranged, box
from backend.scenes.recordings.recording import Cast, _Stage
from tests.given.finished_runs import encounter, straight

VIEW = View(np.array([0.0, -10.0, 0.0]), np.zeros(3), 600.0, 500.0)
HERE = np.array([0.1, 0.0, -0.2])


def label(name: str, place: Any = HERE, anchor: Any = "bottom-left", **more: Any) -> Label:
    return Label(name, more.pop("text", f"{name} 0.84 m"), np.asarray(place, dtype=float), anchor, 0.9, **more)


def overlapping(found: Sequence[Label], view: View, spots: Mapping[str, Spot | None]) -> list[tuple[str, str]]:
    """The pairs of labels whose texts overlap where they are."""
    shown = [(one, spot) for one in found if (spot := spots[one.name]) and view.pixel(one.place)[2] > 0.0]
    boxes = [(one.name, labels._seen(one, spot, view)) for one, spot in shown]
    return [(a, b) for k, (a, one) in enumerate(boxes) for b, other in boxes[k + 1 :] if one.meets(other)]


def test_pixels_are_those_of_a_pinhole_camera() -> None:
    across, down, depth = VIEW.pixel(np.array([1.0, 0.0, 2.0]))
    scale = 250.0 / np.tan(np.radians(20.0)) / 10.0
    assert (across, down, depth) == pytest.approx((300 + scale, 250 - 2 * scale, 10.0))
    moved = VIEW.moved(HERE, 30.0, -40.0)
    assert np.subtract(VIEW.pixel(moved), VIEW.pixel(HERE)) == pytest.approx((30.0, -40.0, 0.0))


def test_a_label_alone_stays_as_it_should_be() -> None:
    spots = arranged([label("F1")], VIEW)
    assert spots["F1"] is not None
    assert (spots["F1"].anchor, spots["F1"].place.tolist()) == ("bottom-left", HERE.tolist())


@pytest.mark.parametrize("count", [2, 3, 6, 12])
def test_labels_at_one_point_are_moved_apart_the_first_one_not(count: int) -> None:
    found = [label(f"F{i}") for i in range(count)]
    spots = arranged(found, VIEW)
    assert overlapping(found, VIEW, spots) == []
    assert spots["F0"] is not None
    assert spots["F0"].anchor == "bottom-left"
    assert np.array_equal(spots["F0"].place, HERE)


def test_any_crowd_in_the_window_is_readable_and_near_its_points() -> None:
    random = np.random.default_rng(3)
    for _ in range(60):
        places = random.uniform(-1.0, 1.0, (9, 3))
        found = [label(f"F{i}", place, random.choice(labels.ANCHORS)) for i, place in enumerate(places)]
        spots = arranged(found, VIEW)
        assert overlapping(found, VIEW, spots) == []
        for one in found:
            spot = spots[one.name]
            assert spot is not None
            away = np.subtract(VIEW.pixel(spot.place), VIEW.pixel(one.place))[:2]
            assert np.hypot(*away) < 8.5 * 20.0


def test_a_placement_is_retained_while_it_is_free() -> None:
    first, second = label("F1"), label("F2")
    before = arranged([first, second], VIEW)
    assert before["F2"] is not None
    assert before["F2"].anchor != "bottom-left"
    nudged = replace(first, place=HERE + 1e-3)
    after = arranged([nudged, second], VIEW, before)
    assert after["F2"] is not None
    assert (after["F2"].anchor, after["F2"].place.tolist()) == (before["F2"].anchor, before["F2"].place.tolist())
    alone = arranged([second], VIEW, before)["F2"]
    assert alone is not None
    assert alone.anchor == "bottom-left", "back where it should be"


def test_a_moved_label_follows_what_it_belongs_to() -> None:
    """An intruder's label that had to give way does not stay behind while the intruder moves on."""
    crowd = [label(f"F{i}") for i in range(6)]
    before = arranged(crowd, VIEW)
    moved = [replace(one, place=one.place + np.array([1.5, 0.0, 1.0])) for one in crowd]
    after = arranged(moved, VIEW, before)
    assert overlapping(moved, VIEW, after) == []
    for one in moved:
        spot = after[one.name]
        assert spot is not None
        assert np.linalg.norm(spot.place - one.place) < 0.6


def test_a_mark_of_a_scale_is_hidden_rather_than_moved() -> None:
    marks = [label(f"h{z}", (0.0, 0.0, z), "center-left", text=f"{z:g} m", fixed=True) for z in (0.4, 0.39, 0.0)]
    spots = arranged(marks, VIEW)
    assert [spots[one.name] is None for one in marks] == [False, True, False]


def test_what_is_behind_the_camera_or_empty_takes_no_room() -> None:
    behind = label("behind", (0.0, -20.0, 0.0))
    empty = label("empty", text="")
    found = [behind, empty, label("F1"), label("F2", (5.0, 0.0, 0.0))]
    spots = arranged(found, VIEW)
    assert all(spot is not None and spot.anchor == "bottom-left" for spot in spots.values())


def test_a_camera_straight_above_and_positions_that_are_no_numbers_do_no_harm() -> None:
    above = View(np.array([0.0, 0.0, 10.0]), np.zeros(3))
    assert all(np.isfinite(above.pixel(HERE)))
    odd = [label("nan", (np.nan, 0.0, 0.0)), label("F1"), label("F2")]
    assert overlapping(odd[1:], above, arranged(odd, above)) == []


def test_lines_count() -> None:
    one, two = (box(text, 1.0, "top-left", (0.0, 0.0)) for text in ("12345", "12345\n12345"))
    assert (two.right, two.bottom - one.bottom) == pytest.approx((one.right, labels.HIGH * labels.EM))


@dataclass
class Node:
    """A viser label that counts what is sent."""

    position: Any
    anchor: str
    visible: bool = True
    sent: list[str] = field(default_factory=list)

    def __setattr__(self, name: str, value: Any) -> None:
        if "sent" in vars(self):
            self.sent.append(name)
        super().__setattr__(name, value)


def test_only_changes_are_sent_relative_to_the_parent_of_the_label() -> None:
    origin = np.array([0.1, 0.0, 0.0])
    nodes = [Node(HERE - origin, "bottom-left"), Node(HERE, "bottom-left")]
    tags = [Tag(label("F1"), nodes[0], origin), Tag(label("F2"), nodes[1], np.zeros(3))]
    view = [VIEW]
    found = Labels(lambda time: tags, lambda: view[0])
    assert found.due
    found.moved(0.0)
    assert (nodes[0].sent, nodes[1].sent) == ([], ["anchor"])
    found.changed()
    assert (found.due, nodes[1].sent) == (False, ["anchor"])
    view[0] = replace(VIEW, width=900.0)
    assert found.due


SCENE = Scene(np.zeros(3), np.array([[-10.0, -6, 0], [10.0, 6, 0]]), 0.5, 1.0)


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("window", [(360.0, 420.0), (620.0, 520.0), (1280.0, 860.0)])
def test_the_closest_approach_of_three_flights_is_readable_from_every_camera(camera: Any, window: Any) -> None:
    near, obstacle = np.array([0.3, 0.2, 0.0]), np.array([0.0, 0.5, 0.0])
    closest = labels_of(near, obstacle)
    sight = Sight(near, np.array([1.0, 0.0, 0.0]), obstacle, 0.3, None)
    view = View(*pose(camera, SCENE, sight, window[0] / window[1]), *window)
    spots = arranged(closest, view)
    assert overlapping(closest, view, spots) == []


def labels_of(near: Any, obstacle: Any) -> list[Label]:
    """The labels of vehicle, obstacle and findings close together."""
    return [
        label("worst", near, "top-right", text="F1 0.3012 m"),
        label("what-if", near + 0.01, "bottom-left", text="What-if 0.3105 m"),
        label("nominal", near + 0.05, "bottom-right", text="Nominal 0.9436 m"),
        label("obstacle", obstacle - (0.0, 0.5, 0.0), "top-center", text="intruder, d_min > 0.9 m"),
        label("velocity", near + 0.02, "bottom-left", text="v rel 2.05 m/s"),
        label("goal", obstacle + 0.1, "top-center", text="goal"),
    ]


@pytest.mark.parametrize("frame", ["enu", "ned"])
def test_all_labels_of_a_drawn_scene_are_readable_at_any_time(frame: Literal["enu", "ned"]) -> None:
    """An intruder that nearly hits the vehicle, the same in the nominal and the worst case but for half a metre."""
    aloft = -20.0 if frame == "ned" else 0.0
    drawn = Setting(
        run="R-0001", title="Encounter", digest="", document={}, planar=frame == "enu", axes=Axes(frame), vehicle="",
        start=np.zeros(3), goal=np.array([400.0, 5.0, 0.0]), course=None, values={"obstacles.0.radius": 1.0},
        moving=[True], threshold=5.0, to_surface=False, quantity="d_min", unit="m", horizon=20.0, uncertain=[],
        methods=[], obstacles=("intruder",),
    )  # fmt: skip
    nominal, worst = (flown(frame, straight(200, 5 + away, aloft, -1, 0, 0)) for away in (0.5, 1.0))
    server = open_server("labels")
    try:
        stage = _Stage(server, drawn, Cast("F1", worst, nominal), LIGHT)
        for time in (0.0, 9.4, 10.0, 20.0):
            stage.move(time)
            found = [tag.label for tag in stage._tags(time)]
            texts = " ".join(one.text for one in found)
            assert all(word in texts for word in ("F1", "Nominal", "intruder", "start", "goal"))
            assert overlapping(found, stage._view, stage._labels._spots) == []
            told = {tag.label.name: tag for tag in stage._tags(time)}
            spot, tag = stage._labels._spots["/flights/worst/label"], told["/flights/worst/label"]
            assert spot is not None
            assert tag.node.position == pytest.approx(spot.place), "viser has it there"
    finally:
        server.stop()


def flown(frame: str, way: Any) -> Flight:
    trace = encounter("live", frame, way)
    data = {column.name: trace.data[:, k].tolist() for k, column in enumerate(trace.columns)}
    columns = [column.model_dump() for column in trace.columns]
    found = from_live({"columns": columns, "data": data, "meta": trace.meta.model_dump(), "identity": {}})
    assert found is not None
    return found
