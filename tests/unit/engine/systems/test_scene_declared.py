"""The declaration of a simulator's 3D view: what can be drawn, and a sentence for everything else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

import clearance
from campaigns.results import TraceHead
from campaigns.results.scene import Scene
from worker.engine.systems.simulators.declared.descriptor import BadDescriptor, Descriptor, read
from worker.engine.systems.simulators.declared.scene import scene_of
from worker.running.catalogue.files import BadFile, PythonFunction, read_file

UNITS = {"time": "s", "x": "m", "y": "m", "z": "m", "far": "km", "q": "", "a": "rad", "b": "deg"}


def scene(**changes: Any) -> dict[str, Any]:
    vehicle = {"position": ["x", 0, "z"]} | changes.pop("vehicle", {})
    return {"frame": "z_up", "vehicle": vehicle} | changes


RIGHT = [
    scene(),
    scene(frame="z_down", vehicle={"quaternion": ["q", "q", 0, 1]}),
    scene(vehicle={"angles": [0, "a", 0.5], "mesh": "robot"}),
    scene(vehicle={"position": ["x", "y"]}, bodies=[{"position": ["x", 3.5]}]),
    scene(obstacles=[{"shape": "box", "position": [0, 0, 1], "size": [1, 2, 3], "angle": 0.1}]),
    scene(vehicle={"position": ["x", "y"]}, obstacles=[{"shape": "cylinder", "position": [0, 0], "radius": 1}]),
]
WRONG: list[tuple[Any, str]] = [
    ({}, "scene.frame: this key is required"),
    ([], "scene: expected a mapping"),
    (scene(frame="up"), "scene.frame: expected 'z_up' or 'z_down'"),
    (scene(colour="red"), "scene: there is no 'colour' here; give frame, vehicle, bodies, obstacles"),
    (scene(vehicle={"heading": "a"}), "scene.vehicle: there is no 'heading' here"),
    (scene(vehicle={"position": ["x"]}), "scene.vehicle.position: expected at least 2 entr"),
    (scene(vehicle={"position": ["x", 0, "h"]}), "the trace has no column h; it has time, x, y, z"),
    (scene(vehicle={"position": ["x", 0, None]}), "scene.vehicle.position.2: the name of a column or a number"),
    (scene(vehicle={"position": ["x", 0, float("nan")]}), "scene.vehicle.position.2: the name of a column"),
    (scene(vehicle={"position": ["x", 0, True]}), "scene.vehicle.position.2: the name of a column"),
    (scene(vehicle={"position": [1, 0, 2]}), "at least one column of the trace is expected, given numbers only"),
    (scene(vehicle={"position": ["x", "far", "z"]}), "the column far is in km; m is expected"),
    (scene(vehicle={"position": ["x", "q", "z"]}), "the column q is in no unit; m is expected"),
    (scene(vehicle={"angles": ["a", "b", 0]}), "scene.vehicle.angles: all are in rad, or all in deg"),
    (scene(vehicle={"angles": ["x", 0, 0]}), "the column x is in m; rad or deg is expected"),
    (scene(vehicle={"quaternion": ["a", 0, 0, 1]}), "the column a is in rad; no unit or 1 is expected"),
    (scene(vehicle={"quaternion": ["q"] * 4, "angles": ["a"] * 3}), "give quaternion or angles, not both"),
    (scene(bodies=[{"position": ["x", "y"]}]), "scene.bodies.0.position: 3 coordinates are expected"),
    (
        scene(bodies=[{"position": ["x", "y", "z"], "radius": -1}]),
        "bodies.0.radius: expected a number of at least 0",
    ),
    (scene(bodies=[{"position": ["x", "y", "z"]}] * 33), "scene.bodies: expected at most 32 entr"),
    (scene(obstacles=[{"shape": "sphere", "position": [0, 0, 0]}]), "scene.obstacles.0.radius: a sphere needs it"),
    (scene(obstacles=[{"shape": "cylinder", "position": [0, 0, 0], "radius": 1}]), "height: a cylinder needs it"),
    (
        scene(obstacles=[{"shape": "sphere", "position": ["x", 0, 0], "radius": 1}]),
        "position.0: expected a number",
    ),
    (
        scene(obstacles=[{"shape": "box", "position": [0, 0, 0], "size": [1, 2]}]),
        "length, width and height are expected",
    ),
    (
        scene(obstacles=[{"shape": "sphere", "position": [0, 0, 0], "radius": 1, "size": [1, 1]}]),
        "scene.obstacles.0.size: a sphere has none; it has radius",
    ),
    (
        scene(obstacles=[{"shape": "sphere", "position": [0, 0, 1e10], "radius": 1}]),
        "and at most 1,000,000,000",
    ),
]


@pytest.mark.parametrize("given", RIGHT, ids=range(len(RIGHT)))
def test_what_fits_the_columns_is_accepted_and_stored(given: dict[str, Any]) -> None:
    found = scene_of(given, UNITS)
    stored = TraceHead(scene=found).model_dump(mode="json")
    assert TraceHead.model_validate(stored).scene == found
    later = stored["scene"] | {"sky": "blue"}
    assert Scene.model_validate(later) == found, "a later version may have stored more"


@pytest.mark.parametrize(("given", "reason"), WRONG, ids=range(len(WRONG)))
def test_what_does_not_fit_is_refused_in_words(given: Any, reason: str) -> None:
    with pytest.raises(ValueError, match=r"^scene") as refused:
        scene_of(given, UNITS)
    assert reason in str(refused.value)


def test_a_header_without_a_scene_is_stored_as_before() -> None:
    assert "scene" not in TraceHead().model_dump()


def test_the_example_declares_one(tmp_path: Path) -> None:
    described = read(Path(__file__).parents[4] / "docs" / "examples" / "drop")
    assert isinstance(described.descriptor, Descriptor)
    assert described.drawn is not None
    document = yaml.safe_load((described.folder / "simulator.yaml").read_text(encoding="utf-8"))
    for changed, reason in (({"trace": {}}, "declare them under trace"), ({"scene": scene(frame=1)}, "scene.frame")):
        (tmp_path / "simulator.yaml").write_text(yaml.safe_dump(document | changed), encoding="utf-8")
        with pytest.raises(BadDescriptor, match=reason):
            read(tmp_path)


SOURCE = """
import clearance
import numpy as np
@clearance.simulator(
    parameters={"v": (0, 1)}, trace={"time": {}, "x": {"unit": "m"}},
    scene={"frame": "z_up", "vehicle": {"position": ["x", FAR]}},
)
def fly(v, trace=False):
    return (v, {"time": [0, 1], "x": [0, v]}) if trace else v
"""


def test_a_function_declares_one(tmp_path: Path) -> None:
    file = tmp_path / "fly.py"
    file.write_text(SOURCE.replace("FAR", "np.int64(2)"), encoding="utf-8")
    (found,) = read_file(file)
    assert isinstance(found, PythonFunction)
    assert found.declaration.drawn.vehicle.position == ["x", 2]
    file.write_text(SOURCE.replace("FAR", "'y'"), encoding="utf-8")
    with pytest.raises(BadFile, match=r" y; .* time, x"):
        read_file(file)
    file.write_text(SOURCE.replace("FAR", "{1, 2}"), encoding="utf-8")
    with pytest.raises(BadFile, match=r"scene\.vehicle\.position\.1: "):
        read_file(file)


def test_in_a_script_a_wrong_one_is_refused_at_once() -> None:
    with pytest.raises(ValueError, match=r" column h\b"):

        @clearance.simulator(
            parameters={"v": (0.0, 1.0)},
            trace={"time": {}, "x": {"unit": "m"}},
            scene=scene(vehicle={"position": ["x", "h"]}),
        )
        def fly(v: float, trace: bool = False) -> Any:
            return v
