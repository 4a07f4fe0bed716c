"""Errors as problem documents: what was given, what is allowed, what to do.

Source: RFC 9457, "Problem Details for HTTP APIs". Services raise `RefusedError`, `CampaignError` or `AccessError`; this
module converts all errors to the same form.
"""

from __future__ import annotations

import http
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Annotated, Any, NamedTuple, TypeVar

import sqlalchemy as sa
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import Field
from pydantic_core import ErrorDetails
from starlette.exceptions import HTTPException
from starlette.types import Receive, Scope, Send

from backend.db.access import AccessError
from backend.db.outages import worded
from backend.http.root import at
from backend.http.schema import Schema
from campaigns import CampaignError, Problem
from campaigns.asked.problem import LONGEST, MOST, shown

Found = TypeVar("Found")

MEDIA_TYPE = "application/problem+json"
_URN = "urn:clearance:problem:"


class ProblemError(Schema):
    """One error in a request: the field, the given value, and what is allowed or to be done."""

    field: str
    given: str
    message: str


class ProblemDocument(Schema):
    """An error as RFC 9457 describes it; `errors` lists the invalid fields, if any."""

    type: str
    title: str
    status: int
    detail: str
    instance: str
    errors: Annotated[list[ProblemError], Field(default_factory=list, exclude_if=operator.not_)]


Responses = dict[int | str, dict[str, Any]]
"""The `responses=` of a route: parts of an OpenAPI document."""


def answers(description: str, media: str, binary: bool = False) -> Responses:
    """The `responses=` of a route whose answer is not JSON, but a text or a binary file of this media type."""
    schema = {"type": "string", "format": "binary"} if binary else {"type": "string"}
    return {200: {"description": description, "content": {media: {"schema": schema}}}}


def located(description: str, noun: str) -> Responses:
    """The `responses=` of a route that makes something: its answer names the address."""
    location = {"description": f"The address of the {noun}.", "schema": {"type": "string"}}
    return {201: {"description": description, "headers": {"Location": location}}}


PROBLEMS: Responses = {
    "default": {
        "description": "What went wrong, as a problem document (RFC 9457).",
        "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}},
    }
}
"""For `responses=` of a router: `backend.openapi` adds the schema."""


class Kind(NamedTuple):
    status: int
    when: str


