"""The API schema of export files."""

from __future__ import annotations

from backend.http.schema import Schema


class ExportFile(Schema):
    """An export file: its name, its content and its address."""

    name: str
    """R-0001-unicycle-past-a-pillar-evaluations.csv"""
    file: str
    """Its name without that of the run: evaluations.csv"""
    title: str
    text: str
    media_type: str
    href: str
    unavailable: str | None
    """The reason why it is not available now; None if it is."""
