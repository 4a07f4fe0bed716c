"""The API schemas of users and of the settings of access."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from backend.db.roles import Role
from backend.http.schema import Given, Instant, Schema


class User(Schema):
    """A user. Times are seconds since 1970."""

    name: str
    role: Role
    state: Literal["active", "invited", "disabled"]
    """invited: the user has not set a password yet."""
    has_password: bool
    created: Instant
    created_by: str
    joined: Instant | None
    """When the invitation was accepted."""
    disabled: Instant | None
    invited_until: Instant | None
    """When the open link expires; null if there is none."""
    sessions: int
    """The number of browsers that are signed in as this user."""
    provided: bool
    """Whether the user signs in through the provider, whose groups determine the role."""
    fixed: bool
    """Whether role and access cannot be changed: the user of the login link."""
    etag: str
    """For `If-Match` when role or access are changed."""


class UserInvite(Given):
    """A user to be invited."""

    name: Annotated[str, Field(min_length=1, max_length=64)]
    """Lower-case letters, digits and . _ + @ -; an e-mail address, for example."""
    role: Role


class UserChange(Given):
    """The role of a user, or whether access is withdrawn; omitted fields stay unchanged."""

    role: Role | None = None
    disabled: bool | None = None


class Invitation(Schema):
    """A link with which a user sets a password; it is shown only once."""

    user: str
    path: str
    """The path of the link, below the address of the service."""
    address: str | None
    """The public address of the service from its settings; null if none is set."""
    expires: Instant


class AccessSettings(Schema):
    """Settings that administrators change while the service runs."""

    own_sign_offs: bool
    """Whether users may sign off runs that they launched; each such sign-off says so."""


class AccessSettingsChange(Given):
    """The settings to be changed."""

    own_sign_offs: bool
