"""What bars "cleared" in a run and would not be stored by the run that continues it.

A violation that is known for a question and its code is a fact, and so is an evaluation that failed. Stages whose
evaluations are not replayed evaluate other points, so that the new run could be cleared without what they had found:
`lost`. What validation saw where it made evaluations again, or simulated them on, no stage stores: `unstored`.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from campaigns.asked.spec import Campaign
from campaigns.claims.numbers import count
from campaigns.results import StageResult
from campaigns.results.base import EXCLUDED, FLAKY, OK
from campaigns.stored.records import Columns, StagePlan

Stored = tuple[StagePlan, Columns]
"""A stage, and evaluations of it."""
UNSTORED = ", which no stage stores; the new run could be cleared without it"
MADE_AGAIN = (
    "validation saw a value at or below the threshold where it made an evaluation again to confirm it" + UNSTORED
)
"""By a call of a simulator that does not repeat, at half the step or by the reference integrator."""
OF_SAMPLE = " of the sample"
"""How the names of flights of the independent sample end."""
UNCONFIRMED = f"validation made evaluations again that had another value then, or none{UNSTORED}"


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


def unstored(campaign: Campaign, result: StageResult | None, replayed: Iterable[Columns], sampled: bool) -> str:
    """Why a run that begins with the replayed evaluations could be cleared, though what validation alone saw bars it;
    empty if it cannot. sampled: whether the new run has the same independent sample."""
    kept, threshold = [*replayed], campaign.criterion.threshold
    if result is None or any(violations(columns, threshold) for columns in kept):
        return ""
    if any(value <= threshold for value in result.made_again):
        return MADE_AGAIN
    if any(map(_failures, kept)):
        return ""
    if why := _beyond(campaign, result.later, sampled):
        return f"validation {why}{UNSTORED}; lengthen the horizon"
    return UNCONFIRMED if result.unconfirmed else ""


def _beyond(campaign: Campaign, later: Iterable[tuple[str, float | None]], sampled: bool) -> str:
    """What bars "cleared" after the horizon, unless the new run simulates that flight on as well: it does the nominal
    case and its sample, and others that are far from each other."""
    intended, threshold = "closest_approach" in campaign.encounter.intended, campaign.criterion.threshold
    for name, value in later:
        again = name == "nominal" or (sampled and name.endswith(OF_SAMPLE))
        if value is None and not again:
            return f"could not determine how close {name} comes after the horizon"
        if value is not None and not again and not (intended and value > threshold):
            return f"saw {name} come closer after the horizon than any evaluation"
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
