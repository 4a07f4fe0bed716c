"""The audit trail: who did what, and when. Rows are only added, each with the hash of the one before it.

Writers take turns at the row of `AuditHead` until they commit. On PostgreSQL a transaction must therefore lock all
other rows first and call `note` last, or two transactions may wait for each other.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping
from typing import Any, TypedDict, cast

import sqlalchemy as sa

from backend.db.access import Visitor
from backend.db.chain import COVERED, FIRST, Head, Verified, digest, verify
from backend.db.engine import now, read
from backend.db.tables import Audit, AuditHead, Token


class Row(TypedDict):
    """A row of the trail; its detail is text where it is not JSON."""

    id: int
    at: float
    user: str
    via: str
    action: str
    subject: str
    detail: object
    previous: str
    hash: str


PAGE = 1000
"""Rows that are read at a time."""

ACCOUNT = sa.func.coalesce(
    sa.select(Token.owner).where(Audit.via == "token", Token.name == Audit.user).scalar_subquery(), Audit.user
).label("account")
"""The user of a row, also of one that names a token."""

COLUMNS = tuple(
    # As text: a value that was changed to what is not JSON must not prevent the others from being read.
    sa.cast(Audit.detail, sa.Text).label("detail") if name == "detail" else getattr(Audit, name)
    for name in (*COVERED, "hash")
)
"""What a row consists of; for `as_row`."""


def note(writer: sa.Connection, visitor: Visitor, action: str, subject: str, detail: Mapping[str, object]) -> None:
    """Record an action in the caller's transaction: `action` such as `signoff.created`, `subject` such as R-0001."""
    _write(writer, action, subject, detail, {"user": visitor.user, "via": visitor.via})


def note_command(writer: sa.Connection, user: str, action: str, subject: str, detail: Mapping[str, object]) -> None:
    """Record an action on the command line by an operating-system user."""
    _write(writer, action, subject, detail, {"user": user[:64], "via": "cli"})


def note_unchained(writer: sa.Connection, user: str, action: str, subject: str, detail: Mapping[str, object]) -> None:
    """Add a row to the trail in migrations up to 0017: the next one adds the chain."""
    names = ("at", "user", "via", "action", "subject")
    table = sa.table("audit", *map(sa.column, names), sa.column("detail", sa.JSON()))
    values = (now(writer), user[:64], "cli", action, subject)
    writer.execute(sa.insert(table).values(detail=detail, **dict(zip(names, values, strict=True))))


def note_sign_in(writer: sa.Connection, user: str, via: str, action: str, detail: Mapping[str, object]) -> None:
    """Record an action of a user who is not yet signed in."""
    _write(writer, action, user, detail, {"user": user[:64], "via": via})


def head(reader: sa.Connection) -> Head:
    row = reader.execute(sa.select(AuditHead.row, AuditHead.hash)).one_or_none()
    return Head(0, FIRST) if row is None else Head(row.row, row.hash)


def as_row(found: Mapping[Any, Any]) -> Row:
    """A row of `COLUMNS`; a detail that is not JSON stays text, of which the hash is another one."""
    row = cast(Row, dict(found))
    with contextlib.suppress(ValueError, RecursionError, TypeError):
        row["detail"] = json.loads(found["detail"])
    return row


def rows(reader: sa.Connection) -> Iterator[Row]:
    """All rows in ascending order; a limited number of them in memory."""
    found = _page(reader, None, None)
    while found:
        yield from found
        found = _page(reader, found[-1]["id"], None) if len(found) == PAGE else []


def all_rows(engine: sa.Engine, until: int) -> Iterator[Row]:
    """Yield the rows up to a number, for a slow reader: between pages it holds no connection and no snapshot."""
    after = None
    while True:
        with read(engine) as reader:
            found = _page(reader, after, until)
        yield from found
        if len(found) < PAGE:
            return
        after = found[-1]["id"]


def _page(reader: sa.Connection, after: int | None, until: int | None) -> list[Row]:
    of = sa.select(*COLUMNS).order_by(Audit.id).limit(PAGE)
    of = of if after is None else of.where(Audit.id > after)
    return [*map(as_row, reader.execute(of if until is None else of.where(Audit.id <= until)).mappings())]


def verified(reader: sa.Connection, noted: Head | None = None) -> Verified:
    """The faults of the whole trail; none: it is unbroken, up to what `backend.db.chain` states."""
    return verify(rows(reader), head(reader), noted)


def _write(writer: sa.Connection, action: str, subject: str, detail: Mapping[str, object], who: dict[str, str]) -> None:
    row, hash_ = writer.execute(sa.select(AuditHead.row, AuditHead.hash).with_for_update()).one()
    values = {"id": row + 1, "at": now(writer), "action": action, "subject": subject[:80], "detail": detail, **who}
    values["previous"] = hash_
    values["hash"] = digest(values)
    writer.execute(sa.insert(Audit).values(**values))
    writer.execute(sa.update(AuditHead).values(row=values["id"], hash=values["hash"]))
