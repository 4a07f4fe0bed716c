"""The API schemas of the session, and of the sessions of a user."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, SecretStr

from backend.db.roles import Role, Scope
from backend.http.schema import Given, Instant, Schema


class SessionInfo(Schema):
    """The user who is signed in, and how they authenticated."""

    user: str
    """The user, or the name of the API token."""
    via: Literal["link", "password", "provider", "token"]
    account: str
    """The user, or the owner of the API token."""
    role: Role
    """The role of the account."""
    scope: Scope | None
    """The scope of the API token; null for a browser."""
    has_password: bool
    """Whether the account can sign in with a password."""


class PasswordChange(Given):
    """A new password, with the current one if there is one."""

    current: Annotated[SecretStr | None, Field(max_length=400)] = None
    new: Annotated[SecretStr, Field(max_length=400)]


class BrowserSession(Schema):
    """A browser that is signed in. Times are seconds since 1970."""

    id: str
    user: str
    via: Literal["link", "password", "provider"]
    created: Instant
    expires: Instant
    last_used: Instant | None
    """Null if it was not used since the service was started; accurate to a second."""
    agent: str
    """The browser's description of itself."""
    address: str
    """The network address from which it signed in; empty for sessions of earlier versions."""
    current: bool
    """Whether this is the session of this request."""
