"""Errors as problem documents: what was given, what is allowed, what to do.

Source: RFC 9457, "Problem Details for HTTP APIs". Services raise `RefusedError`; everything else that goes wrong is
turned into the same form here. Start reading at `RefusedError`.
"""

from __future__ import annotations

import http
import logging
from collections.abc import Iterable, Mapping
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict
from starlette.exceptions import HTTPException

from campaigns import Problem

MEDIA_TYPE = "application/problem+json"
_URN = "urn:clearance:problem:"
_log = logging.getLogger(__name__)


class ProblemError(BaseModel):
    """One thing wrong with what was sent: the field, what was given, and what is allowed or to do."""

    model_config = ConfigDict(extra="forbid")

    field: str
    given: str
    message: str


class ProblemDocument(BaseModel):
    """An error as RFC 9457 describes it; `errors` lists every field in question where there are any."""

    model_config = ConfigDict(extra="forbid")

    type: str
    title: str
    status: int
    detail: str
    instance: str
    errors: list[ProblemError] | None = None


PROBLEMS: dict[int | str, dict[str, Any]] = {
    "default": {
        "description": "What went wrong, as a problem document (RFC 9457).",
        "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}},
    }
}
"""For `responses=` of a router: `backend.openapi` adds the schema itself."""


class RefusedError(Exception):
    """A request that is answered with a problem document instead."""

    def __init__(
        self,
        status: int,
        kind: str,
        detail: str,
        errors: Iterable[Problem] = (),
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.status, self.kind, self.detail = status, kind, detail
        self.errors, self.headers = list(errors), headers


def not_found(what: str, given: str) -> RefusedError:
    """404 for a thing of the product that is not there."""
    return RefusedError(404, "not-found", f"there is no {what} {given!r}")


def respond(refused: RefusedError, path: str) -> JSONResponse:
    """The problem document of a refusal."""
    errors = [ProblemError(field=e.field, given=e.given, message=e.message) for e in refused.errors]
    document = ProblemDocument(
        type=_URN + refused.kind,
        title=http.HTTPStatus(refused.status).phrase,
        status=refused.status,
        detail=refused.detail,
        instance=path,
        errors=errors or None,
    )
    content = document.model_dump(exclude_none=True)
    return JSONResponse(content, refused.status, dict(refused.headers or {}), MEDIA_TYPE)


def broken(path: str) -> JSONResponse:
    """500, for a fault of ours: the log has it all, the answer nothing of it."""
    detail = "the service failed while answering; its log says why, and nothing of the request was kept half done"
    return respond(RefusedError(500, "internal", detail), path)


def install(app: FastAPI) -> None:
    """Have every error of the application answered as a problem document."""
    app.add_exception_handler(RefusedError, _refused)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(RequestValidationError, _invalid)


async def _refused(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RefusedError)
    return respond(error, request.url.path)


_SAID = {
    404: "there is nothing at this address",
    405: "this address does not answer that method",
}


async def _http(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    phrase = http.HTTPStatus(error.status_code).phrase
    said = _SAID.get(error.status_code, error.detail)
    kind = phrase.lower().replace(" ", "-")
    return respond(
        RefusedError(error.status_code, kind, f"{said} ({request.method})", headers=error.headers), request.url.path
    )


async def _invalid(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    errors = [_problem(e) for e in error.errors()]
    detail = "the request is not as described by the API: " + "; ".join(map(str, errors))
    return respond(RefusedError(422, "invalid-request", detail, errors), request.url.path)


def _problem(error: Mapping[str, Any]) -> Problem:
    where = [str(part) for part in error["loc"] if part not in ("body", "query", "path", "header")]
    given = "" if error["type"] == "missing" else str(error.get("input", ""))[:120]
    return Problem(".".join(where), given, str(error["msg"]).removeprefix("Value error, "))
