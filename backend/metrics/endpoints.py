"""GET /metrics in the text format of Prometheus."""

from __future__ import annotations

from functools import partial

from fastapi import APIRouter, Request, Response

from backend.metrics.text import MEDIA_TYPE

router = APIRouter(include_in_schema=False)


@router.get("/metrics")
async def metrics(request: Request) -> Response:
    """The state of the queue, the workers, the requests and the disk."""
    state = request.app.state
    waiting = {"pdf": state.capacities.pdf.inside, "preview": state.previews.waiting}
    waiting |= {name: getattr(state.capacities, name).inside for name in ("files", "imports", "recordings")}
    text = await state.door.inspected("metrics", partial(state.metrics.text, waiting=waiting))
    return Response(text, media_type=MEDIA_TYPE)
