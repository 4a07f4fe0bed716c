"""What-if requests and open 3D views: the view that a request names, and drawing its answer there."""

from __future__ import annotations

import contextlib

from fastapi import Request

from backend.access.auth import CurrentVisitor
from backend.flights.turns import Turn
from backend.runs.service import number
from backend.scenes.base.flight import from_live
from backend.scenes.control.viewers import Handle
from backend.scenes.viewer.viewer import GoneError, Viewer
from campaigns.stored.replies import FlightReply


async def viewer_of(request: Request, visitor: CurrentVisitor, run: str, view: str | None) -> Viewer | None:
    """The open view of this key, of this visitor and run; None if none is named or open."""
    if view is None:
        return None
    found: Viewer | None = await request.app.state.viewers.find(Handle(visitor, number(run), view), 0.0)
    return found


def drew(viewer: Viewer | None, answer: FlightReply, seed: int | None, turn: Turn) -> bool:
    """Draw the answer as the what-if unless a newer request has overtaken it; whether it was drawn."""
    if viewer is None or turn.overtaken.is_set():
        return False
    with contextlib.suppress(GoneError):  # the view was closed meanwhile; the answer is valid without it
        viewer.show_what_if(from_live(answer), seed, turn.order)
        return True
    return False
