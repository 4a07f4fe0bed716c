"""GET /health: answers once the database does."""

from __future__ import annotations

import sqlalchemy as sa
from fastapi import APIRouter

from backend.deps import Reader
from backend.health.schemas import Health

router = APIRouter(tags=["service"])


@router.get("/health")
def health(reader: Reader) -> Health:
    """Whether the service and its database answer."""
    reader.execute(sa.select(1))
    return Health(status="ok")
