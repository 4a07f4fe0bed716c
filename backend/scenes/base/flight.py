"""A flight for the scene, from a stored trace or a live simulation."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from backend.http.versions import readable
from backend.results import service as results
from backend.scenes.base.axes import Axes, Floats, axes_of
from backend.scenes.base.declaration import axes_in, motion
from campaigns import thin
from campaigns.identity.identity import Identity
from campaigns.results import TraceHead
from campaigns.results.base import Status
from campaigns.results.scene import Scene
from campaigns.results.trace import Closest as StoredClosest
from campaigns.results.trace import TraceColumn
from campaigns.stored.replies import FlightReply

ROWS = 800
"""Maximum number of points of a drawn flight."""

_POSE = ("x", "y", "z", "roll", "pitch", "yaw")
_TRACK = re.compile(r"obstacle\.([0-9]+)\.x")


@dataclass(frozen=True)
class Closest:
    """The closest approach: time [s], value, position and obstacle position in scene coordinates."""

    time: float
    value: float
    position: Floats
    obstacle: Floats
    number: int = 0
    """The number of the obstacle."""


@dataclass(frozen=True, eq=False)
class Flight:
    """Poses over time [s], [m], [rad] and separation; only rows with a finite pose. In scene coordinates."""

    axes: Axes
    time: Floats
    position: Floats
    """(m, 3)"""
    rotation: Floats
    """(m, 3): roll, pitch, yaw in the flight's own axes."""
    separation: Floats
    tracks: dict[int, Floats]
    """The track of the centre of each moving obstacle (m, 3), by its number."""
    parameters: dict[str, float]
    """The parameters of this flight by path; omitted ones are nominal."""
    closest: Closest | None
    cost: float | None
    status: str
    reason: str
    seed: int | None = None
    """Seed of its noise realisation; None without randomness."""
    seeds: int = 1
    """The number of realisations of which it is the lowest."""
    turns: Floats | None = None
    """(m, 4): w, x, y, z in scene coordinates, in place of `rotation`."""
    identity: Identity | None = None
    """Of the code that simulated it now; None of a stored one, which is of the code of its run."""

    @property
    def ok(self) -> bool:
        """Whether its evaluation has a value."""
        return self.status == Status.OK

    def at(self, time: float) -> tuple[Floats, Floats, float]:
        """Position, turn (w, x, y, z), separation at a time [s]: linear between rows, constant before and after."""
        separation = float(np.interp(time, self.time, self.separation))
        return _between(time, self.time, self.position), self._turn(time), separation

    def _turn(self, time: float) -> Floats:
        if self.turns is None:
            return self.axes.attitude(_between(time, self.time, self._angles))
        return _unit(_between(time, self.time, self.turns))

    @cached_property
    def _angles(self) -> Floats:
        """`rotation` without jumps of a full turn: interpolated for every frame and every message."""
        return np.unwrap(self.rotation, axis=0)

    @cached_property
    def attitudes(self) -> Floats:
        """(m, 4): the turn (w, x, y, z) at every row, as `at` gives it there."""
        return self.axes.attitude(self._angles) if self.turns is None else _unit(self.turns)

    def obstacle(self, number: int, time: float) -> Floats:
        return _between(time, self.time, self.tracks[number])

    def velocity(self, time: float) -> Floats:
        """Velocity over ground at a time (3,) in scene coordinates [m/s], including wind."""
        return _between(time, self.time, self._velocity)

    def obstacle_velocity(self, number: int, time: float) -> Floats:
        """Velocity of a moving obstacle's centre at a time (3,) in scene coordinates [m/s]."""
        return _between(time, self.time, self._track_velocities[number])

    @property
    def typical_speed(self) -> float:
        return float(np.median(np.linalg.norm(self._velocity, axis=1)))

    @cached_property
    def _velocity(self) -> Floats:
        return rate(self.time, self.position)

    @cached_property
    def _track_velocities(self) -> dict[int, Floats]:
        return {number: rate(self.time, track) for number, track in self.tracks.items()}


def rate(time: Floats, rows: Floats) -> Floats:
    """Derivative of rows (m, k) with respect to time (m,): the slope of the parabola through a row and its two
    neighbours, of the line at the ends. Rows at the same time share their slope."""
    distinct, first = np.unique(time, return_index=True)
    if len(distinct) < 2:
        return np.zeros_like(rows)
    slopes = np.gradient(rows[first], distinct, axis=0)
    found: Floats = slopes[np.searchsorted(distinct, time)]
    return found


