"""GET and PATCH /runs/{run}/views/{key}: the page that opened a 3D view controls it.

The page generates the key, which is part of the view's address; it is valid only for the view's visitor and run. While
a request waits for a view, the key lets its frame in (`backend.access.frames`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, Path, Query, Request

from backend.access.auth import CurrentVisitor, forbidden
from backend.access.frames import Voucher
from backend.access.rules import RUN
from backend.db.engine import read
from backend.http.deps import account, capacities
from backend.http.errors import RefusedError, problems
from backend.http.schema import LARGEST_WHOLE, RunName
from backend.runs.service import number
from backend.runs.tombstones import refuse_purged
from backend.scenes.base.address import KEY
from backend.scenes.base.schemas import ViewChange, ViewState
from backend.scenes.base.setting import drawable
from backend.scenes.control.viewers import Handle, Viewers
from backend.scenes.viewer.viewer import FAILED, FailedError, GoneError, Viewer
from campaigns.runs import run_name

router = APIRouter(tags=["views"])

Key = Annotated[str, Path(pattern=f"^{KEY}$", description="The key of the view: a UUID (version 4) in its address.")]
Wait = Annotated[float, Query(ge=0, le=30, description="How long to wait for the view to open [s].")]
Since = Annotated[
    int | None,
    Query(
        ge=0,
        le=LARGEST_WHOLE,
        description="A known revision: the response is sent once the view has changed, at the latest "
        "after `wait`; immediately if no such view is open.",
    ),
]


@router.get("/runs/{run}/views/{key}", responses=problems("not-found", "no-such-view", "purged", "view-failed", "busy"))
async def get_view(
    run: RunName, key: Key, request: Request, visitor: CurrentVisitor, wait: Wait = 0.0, since: Since = None
) -> ViewState:
    """The state of an open 3D view, now or after its next change."""
    handle = Handle(visitor, number(run), key)
    if since is not None:
        await request.app.state.viewers.news(handle, since, wait)
        wait = 0.0
    return await _answer(request, run, handle, wait, Viewer.state)


@router.patch(
    "/runs/{run}/views/{key}",
    responses=problems(
        *("not-found", "no-such-view", "purged", "view-failed", "unknown-finding", "unknown-parameter", "busy"),
        *("role-too-low", "scope-too-narrow"),
    ),
)
async def change_view(
    run: RunName, key: Key, change: ViewChange, request: Request, visitor: CurrentVisitor, wait: Wait = 0.0
) -> ViewState:
    """Change an open 3D view, `/view/RUN/key/KEY/`; returns its new state.

    A what-if and the layers `sampled` and `field` are simulated: they need the role engineer, and of a token the scope
    run.
    """
    if change.simulates and (refused := forbidden(visitor, RUN)) is not None:
        raise refused
    return await _answer(request, run, Handle(visitor, number(run), key), wait, lambda viewer: viewer.steer(change))


async def _answer(
    request: Request, run: str, handle: Handle, wait: float, ask: Callable[[Viewer], ViewState]
) -> ViewState:
    viewers: Viewers = request.app.state.viewers
    viewer = await viewers.find(handle, 0.0)
    if (viewer is None or viewer.failed) and wait > 0:  # one that failed is replaced by the frame that opens
        # The frame has no session: it is let in while the page waits for it.
        with request.app.state.frames.expected(run, handle.key, Voucher(handle.visitor, request.state.still)):
            viewer = await viewers.find(handle, wait)
    if viewer is None:
        await capacities(request).views.run(account(request), lambda: _without_view(request, handle))
        full = viewers.full(handle.visitor)
        if full and not viewers.stopping.is_set():
            raise RefusedError("busy", f"{full}: close one that is not needed, then try again")
        raise _gone(handle)
    try:
        return await capacities(request).views.run(account(request), lambda: ask(viewer))
    except FailedError:
        raise RefusedError("view-failed", FAILED) from None
    except GoneError:
        raise _gone(handle) from None


def _without_view(request: Request, handle: Handle) -> None:
    """Raise 410 if the run was purged, 404 if it has no 3D view, so that its page stops retrying."""
    with read(request.app.state.engine) as reader:
        refuse_purged(reader, handle.run_id)
        drawable(reader, handle.run_id)


def _gone(handle: Handle) -> RefusedError:
    run = run_name(handle.run_id)
    detail = (
        f"no 3D view of {run} is open for you with the key {handle.key}: open /view/{run}/key/{handle.key}/ first, "
        "and keep it open; ?wait=SECONDS waits for it"
    )
    return RefusedError("no-such-view", detail)
