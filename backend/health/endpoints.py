"""GET /health: the database answers; /health/live: the process answers; /health/ready: runs can be done."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Request

from backend.health.checks import reasons
from backend.http.errors import RefusedError, problems
from backend.http.schema import Schema

router = APIRouter(tags=["service"])


class Health(Schema):
    """Minimal, because no authentication is required."""

    status: Literal["ok"]


@router.get("/health")
async def health(request: Request) -> Health:
    """Whether the service and its database are available."""
    await request.app.state.door.healthy()
    return Health(status="ok")


@router.get("/health/live")
async def live() -> Health:
    """Whether the service's process answers; restart it if not."""
    return Health(status="ok")


@router.get("/health/ready", responses=problems("not-ready"))
async def ready(request: Request) -> Health:
    """Whether runs can be done: the database answers in this version's schema, a worker is alive, there is space."""
    settings = request.app.state.settings
    found = await request.app.state.door.inspected(
        "ready", lambda engine: reasons(engine, settings.data, request.app.state.room)
    )
    if found:
        detail = "; ".join(reason.message for reason in found)
        raise RefusedError("not-ready", detail, found, headers={"Retry-After": "5"})
    return Health(status="ok")
