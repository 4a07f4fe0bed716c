"""How often the service was asked the question of a run: the same system, bounds and criterion, at any threshold."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import Run
from campaigns.results.verdict import VerdictWord


def asked_again(reader: sa.Connection, run_id: int) -> dict[str, int]:
    """How many runs ask the question of this one, by verdict: whoever repeats it until it is cleared is seen.

    None, not even itself, where its question is not stored, as by an earlier version.
    """
    question = reader.scalar(sa.select(Run.question).where(Run.id == run_id))
    if question is None:  # of a version that did not store it: nothing is known to ask the same
        return {}
    verdict = sa.func.coalesce(Run.verdict, "none")
    of = sa.select(verdict, sa.func.count()).where(Run.question == question).group_by(verdict)
    found: dict[str, int] = {word: n for word, n in reader.execute(of)}  # noqa: C416
    return {word: found[word] for word in (*VerdictWord, "none") if word in found}
