"""The API schemas of the audit trail."""

from __future__ import annotations

from backend.http.schema import Instant, Schema


class AuditEntry(Schema):
    """One row of the audit trail."""

    id: int
    at: Instant
    """Seconds since 1970."""
    user: str
    """The user, the API token, or on the command line the user of the operating system."""
    account: str
    """The user, also of a token; derived, and no part of the row that is hashed."""
    via: str
    """link, password, token, or cli for the command line."""
    action: str
    subject: str
    detail: dict[str, object]
    previous: str
    """The hash of the row before it."""
    hash: str
    """SHA-256 of the other fields as canonical JSON: sorted keys, no spaces, ASCII."""


class AuditPage(Schema):
    """One page of the audit trail, newest first."""

    items: list[AuditEntry]
    next_cursor: str | None
    head: str
    """Number and hash of the newest row: note it elsewhere, and `clearance trail verify --head` finds missing rows."""
    total: int
    """The number of rows in the whole trail."""
    actions: list[str]
    """All actions that occur, for the filter."""
    actors: list[str]
    """All users and tokens that occur, for the filter."""
