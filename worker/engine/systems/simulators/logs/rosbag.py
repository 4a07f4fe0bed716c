"""The separation of two poses, or of one from obstacles, in a recording of ROS 2 (rosbag2 with MCAP storage)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from campaigns.asked.reading import UnreadableError, parse
from worker.engine.systems.simulators.logs.approach import Approach, Column, Sphere, Track, Unreadable, closest

METADATA = "metadata.yaml"
"""What rosbag2 writes into the folder when it ends a recording."""
Rows = list[tuple[float, float, float, float]]
"""Time [s], x, y, z [m]."""
POSITIONS = {
    "geometry_msgs/msg/PointStamped": ("point",),
    "geometry_msgs/msg/PoseStamped": ("pose", "position"),
    "geometry_msgs/msg/PoseWithCovarianceStamped": ("pose", "pose", "position"),
    "nav_msgs/msg/Odometry": ("pose", "pose", "position"),
}
"""Where a message has its position, by type."""


def separation_of_mcap(
    path: str | os.PathLike[str],
    topic: str,
    other: str | None = None,
    obstacles: Sequence[Sphere | Column] = (),
    gap: float = 0.5,
    lasts: float = 0.0,
) -> Approach:
    """The closest approach of the positions on a topic to those on another and to obstacles; raises Unreadable.

    path: an .mcap file, or the folder of a recording, whose files must be those that its metadata names. Times are
    those of the headers, and both topics must have the same frame, as have obstacles. lasts: the log must cover so many
    seconds. A gap, a change of frame or a file that is cut or missing gives no distance.
    """
    frames: dict[str, str] = {}
    tracks = _tracks(Path(path), [name for name in (topic, other) if name], frames)
    if other is not None and frames[topic] != frames[other]:
        raise Unreadable(
            f"{topic} is in the frame {frames[topic]!r}, {other} in {frames[other]!r}; one frame is expected"
        )
    return closest(tracks[topic], obstacles, tracks[other] if other else None, gap, lasts)


def _files(path: Path) -> list[Path]:
    """The files of a recording; of a folder, all that its metadata names, and no others."""
    found = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
    if not found:
        raise Unreadable(f"{path} holds no .mcap file")
    if path.is_dir() and (path / METADATA).exists():
        named = _named(path / METADATA)
        if missing := sorted(named - {file.name for file in found}):
            raise Unreadable(f"{METADATA} names {missing[0]}, which is not in {path}: what happened in it is unknown")
        if others := [file.name for file in found if file.name not in named]:
            raise Unreadable(f"{path} holds {others[0]}, which {METADATA} does not name; one recording is expected")
    return found


def _named(file: Path) -> set[str]:
    """The files that the metadata of a recording names."""
    try:
        names = parse(file.read_text(encoding="utf-8"))["rosbag2_bagfile_information"]["relative_file_paths"]
        if names and all(isinstance(name, str) for name in names):
            return set(names)
        why = "relative_file_paths names no file"
    except UnreadableError as error:
        why = f"{error.problem.field} {error.problem.message}".strip()
    except (OSError, ValueError) as error:
        why = " ".join(str(error).split())
    except (KeyError, TypeError):
        why = "it has no relative_file_paths"
    raise Unreadable(f"{file} does not state the files of the recording: {why}")


def _tracks(path: Path, topics: list[str], frames: dict[str, str]) -> dict[str, Track]:
    """The tracks by topic; fills in the frame of each."""
    parts: dict[str, list[Rows]] = {topic: [] for topic in topics}
    for file in _files(path):
        try:
            for topic, rows in _read(file, topics, frames).items():
                parts[topic].append(rows)
        except Unreadable:
            raise
        except ImportError as error:
            text = f"reading a recording requires mcap and mcap-ros2-support ({error})"
            raise Unreadable(f"{text}; install them: pip install 'clearance[logs]'") from None
        except Exception as error:  # mcap raises many kinds for a file that is cut or corrupt
            what = " ".join(str(error).split()) or type(error).__name__
            raise Unreadable(f"{file.name} cannot be read to its end: {what}") from None
    found = {}
    for topic, pieces in parts.items():
        if not pieces:
            raise Unreadable(f"the recording has no message on {topic}")
        pieces.sort(key=lambda rows: rows[0])  # the names of a split recording sort _10 before _2
        table = np.array([row for rows in pieces for row in rows])
        found[topic] = Track(topic, table[:, 0], table[:, 1:])
    return found


def _read(file: Path, topics: list[str], frames: dict[str, str]) -> dict[str, Rows]:
    """The samples of one file by topic, in the order of the recording; topics without any are left out."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    samples: dict[str, Rows] = {}
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        if reader.get_summary() is None:
            raise Unreadable(
                f"{file.name} is cut: it has no summary at its end; what happened after the cut is unknown"
            )
        for schema, channel, _, message in reader.iter_decoded_messages(topics=topics):
            kind = schema.name if schema else "no type"
            if kind not in POSITIONS:
                raise Unreadable(f"{channel.topic} has messages of {kind}; {', '.join(POSITIONS)} are expected")
            frame = message.header.frame_id
            if frames.setdefault(channel.topic, frame) != frame:
                raise Unreadable(f"{channel.topic} changes its frame from {frames[channel.topic]!r} to {frame!r}")
            samples.setdefault(channel.topic, []).append(_sample(message, POSITIONS[kind]))
    return samples


def _sample(message: Any, where: tuple[str, ...]) -> tuple[float, float, float, float]:
    stamp, position = message.header.stamp, message
    for field in where:
        position = getattr(position, field)
    return stamp.sec + 1e-9 * stamp.nanosec, position.x, position.y, position.z
