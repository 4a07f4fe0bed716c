"""Dependencies of endpoints: a read-only connection, and the engine for writes."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

import sqlalchemy as sa
from anyio import CancelScope
from fastapi import Depends, Request

from backend.db import space
from backend.db.engine import read
from backend.http.capacity import Capacities
from backend.http.errors import RefusedError


async def engine(request: Request) -> sa.Engine:
    """The service's engine; `with engine.begin()` writes. A coroutine: plain functions run in the thread pool."""
    found = request.app.state.engine
    assert isinstance(found, sa.Engine)
    return found


Engine = Annotated[sa.Engine, Depends(engine)]


async def reader(request: Request, engine: Engine) -> AsyncIterator[sa.Connection]:
    """One snapshot of the database for the whole request."""
    reads = capacities(request).reads
    async with reads.turn(account(request)):
        reading = read(engine)
        connection = await reads.thread(reading.__enter__)
        try:
            yield connection
        finally:
            with CancelScope(shield=True):
                await reads.thread(lambda: reading.__exit__(None, None, None))


def account(request: Request) -> str:
    """Whose request it is; empty before anybody has signed in."""
    visitor = getattr(request.state, "visitor", None)
    return "" if visitor is None else str(visitor.account)


def capacities(request: Request) -> Capacities:
    found = request.app.state.capacities
    assert isinstance(found, Capacities)
    return found


Reader = Annotated[sa.Connection, Depends(reader)]


def where(request: Request) -> space.Room:
    """The folders to which the service writes."""
    found = request.app.state.room
    assert isinstance(found, space.Room)
    return found


def room(request: Request) -> None:
    """Refuses what begins a run while there is little space (503)."""
    if why := where(request).short():
        raise RefusedError("no-space", why, headers={"Retry-After": "60"})


ROOM = [Depends(room)]
"""For `dependencies=` of a route."""
