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
ORIGIN = ("ref_lat", "ref_lon", "ref_alt")
"""Where on the Earth x, y and z count from."""
MOVED = ("ref_timestamp", *ORIGIN)


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
    same frame. An invalid position, a reset of the estimate, an origin that moves or is not that of the other topic, a
    gap or a file that is cut gives no distance.
    lasts: the log must cover so many seconds, because one that ends between two messages looks whole. topic and other
    may name an instance: `vehicle_local_position_groundtruth`, `obstacle_position:1`.
    """
    file = Path(path)
    log = _read(file, [name.partition(":")[0] for name in (topic, other) if name])
    second = None if other is None else _track(log, other)
    first = _track(log, topic)
    if other is not None:
        _same_origin(log, topic, other)
    return closest(first, obstacles, second, gap, lasts)


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
    data = _data(log, topic)
    missing = [field for field in ("timestamp", *"xyz") if field not in data]
    if missing:
        raise Unreadable(f"the topic {topic} has no {', '.join(missing)}")
    times = data["timestamp"].astype(np.float64) * 1e-6
    for field in VALID:
        invalid = np.flatnonzero(data[field] == 0) if field in data else np.empty(0, int)
        if invalid.size:
            raise Unreadable(f"{topic} has no valid position at t = {times[invalid[0]]:.3f} s ({field} is 0)")
    for field in (*RESETS, *MOVED):
        changed = np.flatnonzero(_differs(data[field][1:], data[field][:-1])) if field in data else np.empty(0, int)
        if changed.size:
            what = f"the origin of {topic} changed" if field in MOVED else f"the position of {topic} was reset"
            raise Unreadable(f"{what} at t = {times[changed[0] + 1]:.3f} s ({field})")
    return Track(topic, times, np.stack([data[field].astype(np.float64) for field in "xyz"], axis=1))


def _data(log: Any, topic: str) -> Any:
    """The fields of a topic by name."""
    name, _, instance = topic.partition(":")
    found = [d for d in log.data_list if d.name == name and d.multi_id == int(instance or 0)]
    if not found:
        raise Unreadable(f"the log has no topic {topic}")
    return found[0].data


def _same_origin(log: Any, topic: str, other: str) -> None:
    """Two topics whose positions count from the same place, as far as both state one, which neither has changed."""
    one, two = _data(log, topic), _data(log, other)
    for field in ORIGIN:
        if field in one and field in two and _differs(one[field][0], two[field][0]):
            raise Unreadable(
                f"{topic} has the origin {field} {one[field][0]}, {other} has {two[field][0]}; one frame is expected"
            )


def _differs(one: Any, two: Any) -> Any:
    """Which rows differ: where two values are not the same; an origin that is not known is NaN in both."""
    return (one != two) & ~((one != one) & (two != two))