def _unit(turns: Floats) -> Floats:
    found: Floats = turns / np.maximum(np.linalg.norm(turns, axis=-1, keepdims=True), 1e-12)
    return found


def _between(time: float, times: Floats, rows: Floats) -> Floats:
    return np.array([np.interp(time, times, rows[:, k]) for k in range(rows.shape[1])])


def from_stored(row: Any, most: int = ROWS) -> Flight | None:
    """The flight of a row of the traces table, thinned to `most` rows."""
    data = results.table(row)
    with readable("a flight of this run"):
        head, described = TraceHead.model_validate(row.meta), [TraceColumn.model_validate(c) for c in row.columns]
    chosen = thin.around(len(data), most, results.closest_row(head, described, data))
    columns = {column.name: data[chosen, k] for k, column in enumerate(described)}
    return _flight(described, columns, head)


def from_live(answer: FlightReply) -> Flight | None:
    """The flight of a response of the simulation process; None if it has no motion."""
    columns = {name: np.array(values, dtype=np.float64) for name, values in answer["data"].items()}
    described = [TraceColumn.model_validate(column) for column in answer["columns"]]
    flight = _flight(described, columns, TraceHead.model_validate(answer["meta"]))
    return flight and replace(flight, identity=Identity.model_validate(answer["identity"]))


def _flight(described: Sequence[TraceColumn], columns: Mapping[str, Floats], head: TraceHead) -> Flight | None:
    if any(column.group == "signal" for column in described):
        return None if head.scene is None else _of_simulator(described, columns, head, head.scene)
    names: dict[str, str] = {column.group: column.name for column in described}
    if "time" not in names:  # a case of a simulator without a trace
        return None
    time = columns[names["time"]]
    pose = np.column_stack([columns.get(name, np.zeros(len(time))) for name in _POSE])
    separation = columns[names["separation"]] if "separation" in names else np.full(len(time), np.nan)
    tracks = _tracks(columns)
    known = np.isfinite(np.column_stack([pose, *tracks.values()])).all(axis=1)
    if known.sum() < 2:
        return None
    axes, realised = axes_of(head.frame), head.realisation
    return Flight(
        axes=axes,
        time=time[known],
        position=axes.drawn(pose[known, :3]),
        rotation=pose[known, 3:],
        separation=separation[known],
        tracks={number: axes.drawn(track[known]) for number, track in tracks.items()},
        closest=_closest(head.approach, axes),
        parameters=head.parameters,
        cost=head.cost,
        status=head.status,
        reason=head.reason,
        seed=None if realised is None else realised.seed,
        seeds=1 if realised is None else realised.seeds,
    )


def _of_simulator(
    described: Sequence[TraceColumn], columns: Mapping[str, Floats], head: TraceHead, scene: Scene
) -> Flight | None:
    """The motion that a simulator declares; None if fewer than two rows have all positions."""
    time = columns[next(column.name for column in described if column.group == "time")]
    found = motion(scene, columns, {column.name: column.unit for column in described}, time)
    count = int(found.rows.sum())
    if count < 2:
        return None
    return Flight(
        axes=axes_in(scene),
        time=time[found.rows],
        position=found.position,
        rotation=np.zeros((count, 3)),
        separation=np.full(count, np.nan),
        tracks=found.tracks,
        closest=None,
        parameters=head.parameters,
        cost=head.cost,
        status=head.status,
        reason=head.reason,
        turns=found.turns,
    )


def _tracks(columns: Mapping[str, Floats]) -> dict[int, Floats]:
    """The columns obstacle.0.x, .y, .z by obstacle, each (m, 3)."""
    numbers = [int(found[1]) for name in columns if (found := _TRACK.fullmatch(name))]
    return {i: np.column_stack([columns[f"obstacle.{i}.{axis}"] for axis in "xyz"]) for i in numbers}


def _closest(stored: StoredClosest | None, axes: Axes) -> Closest | None:
    if stored is None:
        return None
    position, obstacle = (np.array(place) for place in (stored.position, stored.obstacle_position))
    return Closest(stored.time, stored.value, axes.drawn(position), axes.drawn(obstacle), stored.obstacle)
