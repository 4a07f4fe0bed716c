"""The API schemas of API tokens."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from backend.db.roles import Scope
from backend.http.schema import Given, Instant, Schema

LONGEST = 3650
"""Maximum lifetime of a token that expires [days]."""


class Token(Schema):
    """An API token without its secret. Times are seconds since 1970."""

    name: str
    owner: str
    scope: Scope
    """A token never has more than the role of its owner."""
    state: Literal["active", "expired", "revoked"]
    created: Instant
    expires: Instant | None
    last_used: Instant | None
    """Accurate to a minute."""
    revoked: Instant | None


class TokenRequest(Given):
    """A token to be created."""

    name: Annotated[str, Field(min_length=1, max_length=64)]
    """What it is for, such as nightly-ci; it stays in the records and can never be used again."""
    scope: Scope
    days: Annotated[int, Field(ge=1, le=LONGEST)] | None = 90
    """Days until it expires; null: it does not expire."""


class NewToken(Schema):
    """A token with its secret, which is shown only once."""

    token: Token
    secret: str
