"""The header Idempotency-Key: what a request with a key that was used before is answered with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import sqlalchemy as sa
from fastapi import Header

from backend.http.errors import RefusedError

Key = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        min_length=1,
        max_length=128,
        description="Any text: a repeated request with the same key returns what the first one queued.",
    ),
]


def repeated(
    reader: sa.Connection, stored: sa.Executable, key: str | None, digest: str, named: Callable[[int], str]
) -> sa.Row[Any] | None:
    """The row of the first request with the key, if there was one; 422 if that was another request.

    stored: selects the number of what was queued as `queued`, and the digest of the request as `body`. named: the name
    of a number, R-0001.
    """
    row = None if key is None else reader.execute(stored).one_or_none()
    if row is not None and row.body != digest:
        detail = (
            f"the Idempotency-Key {key!r} was used for another request, which queued {named(row.queued)}: "
            "send the same request again, or another key"
        )
        raise RefusedError(422, "idempotency-key-reused", detail)
    return row
