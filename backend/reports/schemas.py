"""The API schemas of the list of reports."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Instant, Schema
from backend.signoffs.schemas import Signoff
from campaigns.results.regression import PolicyWord
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState


class ReportFile(Schema):
    """A report in one format."""

    format: Literal["html", "pdf"]
    href: str
    """Its address; the file is made when it is requested."""
    unavailable: str | None
    """Why it cannot be made; null if it can."""


class Report(Schema):
    """The report of a run that has ended. Times are seconds since 1970."""

    id: str
    """CLR-R-0001-0123abcd: the run and the first digits of the digest of its results, as printed on the report."""
    run: str
    """R-0001"""
    name: str
    campaign_name: str
    state: RunState
    verdict: VerdictWord | None
    not_sampled: bool
    """Whether nothing but an independent sample is missing to clear it."""
    earlier_rules: bool
    """Whether it is cleared by the rules of an earlier version, and `clearance audit` names what does not hold by those
    of today."""
    against: str
    """As of the run: which others speak against its verdict, a sentence; empty if none does."""
    policy: PolicyWord | None
    """What the campaign's policy says of the changes since the baseline: `holds`; `fails`, which is exit code 1
    whatever the verdict; `accepts`, a violated run whose violations were all known. None without a comparison.
    """
    finished: Instant | None
    digest: str
    """SHA-256 of the results."""
    signoffs: list[Signoff]
    """Those that were not withdrawn, with those of an earlier run that this one repeats bit by bit."""
    files: list[ReportFile]


class ReportPage(Schema):
    """A page of the list of reports."""

    items: list[Report]
    next_cursor: str | None
    total: int
    """How many runs have ended, of those that match the search."""
    note: str
    """If the search names a report whose run has a report of another number by now: why. Otherwise empty."""
