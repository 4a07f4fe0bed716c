"""What-if requests and open 3D views: the view that a request names, and drawing its answer there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from functools import partial
from typing import Protocol, TypeVar

from fastapi import Request

from backend.db.access import Visitor
from backend.flights.turns import Turn, Turns
from backend.http.capacity import Capacity
from backend.runs.service import number
from backend.scenes.base.flight import from_live
from backend.scenes.control.viewers import Handle
from backend.scenes.viewer.viewer import GoneError, Viewer
from campaigns.stored.replies import FlightReply

Answer = TypeVar("Answer")


WHAT_IF = (
    "not-found", "flight-overtaken", "other-version", "purged", "unknown-finding", "unknown-parameter",
    "outside-limits", "not-flyable", "busy",
)  # fmt: skip
"""The problem types of every what-if request."""


class Client(Protocol):
    """The fields of a request that name its open view and its client."""

    view: str | None
    client: str | None


async def in_turn(
    request: Request,
    visitor: Visitor,
    run: str,
    client: Client,
    capacity: Capacity,
    work: Callable[[Viewer | None, Turn], Answer],
) -> Answer:
    """The answer of a what-if request when its turn comes, drawn in the open view of this visitor that it names."""
    turns: Turns = request.app.state.turns
    viewer: Viewer | None = None
    if client.view is not None:
        viewer = await request.app.state.viewers.find(Handle(visitor, number(run), client.view), 0.0)
    named = (visitor.key, run, client.client or client.view)
    return await turns.run(visitor.account, named, capacity, partial(work, viewer), request.is_disconnected)


def drew(viewer: Viewer | None, answer: FlightReply, seed: int | None, turn: Turn) -> bool:
    """Draw the answer as the what-if unless a newer request has overtaken it; whether it was drawn."""
    if viewer is None or turn.overtaken.is_set():
        return False
    with contextlib.suppress(GoneError):  # the view was closed meanwhile; the answer is valid without it
        viewer.show_what_if(from_live(answer), seed, turn.order)
        return True
    return False
