"""The API schemas of requests about runs: submission, edits, several runs at once."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from backend.http.schema import Given
from campaigns.asked.load import LARGEST_FILE
from campaigns.asked.values import Name, Notes
from campaigns.labels import Group, Labels
from campaigns.sample_seed import LARGEST

Tags = Annotated[list[Annotated[str, Field(pattern=r"^[\w.+-]{1,40}$")]], Field(max_length=20)]
Reason = Annotated[Notes, Field(min_length=1, max_length=400, pattern=r"\S")]
Baseline = Annotated[str, Field(min_length=1, max_length=300)]


class RunSubmit(Given):
    """A campaign to run; the campaign's own name and tags are the defaults."""

    checked_elsewhere: ClassVar = frozenset({"campaign"})  # errors in it are located by `campaigns.asked.reading`
    campaign: dict[str, object]
    name: Name | None = None
    tags: Tags | None = None
    labels: Labels = Field(default_factory=dict)
    """By key, such as branch: main, commit: 4f2a91c."""
    baseline: Baseline | None = None
    """The run with which this one is compared, R-0001; or label:branch=main, the newest run of a campaign of the same
    name and criterion with that label. Its findings are evaluated first."""
    reuse: bool = False
    """Answer with an earlier run of the same campaign and code that has a verdict, if there is one."""
    sample_seed: Annotated[int, Field(ge=0, le=LARGEST)] | None = None
    """Repeats the independent sample of an earlier run of the campaign, which states its seed; nothing is cleared with
    one that no run of it with a verdict drew, by the code that evaluates now. If omitted, it is drawn."""
    group: Group | None = None
    """A concurrency group, such as project/branch: runs of the same group that have not ended are cancelled, if the
    submitter may cancel them."""
    text: (
        Annotated[
            str,
            Field(
                max_length=LARGEST_FILE,
                description="Original text of the same campaign, YAML or JSON; stored with its comments and order.",
            ),
        ]
        | None
    ) = None
    priority: Annotated[int, Field(ge=-10, le=10)] = 0


class RunEdit(Given):
    """The user's annotations of a run; omitted fields stay unchanged."""

    name: Name | None = None
    tags: Tags | None = None
    notes: Annotated[str, Field(max_length=20_000, description="Markdown.")] | None = None
    pinned: bool | None = None
    notes_before: Annotated[
        str | None,
        Field(max_length=20_000, description="The notes that were read; refused if changed since."),
    ] = None


class RunsNamed(Given):
    """Several runs by their names, R-0001."""

    runs: Annotated[list[Annotated[str, Field(max_length=20)]], Field(min_length=1, max_length=500)]


class RunsRemoved(RunsNamed):
    """Several runs, and the reason for their removal."""

    reason: Reason
