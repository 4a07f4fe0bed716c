"""The separation of a vehicle from obstacles in a PX4 log (ULog), by its estimated local position."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from worker.engine.systems.simulators.logs.approach import Approach, Column, Sphere, Track, Unreadable, closest

TOPIC = "vehicle_local_position"
MAGIC, HEADER = b"ULog\x01\x12\x35", 16
RESETS = ("xy_reset_counter", "z_reset_counter")
VALID = ("xy_valid", "z_valid")


def separation_of_ulog(
    path: str | os.PathLike[str],
    obstacles: Sequence[Sphere | Column] = (),
    other: str | None = None,
    topic: str = TOPIC,
    gap: float = 0.5,
    lasts: float = 0.0,
) -> Approach:
    """The closest approach of the vehicle to obstacles and to another topic with x, y and z; raises Unreadable.

    Positions are those of the local frame: north, east, down [m] from where the estimator started. Obstacles have the
    same frame. An invalid position, a reset of the estimate, a gap or a file that is cut gives no distance.
    lasts: the log must cover so many seconds, because one that ends between two messages looks whole. topic and other
    may name an instance: `vehicle_local_position_groundtruth`, `obstacle_position:1`.
    """
    file = Path(path)
    log = _read(file, [name.partition(":")[0] for name in (topic, other) if name])
    second = None if other is None else _track(log, other)
    return closest(_track(log, topic), obstacles, second, gap, lasts)


def _read(file: Path, names: list[str]) -> Any:
    try:
        from pyulog import ULog
    except ImportError as error:
        raise Unreadable(
            f"reading a ULog requires pyulog ({error}); install it: pip install 'clearance[logs]'"
        ) from None
    content = _complete(file)
    try:
        log = ULog(io.BytesIO(content), names)  # of a file that it cannot read it leaves the file open
    except Exception as error:  # pyulog raises many kinds
        raise Unreadable(
            f"{file.name} cannot be read: {' '.join(str(error).split()) or type(error).__name__}"
        ) from None
    if log.file_corruption:
        raise Unreadable(f"{file.name} is corrupt")
    return log


def _complete(file: Path) -> bytes:
    """The content, which ends with a whole message; pyulog reads a cut file up to the cut without a word."""
    try:
        content = file.read_bytes()
    except OSError as error:
        raise Unreadable(f"{file} cannot be read: {error.strerror}") from None
    if not content.startswith(MAGIC) or len(content) < HEADER:
        raise Unreadable(f"{file.name} is not a ULog file")
    at = HEADER
    while at + 3 <= len(content):
        at += 3 + int.from_bytes(content[at : at + 2], "little")
    if at != len(content):
        raise Unreadable(f"{file.name} is cut: its last message is incomplete; what happened after it is unknown")
    return content


def _track(log: Any, topic: str) -> Track:
    name, _, instance = topic.partition(":")
    found = [d for d in log.data_list if d.name == name and d.multi_id == int(instance or 0)]
    if not found:
        raise Unreadable(f"the log has no topic {topic}")
    data = found[0].data
    missing = [field for field in ("timestamp", *"xyz") if field not in data]
    if missing:
        raise Unreadable(f"the topic {topic} has no {', '.join(missing)}")
    times = data["timestamp"].astype(np.float64) * 1e-6
    for field in VALID:
        invalid = np.flatnonzero(data[field] == 0) if field in data else np.empty(0, int)
        if invalid.size:
            raise Unreadable(f"{topic} has no valid position at t = {times[invalid[0]]:.3f} s ({field} is 0)")
    for field in RESETS:
        changed = np.flatnonzero(np.diff(data[field].astype(np.int64))) if field in data else np.empty(0, int)
        if changed.size:
            raise Unreadable(f"the position of {topic} was reset at t = {times[changed[0] + 1]:.3f} s ({field})")
    return Track(topic, times, np.stack([data[field].astype(np.float64) for field in "xyz"], axis=1))
