"""Loads the campaign given to a command: a file, or the name of one in the library."""

from __future__ import annotations

from pathlib import Path

from campaigns import Campaign, library, load_file


def read_campaign(file: Path) -> Campaign:
    """The campaign of a file, or of the library if there is no such file; raises `CampaignError`."""
    return load_file(found(file))


def found(file: Path) -> Path:
    """The file itself, or that of the library if there is none of this name."""
    shipped = library()
    return shipped[str(file)] if not file.exists() and str(file) in shipped else file
