"""The API schemas of sign-offs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from backend.http.schema import Given, Instant, Schema
from campaigns.asked.values import Name, Notes

Comment = Annotated[Notes, Field(max_length=4000)]
Standing = Literal["standing", "carried on", "suspect", "of other results", "withdrawn"]
"""The worst that is true of a sign-off is the last in this list."""


class SignoffRequest(Given):
    """A reviewer's sign-off of the results that they reviewed."""

    name: Name | None = None
    """Only on a service without accounts; otherwise the account signs."""
    role: Name
    """The title under which they sign."""
    comment: Comment = ""
    digest: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    """The digest of the reviewed results; refused if it is not the run's current one."""
    texts: Annotated[dict[str, str], Field(max_length=1000)] | None = None
    """The texts of the requirements that were reviewed, as the list of sign-offs had them; refused if one has changed.
    Without them the sign-off is of the texts of now."""
    against: Annotated[dict[str, str], Field(max_length=100_000)] | None = None
    """How other runs speak against the verdict, as the list of sign-offs had them: the sign-off stands all the same,
    for the reason in its comment, which is then required. Refused if this has changed. Without it such a sign-off is
    suspect."""


class WithdrawalRequest(Given):
    """The reason why a sign-off is withdrawn."""

    reason: Annotated[Comment, Field(min_length=1)]


class Signoff(Schema):
    """One sign-off and its standing; it is never edited. Times are seconds since 1970."""

    id: int
    run: str
    """The run whose results were signed, R-0001: an earlier one if it is carried on."""
    name: str
    """Who signed: the account, or without accounts the name as typed."""
    typed: bool
    """Whether the name was typed on a service without accounts; no sign-in confirms it."""
    stated: str | None
    """The name that an earlier version let the account type as well."""
    role: str
    """The title, as typed."""
    comment: str
    digest: str
    current: bool
    """Whether the results are still those that were signed."""
    standing: Standing
    """`standing`: of these results, and no change is known; `carried on`: so, and a newer run repeats them."""
    reasons: list[str]
    """Why it is suspect: what has changed since, as clauses."""
    repeated_by: str | None
    """The newest run that repeats the signed one: the same campaign and code, and the same evaluations bit by bit."""
    sentence: str
    """The standing in words."""
    account: str
    """The user who was signed in to the service, also by a token."""
    user: str
    """That user, or the name of the API token."""
    own: bool
    """Whether this user also launched the run: such a sign-off is not independent."""
    created: Instant
    withdrawn: Instant | None
    withdrawn_by: str | None
    withdrawn_reason: str | None


def signed_by(signoff: Signoff) -> str:
    """Who signed, in files: ada (Independent review)."""
    return f"{signoff.name} ({signoff.role}{', name as typed' if signoff.typed else ''})"


class Signoffs(Schema):
    """The sign-offs of a run, oldest first, with those that it carries on, and the digest of its current results."""

    digest: str
    can_sign: bool
    """Whether the run can be signed off: it has a verdict and is not removed."""
    barred: str | None = None
    """Why the caller may not sign it off, such as having launched it; null if they may."""
    signs_as: str | None = None
    """The account under which the caller signs; null on a service without accounts, where a name is typed."""
    texts: dict[str, str] = Field(default_factory=dict)
    """The requirements that the run states, by id, with the texts of now: a new sign-off is bound to them."""
    against: dict[str, str] = Field(default_factory=dict)
    """How other runs speak against its verdict, by run: it `violates`, it `found` a value at or below the threshold, or
    it saw `beyond` the horizon what bars a cleared verdict."""
    not_carried: str | None = None
    """Why the sign-offs of the newest signed run of this campaign before it do not count here, if none does."""
    items: list[Signoff]
