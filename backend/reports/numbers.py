"""The number of a report: its run, and the first digits of the digest of the run's results.

A report in hand is searched for by its number. Read `searched`.
"""

from __future__ import annotations

import re

import sqlalchemy as sa

from backend.db.digest import digest_before_0033, results_digest
from backend.db.tables import Run
from campaigns.runs import ENDED, run_name

_NUMBER = re.compile(r"\bCLR-R-(\d{1,9})-([0-9a-f]{8})\b", re.IGNORECASE)


def printed(run: str, digest: str) -> str:
    """CLR-R-0001-0123abcd."""
    return f"CLR-{run}-{digest[:8]}"


def searched(reader: sa.Connection, words: str) -> tuple[str, str]:
    """Search words with the run in place of a report's number; why its report has another one by now, empty if not."""
    found = _NUMBER.search(words)
    if found is None:
        return words, ""
    run_id = int(found[1])
    ended = (Run.id == run_id, Run.state.in_(ENDED), Run.removed.is_(None))
    there = reader.scalar(sa.select(Run.id).where(*ended)) is not None
    words = words[: found.start()] + run_name(run_id) + words[found.end() :]
    return words, _note(reader, run_id, found[0], found[2].lower()) if there else ""


def _note(reader: sa.Connection, run_id: int, number: str, digits: str) -> str:
    digest = results_digest(reader, run_id)
    if digest.startswith(digits):
        return ""
    now = printed(run_name(run_id), digest)
    if digest_before_0033(reader, run_id).startswith(digits):
        return (
            f"{number} is the report of these same results by an earlier version, for which the lowest value of a run "
            f"without a verdict was that of its searches alone; now it is that of every stage, and the number is {now}."
        )
    return (
        f"{number} is the report of other results: those of {run_name(run_id)} have changed since, and their report is "
        f"{now}. The history of the run states what was done to it."
    )
