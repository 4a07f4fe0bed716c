"""Loads the campaign given to a command: a file, or the name of one in the library."""

from __future__ import annotations

from pathlib import Path

from campaigns import Campaign, CampaignError, library, load_file
from campaigns.asked.problem import Problem
from campaigns.checked import texts


def read_campaign(file: Path) -> Campaign:
    """The campaign of a file, or of the library if there is no such file; raises `CampaignError`."""
    return load_file(found(file))


def found(file: Path) -> Path:
    """The file itself, or that of the library if there is none of this name; raises `CampaignError` for a name of
    neither."""
    shipped = library()
    if file.exists() or len(file.parts) != 1 or file.suffix:
        return file
    if str(file) not in shipped:
        known = texts.known(str(file), list(shipped))
        raise CampaignError(
            str(file), [Problem("", str(file), f"neither a file nor a campaign of the library; {known}")]
        )
    return shipped[str(file)]
