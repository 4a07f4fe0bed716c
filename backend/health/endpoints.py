"""GET /health: answers if the database answers."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Request

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
