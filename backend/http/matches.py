"""Entity tags of what users edit, and the header If-Match: an edit of what has changed since it was read is refused.

Source: RFC 9110, 8.8.3 and 13.1.1. A tag identifies what can be edited, not the progress of a run. An edit without the
header is applied, as in earlier versions.
"""

from __future__ import annotations

import hashlib
import json
import re
from typing import Annotated, Any

from fastapi import Header

from backend.http.errors import RefusedError, Responses

IfMatch = Annotated[
    str | None,
    Header(
        alias="If-Match",
        max_length=1000,
        description="The `ETag` that was read: 412 if it has changed since. `*` matches whatever there is.",
    ),
]
_TAG = re.compile(r'(?:W/)?"[^"]*"')

TAGGED: Responses = {
    200: {
        "headers": {
            "ETag": {"description": "The entity tag, for `If-Match` of an edit.", "schema": {"type": "string"}},
        }
    }
}


def tag(*parts: Any) -> str:
    text = json.dumps(parts, sort_keys=True, ensure_ascii=True)
    return f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'


def require_match(tags: str | None, current: str, what: str, there: bool = True) -> None:
    """Raise 412 unless the header is absent, names the current tag, or is `*` and it is there; never by a weak tag."""
    if tags is None or (tags.strip() == "*" and there) or current in _TAG.findall(tags):
        return
    if not there:
        raise RefusedError("changed", f"{what} is not there: read what there is, then repeat the change")
    detail = f"{what} has changed since it was read: read it again, then repeat the change"
    raise RefusedError("changed", detail)
