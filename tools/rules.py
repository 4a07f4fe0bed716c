"""Writes the rules of `campaigns.rules` where no Python reads them: a file for the pages, and tables in the guide.

`python -m tools.rules` writes both; a test compares them.
"""

from __future__ import annotations

import json
from pathlib import Path

from campaigns.documents import JsonObject
from campaigns.rules import LIMITS, RULES

ROOT = Path(__file__).parents[1]
PAGES, GUIDE = ROOT / "frontend/src/api/rules.json", ROOT / "docs/evidence.md"
CHECKS = ("**Cleared** requires all of the following, in this order:\n\n", "\n**Inconclusive**")
NUMBERS = ("in `campaigns/rules.py` once:\n\n", "\n## Audit")
"""The text before and after each table."""


def pages() -> str:
    """The limits by name, and the checks in their order."""
    checks: list[JsonObject] = [
        {"code": rule.code, "title": rule.title, "requires": rule.requires, "intended": rule.intended} for rule in RULES
    ]
    limits = {name.lower(): limit.value for name, limit in LIMITS.items()}
    lines = ",\n".join(f"  {json.dumps(check)}" for check in checks)
    return f'{{\n "limits": {json.dumps(limits)},\n "checks": [\n{lines}\n ]\n}}\n'


def guide(text: str) -> str:
    """The guide with the tables of today."""
    checks = [("Check", "Requires", "Evidence", "A next run changes")]
    checks += [(r.title, r.requires, ", ".join(r.evidence) or "all stages", r.remedy or "") for r in RULES]
    numbers = [("Limit", "Value", "Source")]
    numbers += [(f"`{name}`: {limit.text}", f"{limit.value:g}", limit.source) for name, limit in LIMITS.items()]
    for (before, after), rows in ((CHECKS, checks), (NUMBERS, numbers)):
        lines = [f"| {' | '.join(row)} |".replace("|  |", "| |") for row in rows]
        table = "\n".join([lines[0], "|---" * len(rows[0]) + "|", *lines[1:]])
        start = text.index(before) + len(before)
        text = f"{text[:start]}{table}\n{text[text.index(after, start) :]}"
    return text


if __name__ == "__main__":
    PAGES.write_text(pages(), encoding="utf-8")
    GUIDE.write_text(guide(GUIDE.read_text(encoding="utf-8")), encoding="utf-8")