KINDS = {
    "bad-request": Kind(400, "The request cannot be read: its address, its parameters or the JSON of its body."),
    "not-allowed": Kind(400, "This address does not allow this query."),
    "not-signed-in": Kind(401, "There is no valid session or token."),
    "foreign-origin": Kind(403, "The write does not come from a page of this service."),
    "role-too-low": Kind(403, "The user's role does not permit this."),
    "scope-too-narrow": Kind(403, "The scope of the API token does not permit this."),
    "not-yours": Kind(403, "It belongs to another user."),
    "own-run": Kind(403, "Users cannot sign off runs that they launched, unless an administrator permits it."),
    "wrong-password": Kind(403, "The current password is wrong."),
    "not-found": Kind(404, "Not found."),
    "no-such-view": Kind(404, "This visitor has no such 3D view open."),
    "method-not-allowed": Kind(405, "Method not allowed at this address."),
    "access-conflict": Kind(409, "The name is taken, or the user or token cannot be changed in this way."),
    "already-made": Kind(
        409, "A request with this Idempotency-Key was done already; its answer cannot be shown again."
    ),
    "already-signed": Kind(409, "The same person has already signed off these results in this role."),
    "flight-overtaken": Kind(409, "A newer request of the same client superseded this one."),
    "quota-reached": Kind(
        409, "The user has as many active runs, stored evaluations or stored bytes as one user may have."
    ),
    "draft-changed": Kind(409, "The draft was saved since it was opened."),
    "no-webhook": Kind(409, "The settings name no webhook."),
    "no-verdict": Kind(409, "The run has no verdict to sign off."),
    "not-failed": Kind(409, "The run has not failed."),
    "not-waiting": Kind(409, "The run does not wait for the code that began it."),
    "not-continuable": Kind(409, "The run's campaign or its evaluations cannot be used by the installed code."),
    "not-removable": Kind(409, "A run is running, or has a valid sign-off."),
    "notes-changed": Kind(409, "The notes were changed since they were read."),
    "other-version": Kind(409, "The run's campaign or a result is of another version of Clearance, or damaged."),
    "removed": Kind(409, "The run is removed: restore it first."),
    "requirement-conflict": Kind(409, "The requirement is changed elsewhere, or there are too many."),
    "text-changed": Kind(409, "The text of a requirement has changed since it was reviewed."),
    "results-changed": Kind(409, "The results have changed since they were reviewed."),
    "too-many-drafts": Kind(409, "The maximum number of drafts is reached."),
    "withdrawn": Kind(409, "The sign-off is already withdrawn."),
    "purged": Kind(410, "The run's results were permanently deleted."),
    "view-failed": Kind(410, "The 3D view ended with an error of the service; open it again."),
    "changed": Kind(412, "It has changed since the entity tag of `If-Match` was read."),
    "too-large": Kind(413, "The body is too large."),
    "too-long": Kind(414, "Path and query are too long."),
    "unsupported-media-type": Kind(415, "The body is neither JSON nor YAML."),
    "unknown-host": Kind(421, "The service does not answer to this name; see CLEARANCE_ALLOWED_HOSTS."),
    "too-many-requests": Kind(429, "Too many requests of this user, session or token, at a time or in a minute."),
    "bad-cursor": Kind(422, "The cursor does not belong to this list and order."),
    "idempotency-key-reused": Kind(422, "The Idempotency-Key was used for another request."),
    "invalid": Kind(422, "The request contains no change."),
    "invalid-campaign": Kind(422, "The campaign can be read, but cannot be run."),
    "invalid-request": Kind(422, "A parameter or the body does not match the API description."),
    "not-flyable": Kind(422, "The simulation process rejected the campaign."),
    "outside-limits": Kind(422, "The value of a parameter is outside the limits of its component."),
    "unknown-finding": Kind(422, "The run has no such finding."),
    "unknown-parameter": Kind(422, "The campaign has no such uncertain parameter."),
    "unreadable": Kind(422, "The body cannot be read as JSON or as text."),
    "internal": Kind(500, "Internal error; see the service's log."),
    "browser-failed": Kind(503, "The service's Chromium could not print the report."),
    "no-package": Kind(503, "A package that writes this file is not installed on the service's machine."),
    "busy": Kind(503, "The service is busy: try again in a few seconds."),
    "case-failed": Kind(503, "The case of a simulator could not be evaluated."),
    "damaged": Kind(503, "The database is damaged."),
    "database-away": Kind(503, "The database cannot be reached or written."),
    "database-gone": Kind(503, "The database was deleted."),
    "flight-failed": Kind(503, "The flight could not be simulated."),
    "no-space": Kind(503, "The disk of the database, or of temporary files, is full."),
    "not-ready": Kind(503, "No run can be done now: `errors` has the reasons."),
    "no-browser": Kind(503, "The service's machine has no Chromium."),
    "no-catalogue": Kind(503, "No worker has published components yet, or another version published them."),
    "preview-busy": Kind(503, "The queue of previews is full."),
    "preview-failed": Kind(503, "The preview could not be simulated."),
    "preview-overtaken": Kind(503, "The connection was closed before this preview started."),
}
"""All problem types, by the last part of their URN."""

RETRY = frozenset(
    {"no-catalogue", "preview-busy", "busy", "too-many-requests", "no-space", "damaged", "database-away"}
    | {"database-gone", "not-ready"}
)
"""The problem types with a Retry-After header."""


RETRY_AFTER = {"description": "Seconds to wait before the next request.", "schema": {"type": "integer"}}


def problems(*kinds: str) -> Responses:
    """The `responses=` of a route: its problem types in addition to those of all routes."""
    by_status: Responses = {}
    for kind in kinds:
        declare(by_status, kind)
    return by_status


def declare(responses: Responses, kind: str, key: type[int] | type[str] = int) -> None:
    """Add a problem type to the responses of an operation."""
    status, when = KINDS[kind]
    text = f"`{_URN}{kind}`: {when}"
    found = responses.setdefault(key(status), PROBLEMS["default"] | {"description": "", "x-problem-types": []})
    if _URN + kind not in found["x-problem-types"]:
        found["x-problem-types"] = [*found["x-problem-types"], _URN + kind]
        found["description"] = f"{found['description']}\n\n{text}".strip()
    if kind in RETRY:
        found["headers"] = {"Retry-After": RETRY_AFTER}
    elif kind == "not-signed-in":
        found["headers"] = {"WWW-Authenticate": {"description": "How to sign in.", "schema": {"type": "string"}}}


class RefusedError(Exception):
    """Raised to answer a request with a problem document."""

    def __init__(
        self,
        kind: str,
        detail: str,
        errors: Iterable[Problem] = (),
        headers: Mapping[str, str] | None = None,
        status: int | None = None,
    ) -> None:
        """kind: one of `KINDS`, which has its status; any other one comes with its own."""
        super().__init__(detail)
        self.kind, self.detail, self.status = kind, detail, status or KINDS[kind].status
        self.errors, self.headers = list(errors), headers


def not_found(what: str, name: str) -> RefusedError:
    return RefusedError("not-found", f"there is no {what} {name[:LONGEST]!r}")


def existing(found: Found | None, what: str, name: str) -> Found:
    """What was looked up; 404 if there is none."""
    if found is None:
        raise not_found(what, name)
    return found


