"""Whether a run is cleared by rules of an earlier version.

The single source for lists, comparisons, requirements and reuse.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db.tables import Run
from campaigns.claims.wording import CLEARING
from campaigns.results.verdict import VerdictWord, earlier_rules

_WORDING = Run.summary["provenance", "wording"].as_integer()
COLUMN = sa.case((Run.verdict == VerdictWord.CLEARED, _WORDING)).label("wording")
"""What `of` needs besides the verdict."""

TODAY = sa.or_(Run.verdict != VerdictWord.CLEARED, _WORDING >= CLEARING)
"""Whether a verdict, if there is one, is not of such a run."""


def of(row: Any) -> bool:
    return earlier_rules(row.verdict, row.wording)
