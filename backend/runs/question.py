"""How often the service was asked the question of a run: the same system, bounds and criterion, at any threshold."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.engine import once
from backend.db.rows import at_or_below
from backend.db.tables import Run
from campaigns.results.verdict import VerdictWord

UNCONFIRMED = "unconfirmed"
WORDS = {"none": "without a verdict", UNCONFIRMED: "without a verdict that found a value at or below the threshold"}


def asked_again(reader: sa.Connection, run_id: int) -> dict[str, int]:
    """How many runs ask the question of this one, by verdict: whoever repeats it until it is cleared is seen.

    Without a verdict they are `unconfirmed` if they found a value at or below the threshold of this run, else `none`.
    No run, not even itself, where its question is not stored, as by an earlier version.
    """
    return once(reader, ("asked", run_id), lambda: _asked_again(reader, run_id))


def _asked_again(reader: sa.Connection, run_id: int) -> dict[str, int]:
    of = sa.select(Run.question, Run.threshold).where(Run.id == run_id)
    question, threshold = reader.execute(of).one_or_none() or (None, None)
    if question is None:  # of a version that did not store it: nothing is known to ask the same
        return {}
    lower = sa.false() if threshold is None else at_or_below(threshold)
    word = sa.case((Run.verdict.is_not(None), Run.verdict), (lower, UNCONFIRMED), else_="none").label("word")
    asking = sa.select(word).where(Run.question == question).subquery()
    counts = reader.execute(sa.select(asking.c.word, sa.func.count()).group_by(asking.c.word))
    found: dict[str, int] = {word: n for word, n in counts}  # noqa: C416
    return {word: found[word] for word in (*VerdictWord, UNCONFIRMED, "none") if word in found}
