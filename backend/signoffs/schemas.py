"""The API schemas of sign-offs."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.http.schema import Given, Instant, Schema
from campaigns.asked.values import Name, Notes

Comment = Annotated[Notes, Field(max_length=4000)]


class SignoffRequest(Given):
    """A reviewer's sign-off of the results that they reviewed."""

    name: Name
    role: Name
    comment: Comment = ""
    digest: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    """The digest of the reviewed results; refused if it is not the run's current one."""


class WithdrawalRequest(Given):
    """The reason why a sign-off is withdrawn."""

    reason: Annotated[Comment, Field(min_length=1)]


class Signoff(Schema):
    """One sign-off; it is never edited. Times are seconds since 1970."""

    id: int
    name: str
    role: str
    comment: str
    digest: str
    current: bool
    """Whether the results are still those that were signed."""
    user: str
    """The user who was signed in to the service."""
    own: bool
    """Whether this user also launched the run: such a sign-off is not independent."""
    created: Instant
    withdrawn: Instant | None
    withdrawn_by: str | None
    withdrawn_reason: str | None


class Signoffs(Schema):
    """The sign-offs of a run, oldest first, and the digest of its current results."""

    digest: str
    can_sign: bool
    """Whether the run can be signed off: it has a verdict and is not removed."""
    barred: str | None = None
    """Why the caller may not sign it off, such as having launched it; null if they may."""
    items: list[Signoff]
