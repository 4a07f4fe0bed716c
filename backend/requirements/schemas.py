"""The API schemas of requirements, their files and the matrix. Times are seconds since 1970."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from backend.http.schema import Given, Instant, Schema
from backend.requirements.standing import Status
from backend.runs.outcomes import Outcome
from backend.signoffs.schemas import Signoff
from campaigns.asked.requirements import RequirementId
from campaigns.asked.values import Notes

FileKind = Literal["csv", "reqif"]


class RequirementGiven(Given):
    """A requirement that is written here."""

    id: RequirementId
    text: Annotated[Notes, Field(min_length=1)]


class RequirementRun(Outcome):
    """One run of a requirement: an edge of the matrix."""

    part: Literal["evidence", "violation", "other"]
    """`evidence`: the newest run of its campaign with a verdict, or the newest if none has one; `violation`: it
    violates, or found a value that would, and nothing has changed since; `other`: it does not count."""
    role: str
    """The same in words; empty for evidence that does not violate. A run that found a value at or below a threshold
    that was raised since has another verdict."""
    signoffs: list[Signoff]
    """Those that were not withdrawn, with those of an earlier run that this one repeats bit by bit."""
    signed: bool
    """Whether a sign-off covers the current results."""
    suspect: bool
    """Whether it is signed off and every sign-off is suspect: campaign, model, simulator or the text of the requirement
    has changed."""
    changes: list[str]
    """What has changed since the run, as clauses; none if a sign-off is valid."""
    evidence_digest: str | None
    """The evidence digest that its verdict states, which `clearance audit` computes again; null without a verdict, and
    for runs of earlier versions."""


class RequirementRow(Schema):
    """One requirement with the runs whose campaigns state it."""

    id: str
    text: str
    """As imported or written here; if it is neither, as the newest run states it."""
    status: Status
    sentence: str
    """Why it has this status."""
    registered: bool
    """False: only campaigns state it."""
    file: str | None
    """The name of the file that it was imported from."""
    attributes: dict[str, str]
    """The other attributes of its file."""
    changed: Instant | None
    changed_by: str | None
    etag: str
    """The entity tag of its registered text, for `If-Match` of an edit; that of no text if it is not registered."""
    runs: list[RequirementRun]
    """Those that count, then the newest others."""
    total: int
    """How many runs there are, without removed ones and those of sweeps."""
    unlisted: int
    """How many of them `runs` does not have."""
    removed: int
    """Removed runs, which do not count."""
    sweeps: int
    """Runs of sweeps, which do not count: they are of other values."""


class RequirementPage(Schema):
    """A page of the matrix, in the order of the ids."""

    items: list[RequirementRow]
    next_cursor: str | None
    total: int
    """How many requirements there are."""
    compared: bool
    """Whether live workers report the code that signed-off runs are compared with; if not, all are suspect."""


class RequirementFileOut(Schema):
    """An imported file."""

    id: int
    name: str
    kind: FileKind
    digest: str
    """SHA-256 of its bytes."""
    size: int
    """Bytes."""
    requirements: int
    imported: Instant
    imported_by: str


class Imported(Schema):
    """What an import has done."""

    file: RequirementFileOut
    added: list[str]
    changed: list[str]
    """Ids with another text than before."""
    unchanged: int
    gone: list[str]
    """Ids that an earlier file of the same name had and this one lacks; they are no longer registered."""
    skipped: int
    """Objects of the file without a text, such as headings."""
