"""The guide lists the statuses of a requirement that there are, in the words of pages and of files, the worst first."""

from __future__ import annotations

import re
from pathlib import Path

from backend.requirements.standing import ORDER

ROOT = Path(__file__).parents[4]


def test_the_guide_has_every_status_and_no_other() -> None:
    guide = (ROOT / "docs" / "requirements.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([^|]+) \|", guide.partition("| status | means |")[2].partition("\n\n")[0], re.MULTILINE)
    pages = (ROOT / "frontend" / "src" / "requirements" / "status.ts").read_text(encoding="utf-8")
    words = dict(re.findall(r"^  '?([a-z ]+)'?: \{ word: '([^']+)'", pages, re.MULTILINE))
    assert [*words] == [*ORDER]
    listed = [(row.partition(" (")[0], re.findall(r"`([^`]+)`", row)) for row in rows]
    assert listed == [(words[one].lower(), [one] * (words[one].lower() != one)) for one in ORDER]
