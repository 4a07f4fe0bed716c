"""Campaigns as request bodies: JSON or YAML, parsed by the same rules as a file."""

from __future__ import annotations

import json
from typing import Any, TypeVar

from fastapi import Request
from pydantic import BaseModel, ValidationError

from backend.http.errors import RefusedError, problem_of
from campaigns import Campaign, CampaignError, Problem, load_text
from campaigns.asked.problem import MOST
from campaigns.asked.reading import LONGEST_KEY, TOO_LONG, repeated

MOST_CONTAINERS = 100_000
"""Lists and objects of a body in JSON; each costs half a microsecond, and a campaign has some hundred."""

LAUNCH = (
    *("unsupported-media-type", "unreadable", "invalid-campaign", "idempotency-key-reused"),
    *("no-catalogue", "busy", "quota-reached"),
)
"""The problems of a request that queues runs of a campaign."""

Described = TypeVar("Described", bound=BaseModel)
JSON_TYPES = frozenset({"application/json"})
YAML_TYPES = frozenset({"application/yaml", "application/x-yaml", "text/yaml", "text/x-yaml"})


def of(schema: str, yaml: bool = True) -> dict[str, object]:
    """The `openapi_extra=` of a route that reads its body itself: JSON of this schema, or a campaign in YAML."""
    content = {"application/json": {"schema": {"$ref": f"#/components/schemas/{schema}"}}}
    text = {"application/yaml": {"schema": {"type": "string"}}} if yaml else {}
    return {"requestBody": {"required": True, "content": content | text}}


def content_type(request: Request) -> str:
    """The body's media type without its parameters; 415 for one that is neither JSON nor YAML."""
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type not in JSON_TYPES | YAML_TYPES:
        detail = f"send a campaign as application/json or application/yaml, given {media_type or 'no content type'!r}"
        raise RefusedError("unsupported-media-type", detail)
    return media_type


def is_yaml(request: Request) -> bool:
    return content_type(request) in YAML_TYPES


def text(body: bytes) -> str:
    """The body as text; 422 when it is not UTF-8."""
    try:
        return body.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise unreadable(Problem(f"byte {error.start}", "", "the body is not UTF-8 text")) from None


def document(body: bytes) -> Any:
    """The body as plain JSON values; 422 when it is not JSON, repeats a key, or has too many lists and objects."""
    if body.count(b"[") + body.count(b"{") > MOST_CONTAINERS:
        many = f"more than {MOST_CONTAINERS:,} lists and objects; a campaign has some hundred"
        raise unreadable(Problem("", "", many))
    try:
        return json.loads(text(body), object_pairs_hook=_distinct)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise unreadable(Problem(where, "", f"not readable as JSON: {error.msg}")) from None
    except RecursionError:
        raise unreadable(Problem("", "", "not readable as JSON: nested too deeply")) from None
    except _RepeatedError as error:
        raise unreadable(Problem(str(error), "", "this key is given twice")) from None
    except ValueError:  # Python's limit on parsing integers
        raise unreadable(Problem("", "", f"not readable as JSON: {TOO_LONG}")) from None


def described(body: bytes, schema: type[Described]) -> Described:
    """The body, JSON, as what a schema describes; raises `CampaignError` with each problem and its location."""
    try:
        return schema.model_validate(document(body))
    except ValidationError as error:
        found = error.errors(include_url=False, include_context=False)
        raise CampaignError("request", [problem_of(e, e["loc"]) for e in found[:MOST]], len(found)) from None


def yaml_campaign(body: bytes) -> Campaign:
    """The body as a campaign in YAML; raises `CampaignError`."""
    return load_text(text(body), "request")


def unreadable(problem: Problem) -> RefusedError:
    return RefusedError("unreadable", str(problem), [problem])


class _RepeatedError(ValueError):
    pass


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, object]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise _RepeatedError((repeated(name for name, _ in pairs) or "")[:LONGEST_KEY])
    return found