def invalid(error: CampaignError) -> RefusedError:
    return RefusedError("invalid-campaign", "; ".join(map(str, error.problems)), error.problems)


def mismatch(found: Sequence[Problem], count: int = 0) -> RefusedError:
    """422 for a request that the API does not describe; count: how many problems it has, if these are the first."""
    more = [Problem("", "", f"and {count - len(found)} more problems")] if count > len(found) else []
    errors = [*found, *more]
    return RefusedError(
        "invalid-request", f"the request does not match the API description: {'; '.join(map(str, errors))}", errors
    )


def foreign_cursor(cursor: str) -> RefusedError:
    return RefusedError("bad-cursor", f"the cursor {cursor[:40]!r} is not one of this list: begin without one")


def no_temporary_file(error: Exception) -> RefusedError:
    """503 for a file that is made next to the database before it is sent."""
    detail = f"no temporary file can be written ({worded(error)}): an administrator must free space, or set TMPDIR"
    return RefusedError("no-space", detail, headers={"Retry-After": "60"})


def respond(refused: RefusedError, path: str) -> JSONResponse:
    errors = [
        ProblemError(field=_text(e.field), given=_text(e.given), message=_text(e.message)) for e in refused.errors
    ]
    document = ProblemDocument(
        type=_URN + refused.kind,
        title=http.HTTPStatus(refused.status).phrase,
        status=refused.status,
        detail=_text(refused.detail),
        instance=at(_text(path)),
        errors=errors,
    )
    return JSONResponse(document.model_dump(), refused.status, dict(refused.headers or {}), MEDIA_TYPE)


async def refuse(refused: RefusedError, path: str, scope: Scope, receive: Receive, send: Send) -> None:
    """Answer a request of a middleware; a socket is closed before it is accepted, which is answered with 403."""
    if scope["type"] == "websocket":
        await receive()  # the handshake
        await send({"type": "websocket.close", "code": 1008, "reason": refused.kind})
    else:
        await respond(refused, path)(scope, receive, send)


def _text(text: str) -> str:
    """Escape unpaired surrogates, which cannot be encoded."""
    return text.encode("utf-8", "backslashreplace").decode()


def broken(path: str) -> JSONResponse:
    """500 for an internal error: the details are in the log only."""
    detail = (
        "internal error: the request was rolled back; nothing was changed. Try again; the cause is in the service's log"
    )
    return respond(RefusedError("internal", detail), path)


_SENTENCES = {
    400: "the request cannot be read: send JSON in UTF-8, with whole numbers of at most 4,300 digits",
    404: "there is no page or resource at this address",
    405: "method not allowed here",
}
_KIND = {400: "bad-request", 404: "not-found", 405: "method-not-allowed", 413: "too-large"}
"""Details of the statuses that the framework and the middleware raise."""


def _http(error: HTTPException, method: str) -> RefusedError:
    sentence = _SENTENCES.get(error.status_code, error.detail)
    kind = _KIND.get(error.status_code) or http.HTTPStatus(error.status_code).phrase.lower().replace(" ", "-")
    return RefusedError(kind, f"{sentence} ({method})", headers=error.headers, status=error.status_code)


def _invalid(error: RequestValidationError, _: str) -> RefusedError:
    found = error.errors()
    errors = [problem_of(e, e["loc"][1:] if e["loc"][0] in _PARTS else e["loc"]) for e in found[:MOST]]
    return mismatch(errors, len(found))


_REFUSALS: dict[type[Exception], Callable[[Any, str], RefusedError]] = {
    RefusedError: lambda error, _: error,
    CampaignError: lambda error, _: invalid(error),
    AccessError: lambda error, _: RefusedError("access-conflict", f"{error}"),
    HTTPException: _http,
    RequestValidationError: _invalid,
    # The pool had no free database connection within its timeout.
    sa.exc.TimeoutError: lambda *_: RefusedError(
        "busy", "the database is busy: try again in a few seconds", headers={"Retry-After": "5"}
    ),
}
"""From an error and the method of the request."""


def install(app: FastAPI) -> None:
    for kind, refusal in _REFUSALS.items():
        app.add_exception_handler(kind, partial(_answered, refusal))


async def _answered(refusal: Callable[[Any, str], RefusedError], request: Request, error: Exception) -> JSONResponse:
    return respond(refusal(error, request.method), request.url.path)


_PARTS = {"body", "query", "path", "header"}
"""Of a request; the first part of a location."""


def problem_of(error: ErrorDetails, location: Iterable[object]) -> Problem:
    """A problem of a request as found by pydantic, at a location in it."""
    value = error.get("input", "")
    shortened = (
        value[:LONGEST] if isinstance(value, str) else shown(value) if isinstance(value, dict | list) else str(value)
    )
    value = "" if error["type"] == "missing" else shortened[:LONGEST]
    return Problem(".".join(map(str, location))[:400], value, str(error["msg"]).removeprefix("Value error, "))
