"""Files that know a kind of stage: three for a new one, its declaration, its engine file and its section of a page.

All others read what a kind declares (`campaigns.stages.declared`) and the properties of any result
(`campaigns.results.stage`).
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from campaigns.rules import RULES
from campaigns.stages.found import declared
from tests.given.source_texts import texts

ROOT = Path(__file__).parents[3]
SOURCES = ("backend/**/*.py", "campaigns/**/*.py", "clearance/**/*.py", "worker/**/*.py", "frontend/src/**/*.ts*")
SKIPPED = (
    "worker/evidence/audit/",  # a second program on purpose: it knows every stage again
    "backend/db/migrations/",  # written for the stages of their time
    "frontend/src/client/",  # generated
)
OLDER = {"search": 15, "validate": 12}
"""The searches and the validation are what verdict, report and pages are about: their result types are words of these.
Only ever fewer."""


def searched() -> dict[str, str]:
    """By path, the text of every file that is searched."""
    return {
        path: text for path, text in texts(*SOURCES).items() if not path.startswith(SKIPPED) and ".test." not in path
    }


def knowing(kind: str, result: str) -> list[str]:
    """The files that name the type of its result, or compare a kind with its name."""
    named = re.compile(
        rf"\b{result}\b|\b(?:kind|stage)\b\W{{1,12}}[\"']{kind}[\"']|in_\(.*[\"']{kind}[\"']"
        rf"|(?:stageOf|resultOf)\(.*'{kind}'|(?:Stage|Declared|StagePlan|index)\([\"']{kind}[\"']"
    )
    found = [f"campaigns/rules.py ({kind})"] if any(kind in rule.evidence for rule in RULES) else []
    found += [f"frontend/src/run/stages/{kind}.tsx"] if (ROOT / f"frontend/src/run/stages/{kind}.tsx").exists() else []
    found += [p for p, text in searched().items() if (kind in text or result in text) and named.search(text)]
    return sorted(set(found))


@pytest.mark.parametrize("kind", declared())
def test_a_stage_is_known_in_few_files(kind: str) -> None:
    files = knowing(kind, declared()[kind].result.__name__)
    assert {f"campaigns/stages/{kind}.py", f"worker/engine/stages/{kind}.py"} <= set(files)
    assert len(files) <= OLDER.get(kind, 3), files
