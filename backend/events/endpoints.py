"""GET /events: progress as server-sent events."""

from __future__ import annotations

import contextlib
import re
import time
from collections.abc import AsyncGenerator, Awaitable, Callable
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from backend.access.auth import CurrentVisitor, too_many
from backend.access.shares import Shares
from backend.db.access import Visitor
from backend.db.engine import ask
from backend.http.deps import Engine
from backend.http.errors import answers, problems
from backend.runs import service

router = APIRouter(tags=["events"])

_MARK = re.compile(r"[0-9]{1,12}\.[0-9]{3}")

CHECK_PERIOD = 10.0
"""Interval at which the visitor's access is checked again, at least at every heartbeat [s]."""

HEADERS = {"X-Accel-Buffering": "no", "Connection": "close"}
"""Disables buffering by proxies, and closes the connection with the stream so that it does not delay the shutdown."""


class EventStream(StreamingResponse):
    media_type = "text/event-stream"


class CountedStream(EventStream):
    """A stream that counts as one of its visitor's while it lasts; 429 if those are too many."""

    def __init__(self, texts: AsyncGenerator[str], shares: Shares, visitor: Visitor) -> None:
        super().__init__(texts, headers=HEADERS)
        self._shares, self._visitor = shares, visitor

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if full := self._shares.full(self._visitor):
            raise too_many(full)
        with self._shares.entered(self._visitor):
            await super().__call__(scope, receive, send)


@router.get(
    "/events",
    response_class=EventStream,
    responses=answers("A stream of events.", "text/event-stream") | problems("not-found", "purged"),
)
async def stream_events(
    request: Request,
    engine: Engine,
    visitor: CurrentVisitor,
    run: Annotated[str | None, Query(max_length=40, description="Only this run, such as R-0001.")] = None,
    last: Annotated[
        str | None, Header(alias="Last-Event-ID", description="The last `id` before; sent by browsers.")
    ] = None,
) -> EventStream:
    """Changes as they happen, at most four times a second; a silent stream carries `event: beat` every 15 s.

    Every event has an `id`; with it as `Last-Event-ID` a stream resumes: active runs are reported again, and every run
    that ended meanwhile (the newest 500). An invalid id is ignored.

    `event: run` carries a RunSummary, `event: workers` Workers. With `run=` there are also `event: stages` with
    StageProgress[] and `event: evaluations` with {position: NewImprovements}. The first events after connecting carry
    the full state.
    """
    run_id = None if run is None else service.number(run)
    if run_id is not None:
        await run_in_threadpool(ask, engine, lambda reader: service.require(reader, run_id))
    state = request.app.state
    events = state.hub.listen(run_id, _since(last))
    return CountedStream(_while_admitted(events, request.state.still), state.streams, visitor)


def _since(mark: str | None) -> float | None:
    """The time of a mark; None if invalid, because a browser does not reconnect after a refusal."""
    return float(mark) if mark is not None and _MARK.fullmatch(mark) else None


async def _while_admitted(events: AsyncGenerator[str], still: Callable[[], Awaitable[bool]]) -> AsyncGenerator[str]:
    """The events until the visitor's session or token ends; a silent stream has a beat at every heartbeat."""
    checked = time.monotonic()
    async with contextlib.aclosing(events):
        async for text in events:
            if time.monotonic() - checked >= CHECK_PERIOD:
                if not await still():
                    return
                checked = time.monotonic()
            yield text
