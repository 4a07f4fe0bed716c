"""Names of export files."""

from __future__ import annotations

import re


def named(run: str, name: str, file: str) -> str:
    """R-0001-unicycle-past-a-pillar-run.json: only letters, digits and dashes, for any run name."""
    slug = re.sub(r"[^a-z0-9]+", "-", name.lower())[:48].strip("-")
    return "-".join(part for part in (run, slug, file) if part)
