"""A flight as the scene needs it, from a stored trace or from a live answer. Start reading at `Flight`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.results import service as results
from backend.results import thin

Floats = NDArray[np.float64]

ROWS = 800
"""A drawn flight has at most so many points."""

_POSE = ("x", "y", "z", "roll", "pitch", "yaw")


@dataclass(frozen=True)
class Closest:
    """The closest approach: when [s], how near, where, and where the obstacle was."""

    time: float
    value: float
    position: Floats
    obstacle: Floats


@dataclass(frozen=True, eq=False)
class Flight:
    """Poses over time [s], [m], [rad] and the separation; only rows whose pose is finite."""

    time: Floats
    position: Floats
    """(m, 3)"""
    rotation: Floats
    """(m, 3): roll, pitch, yaw."""
    separation: Floats
    closest: Closest | None
    cost: float | None
    status: str
    reason: str

    def at(self, time: float) -> tuple[Floats, Floats, float]:
        """Position, rotation and separation at a time, between rows linearly, held before and after the flight."""
        position = np.array([np.interp(time, self.time, self.position[:, k]) for k in range(3)])
        turned = np.unwrap(self.rotation, axis=0)
        rotation = np.array([np.interp(time, self.time, turned[:, k]) for k in range(3)])
        return position, rotation, float(np.interp(time, self.time, self.separation))


def from_stored(row: Any) -> Flight | None:
    """The flight of a row of the table of traces."""
    data = results.table(row)
    chosen = thin.around(len(data), ROWS, results.closest_row(row.meta, row.columns, data))
    columns = {column["name"]: data[chosen, k] for k, column in enumerate(row.columns)}
    return _flight(row.columns, columns, row.meta)


def from_live(answer: Mapping[str, Any]) -> Flight | None:
    """The flight of an answer of the simulation process; None when it never left the ground."""
    columns = {name: np.array(values, dtype=np.float64) for name, values in answer["data"].items()}
    return _flight(answer["columns"], columns, answer["meta"])


def _flight(
    described: Sequence[Mapping[str, Any]], columns: Mapping[str, Floats], meta: Mapping[str, Any]
) -> Flight | None:
    names = {str(column["group"]): str(column["name"]) for column in described}
    time = columns[names["time"]]
    pose = np.column_stack([columns.get(name, np.zeros(len(time))) for name in _POSE])
    separation = columns[names["separation"]] if "separation" in names else np.full(len(time), np.nan)
    known = np.isfinite(pose).all(axis=1)
    if known.sum() < 2:
        return None
    return Flight(
        time=time[known],
        position=pose[known, :3],
        rotation=pose[known, 3:],
        separation=separation[known],
        closest=_closest(meta.get("closest")),
        cost=meta.get("cost"),
        status=str(meta.get("status", "ok")),
        reason=str(meta.get("reason", "")),
    )


def _closest(meta: Mapping[str, Any] | None) -> Closest | None:
    if not meta or meta.get("value") is None or meta.get("obstacle_position") is None:
        return None
    position, obstacle = (np.array(meta[key], dtype=np.float64) for key in ("position", "obstacle_position"))
    return Closest(float(meta["time"]), float(meta["value"]), position, obstacle)
