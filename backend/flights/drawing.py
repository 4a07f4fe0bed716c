"""What-if requests and open 3D views: the view that a request names, and drawing its answer there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Protocol, TypeVar

import sqlalchemy as sa
from fastapi import Request

from backend.db.access import Visitor
from backend.db.engine import ask
from backend.flights.case import Case
from backend.flights.turns import Turn, Turns
from backend.http.capacity import Capacity
from backend.runs.service import number
from backend.scenes.base.flight import from_live
from backend.scenes.control.viewers import Handle
from backend.scenes.viewer.viewer import GoneError, Viewer
from campaigns.stored.replies import FlightReply

Answer = TypeVar("Answer")
Reply = TypeVar("Reply", bound=FlightReply)


WHAT_IF = (
    "not-found", "flight-overtaken", "other-version", "purged", "unknown-finding", "unknown-parameter",
    "outside-limits", "not-flyable", "busy",
)  # fmt: skip
"""The problem types of every what-if request."""


class WhatIf(Protocol):
    """The fields of a request that name its open view and its client, and how many rows it wants."""

    view: str | None
    client: str | None
    rows: int


async def in_turn(
    request: Request,
    visitor: Visitor,
    run: str,
    what_if: WhatIf,
    capacity: Capacity,
    wanted: Callable[[sa.Connection], Case],
    simulated: Callable[[Case], Reply],
    response: Callable[[sa.Connection, Case, Reply, str | None, int], Answer],
) -> Answer:
    """The answer of a what-if request when its turn comes, drawn in the open view of this visitor that it names."""
    viewer: Viewer | None = None
    if what_if.view is not None:
        viewer = await request.app.state.viewers.find(Handle(visitor, number(run), what_if.view), 0.0)

    def work(turn: Turn) -> Answer:
        case = ask(request.app.state.engine, wanted)
        answer = simulated(case)
        drawn = what_if.view if _drew(viewer, answer, case.seed, turn) else None
        return ask(request.app.state.engine, lambda reader: response(reader, case, answer, drawn, what_if.rows))

    turns: Turns = request.app.state.turns
    named = (visitor.key, run, what_if.client or what_if.view)
    return await turns.run(visitor.account, named, capacity, work, request.is_disconnected)


def _drew(viewer: Viewer | None, answer: FlightReply, seed: int | None, turn: Turn) -> bool:
    """Draw the answer as the what-if unless a newer request has overtaken it; whether it was drawn."""
    if viewer is None or turn.overtaken.is_set():
        return False
    with contextlib.suppress(GoneError):  # the view was closed meanwhile; the answer is valid without it
        viewer.show_what_if(from_live(answer), seed, turn.order)
        return True
    return False
