"""Recordings on demand, and the page at /view/R-0001/F1/recorded/ that plays one without a viewer server.

The most recent ones are cached.
"""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from dataclasses import dataclass
from pathlib import Path

import sqlalchemy as sa
import viser
from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import RedirectResponse, Response

from backend.catalog.service import published_digest
from backend.db.digest import results_digest
from backend.db.engine import ask
from backend.db.tables import Finding
from backend.http.capacity import Capacity, Gone
from backend.http.deps import account
from backend.http.errors import RefusedError, not_found
from backend.http.naming import disposition, named
from backend.http.root import at
from backend.results import service as results
from backend.runs.service import number, summary
from backend.scenes.base import setting
from backend.scenes.base.address import parse
from backend.scenes.base.dress import OPENED_ALONE, SANDBOX, font_inside
from backend.scenes.base.flight import from_stored
from backend.scenes.recordings.caption import POLICY, Caption, with_caption
from backend.scenes.recordings.recording import Cast, record
from campaigns.results.verdict import headline
from campaigns.version import VERSION

router = APIRouter(include_in_schema=False)

KEPT = 8
"""Number of cached pages, each about 0.9 MB."""


@dataclass(frozen=True)
class Recorded:
    html: str
    tag: str
    file: str


@dataclass(frozen=True)
class _RecordingRequest:
    setting: setting.Setting
    cast: Cast
    caption: Caption
    tag: str


class Recordings:
    def __init__(self, engine: sa.Engine, capacity: Capacity, pages: Path) -> None:
        self._engine, self._capacity, self._pages = engine, capacity, pages
        self._lock = threading.Lock()
        self._kept: OrderedDict[str, str] = OrderedDict()

    async def page(
        self, account: str, run_id: int, flight: str, dark: bool = False, known: str = "", gone: Gone | None = None
    ) -> Recorded | str:
        """The page of a flight, "F1" or "nominal"; only its tag if the client has it.

        404 if there is no such run or stored flight; 503 if too many are being created.
        account, gone: as in `Capacity.run`.
        """
        request = await run_in_threadpool(
            ask, self._engine, lambda reader: _recording_request(reader, run_id, flight, dark)
        )
        if request.tag in known:
            return request.tag
        page = self._recall(request.tag)
        if page is None:
            page = await self._capacity.run(account, lambda: self._made(request, dark), gone)
        return Recorded(page, request.tag, named(request.caption.run, request.caption.name, f"flight-{flight}.html"))

    def _made(self, request: _RecordingRequest, dark: bool) -> str:
        page = self._recall(request.tag)  # created while this request waited
        if page is None:
            made = record(request.setting, request.cast, dark)
            page = with_caption(made, request.setting, request.cast, request.caption, dark, font_inside(self._pages))
        with self._lock:
            self._kept[request.tag] = page
            if len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return page

    def _recall(self, tag: str) -> str | None:
        with self._lock:
            if tag in self._kept:
                self._kept.move_to_end(tag)
            return self._kept.get(tag)


def _recording_request(reader: sa.Connection, run_id: int, label: str, dark: bool) -> _RecordingRequest:
    run = summary(reader, run_id)
    row = results.stored(reader, run_id, label)
    if row is not None:
        setting.drawable(reader, run_id)
    flight = None if row is None else from_stored(row)
    if flight is None:
        raise _absent(run.id, label, row is not None)
    other = results.stored(reader, run_id, setting.NOMINAL) if label != setting.NOMINAL else None
    cast = Cast(label, flight, None if other is None else from_stored(other))
    caption = Caption(
        run.id,
        run.name,
        headline(run.verdict, run, run.policy, run.against) if run.verdict else run.state,
        run.campaign_digest,
        results_digest(reader, run_id),
        _costs(reader, run_id, run.nominal_cost),
    )
    described_by = published_digest(reader)
    parts = (*map(str, vars(caption).values()), label, str(dark), VERSION, viser.__version__, described_by)
    tag = hashlib.sha256("\n".join(parts).encode()).hexdigest()
    return _RecordingRequest(setting.load(reader, run_id), cast, caption, f'W/"{tag}"')


def _absent(run: str, label: str, stored: bool) -> RefusedError:
    if not stored:
        return not_found("stored flight of this run called", label)
    text = f"the trace {label} of {run} has fewer than two rows with all positions: there is nothing to record"
    return RefusedError("not-found", text)


def _costs(reader: sa.Connection, run_id: int, nominal: float | None) -> dict[str, float | None]:
    query = sa.select(Finding.label, Finding.cost).where(Finding.run_id == run_id).order_by(Finding.label)
    found = reader.execute(query).all()
    return {setting.NOMINAL: nominal} | {row.label: row.cost for row in found}


@router.get("/view/{run}/{flight}/recorded")
def recorded_without_slash(run: str, flight: str, request: Request) -> Response:
    """Redirect to the canonical address, which ends in a slash."""
    return RedirectResponse(at(f"{request.url.path}/"), 308)


@router.get("/view/{run}/{flight}/recorded/{rest:path}")
async def recorded_page(run: str, flight: str, rest: str, request: Request) -> Response:
    """A flight's recording; append `dark` for the dark theme. The page is self-contained."""
    if request.query_params:
        detail = "the address of a recording has no query parameters: remove the query"
        raise RefusedError("not-allowed", detail)
    if rest.strip("/") not in ("", "dark", "light"):
        raise RefusedError("not-found", f"{rest!r} is not part of a recording's address: /view/RUN/F1/recorded/dark/")
    return await answer(request, run, flight, dark=parse(rest).dark, how="inline")


async def answer(request: Request, run: str, flight: str, dark: bool, how: str) -> Response:
    """The recording as a page or a file; 304 if the client has it already."""
    known = request.headers.get("if-none-match", "")
    made: Recordings = request.app.state.recordings
    found = await made.page(account(request), number(run), flight, dark, known, request.is_disconnected)
    headers = {"Cache-Control": "private, no-cache", "ETag": found if isinstance(found, str) else found.tag}
    if isinstance(found, str):
        return Response(status_code=304, headers=headers)
    headers["Content-Security-Policy"] = f"{POLICY}; frame-ancestors 'self'"
    if how == "inline":
        headers["Content-Security-Policy"] += f"; {SANDBOX}"
        headers |= OPENED_ALONE
    headers["Content-Disposition"] = disposition(how, found.file)
    return Response(found.html, media_type="text/html", headers=headers)
