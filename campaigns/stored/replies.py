"""The replies of the processes that simulate for the service: their JSON as types, for the side that writes it and the
one that reads it."""

from __future__ import annotations

from typing import Any, TypedDict

from campaigns.results.base import Status


class FlightReply(TypedDict):
    """A simulated flight; numbers that are not finite are None."""

    status: Status
    reason: str
    cost: float | None
    margin: float | None
    columns: list[dict[str, Any]]
    """Each a `TraceColumn`."""
    data: dict[str, list[float | None]]
    meta: dict[str, Any]
    """A `TraceHead`."""
    identity: object
    """An `Identity`: the code that simulated it."""


class CaseReply(FlightReply):
    """A case that a simulator has evaluated."""

    seconds: float
    """The time of the call [s]."""
    untraced: str
    """Why there is no trace; empty if there is one or the simulator gives none."""


class FieldReply(TypedDict):
    """The demand of the avoider at positions in a plane, at a time of a flight; all in the flight's axes."""

    time: float
    place: list[float]
    """The vehicle's position."""
    velocity: list[float | None]
    kind: str
    memory: int
    """Size of the avoider's memory."""
    unit: str
    own: list[float] | None
    """The demand at the vehicle's own position."""
    demand: list[list[float] | None]
    identity: object
    """An `Identity`: the code that computed it."""


class InstalledReply(TypedDict):
    """Whether a simulator can be evaluated here."""

    missing: str
    """Why not; empty if it can."""
