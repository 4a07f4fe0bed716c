"""What the API says of drafts. Times are seconds since 1970. Start reading at `Draft`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.http.schema import Given, Number32, Schema
from backend.runs.schemas import Tags

LONGEST = 500_000


class DraftContent(Given):
    """What is kept of a campaign that is being prepared; the text may be incomplete or wrong."""

    name: Annotated[str, Field(max_length=120)]
    """Of the run that it is to become; may be empty."""
    tags: Tags = Field(default_factory=list)
    text: Annotated[str, Field(max_length=LONGEST, description="The original text of the campaign, YAML or JSON.")]


class DraftReplace(DraftContent):
    """A draft saved again: over the version that was opened."""

    version: Annotated[Number32, Field(description="That was opened or saved last; 409 where there is a newer one.")]
    run: Annotated[str, Field(max_length=20)] | None = None
    """The run that was started from it, R-0001; left out, what is known stays."""


class DraftSummary(Schema):
    """A draft as the list shows it."""

    id: str
    version: int
    name: str
    tags: list[str]
    owner: str
    """Who made it."""
    created: float
    saved: float
    saved_by: str
    run: str | None
    """The run that was last started from it."""


class Draft(DraftSummary):
    """A draft with its text."""

    text: str
