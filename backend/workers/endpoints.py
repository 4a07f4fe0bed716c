"""GET /workers: whether a worker is alive, and what each executes."""

from __future__ import annotations

from fastapi import APIRouter

from backend.http.deps import Reader
from backend.workers import service
from backend.workers.schemas import Workers

router = APIRouter(tags=["service"])


@router.get("/workers")
def list_workers(reader: Reader) -> Workers:
    """The live workers with their runs and stages, those that became silent recently, and when one was last seen.

    The event stream sends the same as `event: workers` whenever more than the heartbeats has changed.
    """
    return service.workers(reader)
