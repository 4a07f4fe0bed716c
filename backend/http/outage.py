"""The answer while the database cannot be used: 503 with a sentence and Retry-After, whatever asked for it."""

from __future__ import annotations

import html
import logging

from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import Scope

from backend.db.outages import DatabaseOutage as DatabaseOutage
from backend.db.outages import Kind
from backend.http.errors import RefusedError, respond
from backend.http.pages import plain, wants_page

AGAIN: dict[Kind, int] = {"busy": 5, "database-away": 5, "database-gone": 30, "damaged": 60, "no-space": 60}
"""Retry-After [s]."""

_log = logging.getLogger(__name__)


def refusal(error: DatabaseOutage) -> RefusedError:
    """The driver's own words are in the log only: they may name addresses and files."""
    if error.kind != "busy":
        _log.error("%s (%s)", error.sentence, " ".join(str(error.orig).split()))
    return RefusedError(error.kind, error.sentence, headers={"Retry-After": str(AGAIN[error.kind])})


def answer(error: DatabaseOutage, scope: Scope) -> Response:
    """A problem document, or a page for a browser that navigates."""
    refused = refusal(error)
    if scope["path"].startswith("/api/") or not wants_page(Headers(scope=scope)):
        return respond(refused, scope["path"])
    sentence = html.escape(refused.detail)
    page = plain("The service cannot be used now", f"<p>{sentence[:1].upper()}{sentence[1:]}.</p>", refused.status)
    page.headers.update(refused.headers or {})
    return page
