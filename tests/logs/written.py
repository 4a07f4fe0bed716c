"""Writes minimal logs: ULog by its specification, recordings of ROS 2 by the writer of mcap."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

FIELDS = "uint64_t timestamp;float x;float y;float z;uint8_t xy_valid;uint8_t z_valid;uint8_t xy_reset_counter;uint8_t z_reset_counter;uint8_t[4] _padding0;"  # fmt: skip  # noqa: E501
ORIGIN = "uint64_t ref_timestamp;double ref_lat;double ref_lon;float ref_alt;uint8_t[4] _padding1;"
Origin = tuple[int, float, float, float]
"""ref_timestamp [us], ref_lat, ref_lon [deg], ref_alt [m]."""
Row = tuple[float, float, float, float]


def ulog(
    file: Path,
    topics: Mapping[str, Iterable[Sequence[float]]],
    fields: str = FIELDS,
    origins: Mapping[str, Sequence[Origin]] | None = None,
) -> Path:
    """A ULog file; rows by topic: time [s], x, y, z, then flags that differ: xy_valid, z_valid and the counters.

    origins: of topics that state one, that of each row.
    """
    content = b"ULog\x01\x12\x35" + b"\x01" + (0).to_bytes(8, "little") + _message("B", bytes(40))
    stated = {name: ORIGIN if name in (origins or {}) else "" for name in topics}
    content += b"".join(_message("F", f"{name}:{fields}{more}".encode()) for name, more in stated.items())
    content += b"".join(_message("A", struct.pack("<BH", 0, k) + name.encode()) for k, name in enumerate(topics))
    for k, (name, rows) in enumerate(topics.items()):
        for at, (t, x, y, z, *flags) in enumerate(rows):
            xy, down, xy_resets, z_resets = flags or (1, 1, 0, 0)
            row = struct.pack("<QfffBBBB", round(t * 1e6), x, y, z, int(xy), int(down), int(xy_resets), int(z_resets))
            if origins and stated[name]:
                row += bytes(4) + struct.pack("<Qddf", *origins[name][at])
            content += _message("D", struct.pack("<H", k) + row)
    file.write_bytes(content)
    return file


def _message(kind: str, payload: bytes) -> bytes:
    return struct.pack("<HB", len(payload), ord(kind)) + payload


_HEADER = """
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
_POSE = """
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
"""
ODOMETRY = (
    "nav_msgs/msg/Odometry",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose"
    + _HEADER
    + "=" * 80
    + "\nMSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance"
    + _POSE,
)
POSE = ("geometry_msgs/msg/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose" + _HEADER + _POSE)
TEXT = ("std_msgs/msg/String", "string data")


def mcap(file: Path, topics: Mapping[str, tuple[tuple[str, str], str, Iterable[Row]]]) -> Path:
    """A recording; by topic: type, frame and rows of time [s], x, y, z."""
    from mcap_ros2.writer import Writer

    with file.open("wb") as stream:
        writer = Writer(stream)
        messages = []
        for topic, (kind, frame, rows) in topics.items():
            schema = writer.register_msgdef(*kind)
            messages += [(row[0], topic, schema, _ros(kind, frame, row)) for row in rows]
        for k, (_, topic, schema, message) in enumerate(messages):
            writer.write_message(topic, schema, message, log_time=k, publish_time=k)
        writer.finish()
    return file


def _ros(kind: tuple[str, str], frame: str, row: Row) -> dict[str, Any]:
    t, x, y, z = row
    nanoseconds = round(t * 1e9)
    header = {"stamp": {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}, "frame_id": frame}
    pose = {"position": {"x": x, "y": y, "z": z}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
    if kind == TEXT:
        return {"data": "x"}
    if kind == ODOMETRY:
        return {"header": header, "child_frame_id": "base", "pose": {"pose": pose, "covariance": [0.0] * 36}}
    return {"header": header, "pose": pose}
