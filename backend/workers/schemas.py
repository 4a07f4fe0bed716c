"""The API schemas of workers."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Instant, Schema
from backend.runs.schemas import RunDoing


class WorkerOut(Schema):
    """A worker by its last heartbeat."""

    name: str
    host: str
    pid: int
    started: Instant
    """Seconds since 1970."""
    beat: Instant
    """The last heartbeat, seconds since 1970."""
    state: Literal["idle", "busy", "silent"]
    """`silent`: no heartbeat for 20 s, ten times the usual interval."""
    draining: bool
    """Whether it was asked to take no further run and to end."""
    short: bool
    """Whether it begins no run, because too little space is left where it writes."""
    run: str | None
    """The run that it executes, R-0001."""
    stage: str | None
    """The running stage: Search, DIRECT; None between stages."""
    doing: RunDoing | None
    """What it does besides the stages of its run, such as compiling."""
    simulators: list[str]
    """The names of its simulators."""


class Space(Schema):
    """The free space where the service writes."""

    free: int | None
    """In bytes; None if it cannot be read."""
    limit: int
    """Below it no new run begins, in bytes."""
    short: str
    """Why no new run begins, a sentence; empty if there is enough space."""


class Still(Schema):
    """A run that a worker has and that has stored no evaluation for ten minutes."""

    run: str
    """R-0001."""
    since: Instant
    """Its last stored evaluation, seconds since 1970."""


class Workers(Schema):
    """The workers of this database: the live ones, and those that have become silent within ten minutes."""

    now: Instant
    """The time by the clock of the heartbeats, seconds since 1970."""
    alive: int
    last_seen: Instant | None
    """When any worker was last seen, seconds since 1970; None if none is known."""
    queued: int
    """Number of runs that wait for a worker."""
    still: list[Still]
    space: Space
    items: list[WorkerOut]
