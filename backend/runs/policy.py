"""What the policy of a run's campaign says on the changes since its baseline.

The single source for lists, comparisons, requirements and webhooks.
"""

from __future__ import annotations

from typing import Any

from backend.db.tables import Run
from campaigns.results.regression import PolicyWord, policy_word
from campaigns.runs import RunState

COLUMNS = (
    Run.summary["regression", "ok"].as_boolean().label("policy_ok"),
    Run.summary["regression", "accepted"].as_boolean().label("policy_accepted"),
)
"""The columns that `of` needs besides state and verdict."""


def of(row: Any) -> PolicyWord | None:
    return policy_word(row.policy_ok, row.policy_accepted, row.verdict) if row.state == RunState.DONE else None
