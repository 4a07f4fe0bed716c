"""The names of a query: those that the route of a request takes, any other one is refused, as unknown keys of a body.

A filter or a label with a mistyped name would otherwise be left out without a word.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable
from typing import Any

from fastapi import Depends, Request
from fastapi.dependencies.utils import get_flat_params
from fastapi.params import Query
from fastapi.routing import APIRoute

from backend.http.errors import mismatch
from campaigns import Problem
from campaigns.asked.problem import LONGEST, MOST

RULE = (
    "A request whose query has a name that the operation does not have is refused with 422 (`invalid-request`), as is "
    "a body with an unknown key; nothing is done then. Only the health checks ignore such names."
)
"""For the description of the API."""

_NAMES: dict[Callable[..., Any], tuple[str, ...]] = {}
"""By endpoint, of which each belongs to one route."""


async def _known(request: Request) -> None:
    """Refuses an unknown name (422). A coroutine, because FastAPI runs plain functions in the thread pool."""
    if not request.scope["query_string"]:
        return
    names = _names(request.scope["route"])
    if unknown := [(name, value) for name, value in request.query_params.multi_items() if name not in names]:
        errors = [Problem(name[:LONGEST], value[:LONGEST], _advice(name, names)) for name, value in unknown[:MOST]]
        raise mismatch(errors, len(unknown))


KNOWN = [Depends(_known)]
"""For `dependencies=` of a router: before all others, so that nothing is done for a request that is refused."""


def _names(route: APIRoute) -> tuple[str, ...]:
    found = _NAMES.get(route.endpoint)
    if found is None:
        fields = get_flat_params(route.dependant)
        found = _NAMES[route.endpoint] = tuple(f.alias for f in fields if isinstance(f.field_info, Query))
    return found


def _advice(name: str, names: tuple[str, ...]) -> str:
    if not names:
        return "no such query parameter; none is allowed at this address"
    close = difflib.get_close_matches(name[:LONGEST], names, n=1)
    likely = f"; did you mean {close[0]!r}? Allowed" if close else "; allowed"
    return f"no such query parameter{likely} are: {', '.join(names)}"
