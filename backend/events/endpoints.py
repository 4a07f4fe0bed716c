"""GET /events: progress as server-sent events. Start reading at `stream_events`."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from backend.db.engine import read
from backend.deps import Engine
from backend.errors import problems
from backend.runs import service

router = APIRouter(tags=["events"])
STREAM: dict[int | str, dict[str, Any]] = {
    200: {"description": "A stream of events.", "content": {"text/event-stream": {"schema": {"type": "string"}}}}
}

HEADERS = {"X-Accel-Buffering": "no", "Connection": "close"}
"""No proxy holds events back; and the connection ends with the stream, or it would hold up the service's stop."""


class EventStream(StreamingResponse):
    """A stream of server-sent events."""

    media_type = "text/event-stream"


@router.get(
    "/events",
    response_class=EventStream,
    responses=STREAM | problems("not-found", "purged"),
)
async def stream_events(
    request: Request,
    engine: Engine,
    run: Annotated[str | None, Query(max_length=40, description="Only this run, such as R-0001.")] = None,
) -> EventStream:
    """Changes as they happen, at most four times a second; comments every 15 s keep the stream alive.

    `event: run` carries a RunSummary. With `run=` there are also `event: stages` with StageProgress[] and
    `event: evaluations` with {position: NewImprovements}. The first events after connecting tell everything.
    """
    run_id = None if run is None else service.number(run)
    if run_id is not None:
        await run_in_threadpool(_require, engine, run_id)
    return EventStream(request.app.state.hub.listen(run_id), headers=HEADERS)


def _require(engine: Engine, run_id: int) -> None:
    with read(engine) as reader:
        service.require(reader, run_id)
