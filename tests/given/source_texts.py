"""The texts of the repository's files, for tests that search all of them: read once in a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]


@cache
def texts(*patterns: str) -> dict[str, str]:
    """By path, the text of every file that one of the patterns matches, such as backend/**/*.py."""
    files = [file for pattern in patterns for file in sorted(ROOT.glob(pattern))]
    return {file.relative_to(ROOT).as_posix(): file.read_text("utf-8") for file in files}
