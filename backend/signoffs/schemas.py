"""What the API says of sign-offs. Start reading at `Signoff`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.http.schema import Given, Schema
from campaigns.asked.values import Name, Notes

Comment = Annotated[Notes, Field(max_length=4000)]


class SignoffRequest(Given):
    """A reviewer's word on the results that they have seen."""

    name: Name
    role: Name
    comment: Comment = ""
    digest: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    """Of the results that were reviewed; another one than the run's is refused."""


class WithdrawalRequest(Given):
    """Why a sign-off is no longer good."""

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
    """Who was signed in to the service."""
    created: float
    withdrawn: float | None
    withdrawn_by: str | None
    withdrawn_reason: str | None


class Signoffs(Schema):
    """The sign-offs of a run, the oldest first, and the digest of its results as they are now."""

    digest: str
    can_sign: bool
    """Whether there is a verdict to sign, of a run that is not removed."""
    items: list[Signoff]
