"""GET /workers: whether a worker is alive, and what each executes."""

from __future__ import annotations

from fastapi import APIRouter, Request

from backend.http.deps import Reader, where
from backend.workers import service
from backend.workers.schemas import Workers

router = APIRouter(tags=["service"])


@router.get("/workers")
def list_workers(request: Request, reader: Reader) -> Workers:
    """The live workers with their runs and stages, those that became silent recently, when one was last seen, and the
    free space of the service.

    The event stream sends the same as `event: workers` whenever more than the heartbeats has changed.
    """
    return service.workers(reader, where(request))
