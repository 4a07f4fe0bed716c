"""What the API says of the files a run can be taken away as. Start reading at `ExportFile`."""

from __future__ import annotations

from backend.http.schema import Schema


class ExportFile(Schema):
    """One file: its name when saved, what is in it, and where it is asked for."""

    name: str
    """R-0001-unicycle-past-a-pillar-evaluations.csv"""
    title: str
    text: str
    media_type: str
    href: str
    unavailable: str | None
    """Why it cannot be had now; None where it can."""
