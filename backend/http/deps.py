"""Dependencies of endpoints: a read-only connection, and the engine for writes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

import sqlalchemy as sa
from fastapi import Depends, Request

from backend.db.engine import read
from backend.http.capacity import Capacities


async def engine(request: Request) -> sa.Engine:
    """The service's engine; `with engine.begin()` writes. A coroutine: plain functions run in the thread pool."""
    found = request.app.state.engine
    assert isinstance(found, sa.Engine)
    return found


Engine = Annotated[sa.Engine, Depends(engine)]


def reader(engine: Engine) -> Iterator[sa.Connection]:
    """One snapshot of the database for the whole request."""
    with read(engine) as connection:
        yield connection


def capacities(request: Request) -> Capacities:
    found = request.app.state.capacities
    assert isinstance(found, Capacities)
    return found


Reader = Annotated[sa.Connection, Depends(reader)]
