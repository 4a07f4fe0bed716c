"""GET /batch: the answers to several requests."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import StreamingResponse

from backend.batch import service
from backend.http.errors import answers

router = APIRouter(tags=["service"])

LINES = answers("Two lines for each answer: {path, etag}, and the answer.", "application/jsonl")


@router.get("/batch", response_class=StreamingResponse, responses=LINES)
def get_batch(
    request: Request,
    path: Annotated[
        list[str],
        Query(
            min_length=1, max_length=16, description="A path below /api/v1 with its query, such as `/runs?limit=20`."
        ),
    ],
) -> StreamingResponse:
    """What GET of these paths answers, in their order, in one journey; made for pages, which need a dozen to begin.

    Each counts as a request. One that would be refused, or that is not listed in `backend.batch.service`, is left out:
    ask for it alone to learn why.
    """
    return StreamingResponse(service.lines(request, path), media_type="application/jsonl")
