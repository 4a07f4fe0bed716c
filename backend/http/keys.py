"""The header Idempotency-Key: a request that is repeated with the same key is not done again.

Source: IETF draft "The Idempotency-Key HTTP Header Field". The key is taken in the transaction of the write itself, so
that after a crash either both are stored or neither; a concurrent duplicate waits for that transaction. A key belongs
to its user and operation, and stays. Most endpoints use `backend.access.once`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import sqlalchemy as sa
from fastapi import Header

from backend.db.engine import insert, now
from backend.db.tables import RequestKey
from backend.http.errors import RefusedError

Key = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        min_length=1,
        max_length=128,
        description="1 to 128 characters: a repeated request with the same key is not done again.",
    ),
]
KEPT = 50
"""Answers that are stored for a user, so that no user fills the disk; the keys themselves stay."""
LARGEST = 1_000_000
"""Bytes of an answer that is stored, compressed."""


@dataclass(frozen=True)
class Keyed:
    """A request with its key, if it has one."""

    key: str | None
    user: str
    """As records name the visitor."""
    operation: str
    """Its id in the OpenAPI document."""
    digest: str
    """Of everything that was sent, to distinguish a repeated request from another one with the same key."""


def earlier(reader: sa.Connection, keyed: Keyed) -> sa.Row[Any] | None:
    """What the first request with the key made, and its answer, if there was one; 422 if that was another request."""
    if keyed.key is None:
        return None
    columns = (RequestKey.body, RequestKey.made, RequestKey.answer, RequestKey.created)
    row: Any = reader.execute(sa.select(*columns).where(*_mine(keyed))).one_or_none()
    if row is not None and row.body != keyed.digest:
        detail = (
            f"the Idempotency-Key {keyed.key!r} was used for another request, which made {row.made}: "
            "send the same request again, or another key"
        )
        raise RefusedError("idempotency-key-reused", detail)
    return row  # type: ignore[no-any-return]


def claimed(writer: sa.Connection, keyed: Keyed) -> sa.Row[Any] | None:
    """Take the key in this transaction, which must then `keep` it; returns what `earlier` does if it is taken.

    Waits for another transaction that has taken the key and not ended.
    """
    if keyed.key is None:
        return None
    values = {"user": keyed.user, "operation": keyed.operation, "key": keyed.key, "body": keyed.digest, "made": ""}
    taken = insert(writer, RequestKey).values(**values, created=now(writer)).on_conflict_do_nothing()
    if writer.scalar(taken.returning(RequestKey.key)) is not None:  # PostgreSQL's rowcount may be -1
        return None
    return earlier(writer, keyed)


def keep(writer: sa.Connection, keyed: Keyed, made: str, answer: bytes | None = None) -> None:
    """Store what the first request with the key made, and its answer unless it is too large."""
    if keyed.key is None:
        return
    kept = None if answer is None or len(answer) > LARGEST else answer
    writer.execute(sa.update(RequestKey).where(*_mine(keyed)).values(made=made[:300], answer=kept))
    if kept is not None:
        _forget(writer, keyed.user)


def _forget(writer: sa.Connection, user: str) -> None:
    answered = (RequestKey.user == user, RequestKey.answer.is_not(None))
    of = sa.select(RequestKey.created).where(*answered).order_by(RequestKey.created.desc()).offset(KEPT - 1).limit(1)
    oldest = writer.scalar(of)
    if oldest is None:
        return
    old = sa.select(RequestKey.operation, RequestKey.key).where(*answered, RequestKey.created < oldest)
    for row in writer.execute(old.with_for_update(skip_locked=True)).all():  # another request forgets the locked ones
        mine = _mine(Keyed(row.key, user, row.operation, ""))
        writer.execute(sa.update(RequestKey).where(*mine).values(answer=None))


def _mine(keyed: Keyed) -> tuple[sa.ColumnElement[bool], ...]:
    return (RequestKey.user == keyed.user, RequestKey.operation == keyed.operation, RequestKey.key == keyed.key)
