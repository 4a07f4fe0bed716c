"""Names of files that a run is taken away as. Start reading at `named`."""

from __future__ import annotations

import re


def named(run: str, name: str, file: str) -> str:
    """R-0001-unicycle-past-a-pillar-run.json: letters, digits and dashes only, whatever the run is called."""
    slug = re.sub(r"[^a-z0-9]+", "-", name.lower())[:48].strip("-")
    return "-".join(part for part in (run, slug, file) if part)
