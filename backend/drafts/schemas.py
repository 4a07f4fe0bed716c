"""The API schemas of drafts. Times are seconds since 1970."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from backend.http.schema import Given, Instant, Number32, Schema
from backend.runs.requests import Tags

LONGEST = 500_000


class DraftContent(Given):
    """The content of a draft; the text may be incomplete or invalid."""

    name: Annotated[str, Field(max_length=120)]
    """The name of the future run; may be empty."""
    tags: Tags = Field(default_factory=list)
    text: Annotated[str, Field(max_length=LONGEST, description="The original text of the campaign, YAML or JSON.")]


class DraftReplace(DraftContent):
    """A new version of a draft, based on the version that was opened."""

    version: Annotated[Number32, Field(description="The version that was opened or saved last; 409 if outdated.")]
    run: Annotated[str, Field(max_length=20)] | None = None
    """The run started from it, R-0001; unchanged if omitted."""


class DraftSummary(Schema):
    """A draft as in the list."""

    id: str
    version: int
    name: str
    tags: list[str]
    owner: str
    """The user who created it, also by a token."""
    created: Instant
    saved: Instant
    saved_by: str
    run: str | None
    """The last run started from it."""


class Draft(DraftSummary):
    """A draft with its text."""

    text: str
