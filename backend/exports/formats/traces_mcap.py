"""The stored flights as MCAP with messages of Foxglove: pose, trajectory, scene, separation or signals.

All flights begin at time 0, so that they play side by side; MCAP has no times below 0. What was subtracted from the
times of a flight is in the metadata `time offsets` [s], where that is not 0. Positions are in the frame `scene`: x to
the right (east), y ahead (north), z up; bodies have x ahead, y left, z up. Sources: MCAP format specification; Foxglove
message schemas.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import sqlalchemy as sa

from backend.exports.format import Format, missing, require, whole, words
from backend.http.written import finite
from backend.results import service as results
from backend.runs import service as runs
from backend.scenes.base.flight import Flight, from_stored
from campaigns import thin
from campaigns.results import TraceHead
from campaigns.results.trace import TraceColumn
from campaigns.version import VERSION

if TYPE_CHECKING:
    from mcap.writer import Writer

PATH = 2000
"""Maximum number of poses in the message of a trajectory."""

MISSING = partial(missing, "mcap", "logs")


def traces_mcap(reader: sa.Connection, run_id: int) -> bytes:
    """All stored flights of a run. Raises 503 if the package is not installed."""
    require(MISSING)
    from mcap.writer import Writer

    run, buffer = runs.summary(reader, run_id), io.BytesIO()
    writer = Writer(buffer)
    writer.start(profile="", library=f"clearance {VERSION}")
    about = {"run": run.id, "name": run.name, "campaign_digest": run.campaign_digest, "frame": "scene: east, north, up"}
    writer.add_metadata("clearance", about)
    output = _Output(writer)
    for info in results.traces(reader, run_id):
        row = results.stored(reader, run_id, info.name)
        output.flight(info.name, row, from_stored(row, most=10**9))
    if output.offsets:
        writer.add_metadata("time offsets", output.offsets)
    writer.finish()  # type: ignore[no-untyped-call]
    return buffer.getvalue()


@dataclass
class _Output:
    """The channels of a file, registered when their first message is written."""

    writer: Writer
    schemas: dict[str, int] = field(default_factory=dict)
    channels: dict[str, int] = field(default_factory=dict)
    offsets: dict[str, str] = field(default_factory=dict)
    """The time at which each flight begins [s], by name, except 0."""

    def send(self, topic: str, schema: str, time: float, message: dict[str, object]) -> None:
        """Write a message; time [s]."""
        if topic not in self.channels:
            if schema not in self.schemas:
                text = json.dumps(SCHEMAS[schema]).encode()
                self.schemas[schema] = self.writer.register_schema(schema, "jsonschema", text)
            self.channels[topic] = self.writer.register_channel(topic, "json", self.schemas[schema])
        at = round(time * 1e9)
        data = json.dumps(message, allow_nan=False, separators=(",", ":")).encode()
        self.writer.add_message(self.channels[topic], at, data, at)

    def flight(self, name: str, row: Any, flight: Flight | None) -> None:
        """Write one flight; without positions only what it measured."""
        head, columns = TraceHead.model_validate(row.meta), [TraceColumn.model_validate(c) for c in row.columns]
        data = results.table(row)
        clock = next((k for k, column in enumerate(columns) if column.group == "time"), None)
        times = np.empty(0) if clock is None else data[np.isfinite(data[:, clock]), clock]
        begin = float(times.min()) if len(times) else 0.0
        if begin:
            self.offsets[name] = repr(begin)
        if flight is not None:
            self._moving(name, replace(flight, time=flight.time - begin), head)
        if clock is not None:
            self._measured(name, columns, data, data[:, clock] - begin)

    def _moving(self, name: str, flight: Flight, head: TraceHead) -> None:
        start = float(flight.time[0])
        poses = [pose(*one) for one in zip(flight.position.tolist(), flight.attitudes.tolist(), strict=True)]
        path = [poses[k] for k in thin.around(len(poses), PATH, 0)]
        self.send(f"/{name}/trajectory", "foxglove.PosesInFrame", start, stamped(start, poses=path))
        fixed = list(_fixed(name, flight, head))
        if fixed:
            self.send(f"/{name}/scene", "foxglove.SceneUpdate", start, {"deletions": [], "entities": fixed})
        for row, time in enumerate(flight.time.tolist()):
            self.send(f"/{name}/pose", "foxglove.PoseInFrame", time, stamped(time, pose=poses[row]))
            moving = [
                entity(f"{name}/obstacle.{number}", time, track[row], _radius(head, number))
                for number, track in flight.tracks.items()
            ]
            if moving:
                self.send(f"/{name}/obstacles", "foxglove.SceneUpdate", time, {"deletions": [], "entities": moving})

    def _measured(self, name: str, columns: list[TraceColumn], data: Any, times: Any) -> None:
        """The separation, or the signals of a simulator; values that are not finite are null."""
        for topic, group in (("separation", "separation"), ("signals", "signal")):
            chosen = [k for k, column in enumerate(columns) if column.group == group]
            for row, time in zip(data, times.tolist(), strict=True) if chosen else ():
                if not math.isfinite(time):
                    continue
                values = [
                    {"name": columns[k].name, "unit": columns[k].unit, "value": finite(float(row[k]))} for k in chosen
                ]
                self.send(f"/{name}/{topic}", VALUES, time, stamped(time, values=values))


def _fixed(name: str, flight: Flight, head: TraceHead) -> Iterator[dict[str, object]]:
    """The obstacles that do not move, drawn as balls of their radius."""
    start = float(flight.time[0])
    placed = [(o.position, o.radius) for o in head.obstacles]
    if head.scene is not None:
        placed = [(o.position, o.radius or max([0.0, *(o.size or [])]) / 2) for o in head.scene.obstacles]
    for number, (position, radius) in enumerate(placed):
        if number not in flight.tracks:
            point = np.array([*position, 0.0, 0.0, 0.0][:3], dtype=np.float64)
            yield entity(f"{name}/obstacle.{number}", start, flight.axes.drawn(point), float(radius))


def _radius(head: TraceHead, number: int) -> float:
    if head.scene is not None:
        body = number - len(head.scene.obstacles)
        return head.scene.bodies[body].radius if 0 <= body < len(head.scene.bodies) else 0.0
    return head.obstacles[number].radius if number < len(head.obstacles) else 0.0


FRAME = "scene"
VALUES = "clearance.Values"
"""Named values with units; null: not finite."""

SMALLEST = 0.1
"""Radius of the ball that shows an obstacle without one [m]."""


def _object(**properties: dict[str, object]) -> dict[str, object]:
    return {"type": "object", "properties": properties, "required": list(properties)}


def _list(of: dict[str, object]) -> dict[str, object]:
    return {"type": "array", "items": of}


_NUMBER: dict[str, object] = {"type": "number"}
_TEXT: dict[str, object] = {"type": "string"}
_WHOLE: dict[str, object] = {"type": "integer", "minimum": 0}
_TIME = _object(sec=_WHOLE, nsec={**_WHOLE, "maximum": 999_999_999})
_VECTOR = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER)
_POSE = _object(position=_VECTOR, orientation=_object(x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER))
_COLOUR = _object(r=_NUMBER, g=_NUMBER, b=_NUMBER, a=_NUMBER)
_SPHERE = _object(pose=_POSE, size=_VECTOR, color=_COLOUR)
_NONE: dict[str, object] = {"type": "array", "maxItems": 0}
_EMPTY = ("arrows", "cubes", "cylinders", "lines", "triangles", "texts", "models")
_ENTITY = _object(
    timestamp=_TIME,
    frame_id=_TEXT,
    id=_TEXT,
    lifetime=_TIME,
    frame_locked={"type": "boolean"},
    metadata=_NONE,
    spheres=_list(_SPHERE),
    **dict.fromkeys(_EMPTY, _NONE),
)
_VALUE = _object(name=_TEXT, unit=_TEXT, value={"type": ["number", "null"]})

SCHEMAS: dict[str, dict[str, object]] = {
    "foxglove.PoseInFrame": _object(timestamp=_TIME, frame_id=_TEXT, pose=_POSE),
    "foxglove.PosesInFrame": _object(timestamp=_TIME, frame_id=_TEXT, poses=_list(_POSE)),
    "foxglove.SceneUpdate": _object(deletions=_NONE, entities=_list(_ENTITY)),
    VALUES: _object(timestamp=_TIME, frame_id=_TEXT, values=_list(_VALUE)),
}
"""By name; encoding jsonschema."""


def stamped(time: float, **content: Any) -> dict[str, object]:
    """A message with its time [s] and frame."""
    return {"timestamp": _stamp(time), "frame_id": FRAME, **content}


def pose(position: Iterable[float], turn: Iterable[float]) -> dict[str, object]:
    """position (3,) [m]; turn w, x, y, z."""
    w, x, y, z = (float(one) for one in turn)
    return {"position": _vector(position), "orientation": {"x": x, "y": y, "z": z, "w": w}}


def entity(name: str, time: float, centre: Iterable[float], radius: float) -> dict[str, object]:
    """An obstacle as a ball that stays until it is replaced."""
    size = 2 * max(radius, SMALLEST)
    grey = {"r": 0.45, "g": 0.5, "b": 0.55, "a": 0.8}
    ball = {"pose": pose(centre, (1.0, 0.0, 0.0, 0.0)), "size": _vector((size, size, size)), "color": grey}
    return {
        **stamped(time),
        "id": name,
        "lifetime": _stamp(0.0),
        "frame_locked": False,
        "metadata": [],
        "spheres": [ball],
        **{kind: [] for kind in _EMPTY},
    }


def _stamp(time: float) -> dict[str, object]:
    whole = round(time * 1e9)
    return {"sec": whole // 10**9, "nsec": whole % 10**9}


def _vector(components: Iterable[float]) -> dict[str, object]:
    return dict(zip("xyz", map(float, components), strict=True))


export = Format(
    file="traces.mcap",
    order=7,
    media_type="application/x-mcap",
    words=words(
        "Flights, MCAP",
        "Pose, trajectory, scene and separation for Foxglove",
        ("Traces, MCAP", "Pose, trajectory and scene where declared, and all signals, for Foxglove"),
    ),
    made=lambda engine, run_id: whole(engine, run_id, traces_mcap),
    needs="flights",
    missing=MISSING,
)
