"""What bars "cleared" in a run and would not be stored by the run that continues it.

A violation that is known for a question and its code is a fact, and so is an evaluation that failed. Stages whose
evaluations are not replayed evaluate other points, so that the new run could be cleared without what they had found.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from campaigns.claims.numbers import count
from campaigns.results.base import EXCLUDED, FLAKY, OK
from campaigns.stored.records import Columns, StagePlan

Stored = tuple[StagePlan, Columns]
"""A stage, and evaluations of it."""
MADE_AGAIN = (
    "validation saw a value at or below the threshold where it made an evaluation again to confirm it, which no stage "
    "stores; the new run could be cleared without it"
)
"""By a call of a simulator that does not repeat, at half the step or by the reference integrator."""


def lost(threshold: float, replayed: Iterable[Columns], others: Iterable[Stored]) -> str:
    """Why a run that begins with the replayed evaluations alone could be cleared though these bar it; empty if it
    cannot, because evaluations of the same kind are replayed.

    others: those of the same run that are not replayed.
    """
    kept, left = [*replayed], [*others]
    if any(violations(columns, threshold) for columns in kept):
        return ""
    known = [(stage, number) for stage, columns in left if (number := violations(columns, threshold))]
    if known:
        return _sentence(known, "at or below the threshold")
    failures = [(stage, number) for stage, columns in left if (number := _failures(columns))]
    if failures and not any(map(_failures, kept)):
        return _sentence(failures, "that failed or succeeded only when tried again")
    return ""


def _sentence(numbers: list[tuple[StagePlan, int]], what: str) -> str:
    stages = dict.fromkeys(" ".join(filter(None, (stage.kind, stage.method))) for stage, _ in numbers)
    found = sum(number for _, number in numbers)
    return (
        f"its {'stage' if len(stages) == 1 else 'stages'} {', '.join(stages)} stored {count(found)} "
        f"{'evaluation' if found == 1 else 'evaluations'} {what}, and the stages whose evaluations are replayed stored "
        "none; the new run would evaluate other points there and could be cleared without them"
    )


def violations(columns: Columns, threshold: float) -> int:
    """How many of these evaluations violate."""
    return int(np.count_nonzero(columns.ranked() <= threshold))


def _failures(columns: Columns) -> int:
    failed = np.count_nonzero((columns.status != OK) & (columns.status != EXCLUDED))
    return int(failed) + sum(why.startswith(FLAKY) for why in columns.reasons.values())
