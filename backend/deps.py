"""What endpoints are given: a reading connection, the engine to write with. Start reading at `Reader`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

import sqlalchemy as sa
from fastapi import Depends, Request

from backend.db.engine import read


def engine(request: Request) -> sa.Engine:
    """The service's engine; `with engine.begin()` writes."""
    found = request.app.state.engine
    assert isinstance(found, sa.Engine)
    return found


def reader(request: Request) -> Iterator[sa.Connection]:
    """One snapshot of the database for the whole request."""
    with read(engine(request)) as connection:
        yield connection


Reader = Annotated[sa.Connection, Depends(reader)]
Engine = Annotated[sa.Engine, Depends(engine)]
