"""Newer runs that repeat a signed one: the same campaign and code, and the same evaluations and results bit by bit."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db.repeats import repeat_digest
from backend.db.tables import CampaignRow, Run
from backend.runs import identity
from backend.signoffs.present import counted
from campaigns.identity.identity import Identity
from campaigns.runs import RunState

OTHER_CAMPAIGN = "it is of another campaign"
OTHER_CODE = "it was run by other code, or by code that is not identified"
OTHER_RESULTS = "its evaluations or results are not the same bit by bit"


def other_sample(seed: int) -> str:
    """seed: of the sample that it does not repeat."""
    return f"its sample has another seed (--sample-seed {seed} repeats that one)"


LOOKED_AT = 20
"""Later runs of the campaign that are examined, the newest first."""

_ALIKE = (
    "verdict",
    "nominal_cost",
    "worst_cost",
    "upper_bound",
    "evaluations",
    "failed_evaluations",
)
"""Compared first, because reading all evaluations of a run takes time."""
COLUMNS = (Run.id, Run.campaign_digest, Run.sample_seed, *identity.COLUMNS, *(getattr(Run, name) for name in _ALIKE))
"""What a row has that is compared."""
CONCLUDED = (Run.state == RunState.DONE, Run.verdict.is_not(None), *counted())
"""Runs that can repeat or be repeated; a variant of a sweep is no repetition."""


class Repeats:
    """Compares runs; reads the evaluations of each at most once."""

    def __init__(self, reader: sa.Connection) -> None:
        self._reader = reader
        self._digests: dict[int, str] = {}

    def difference(self, one: Any, other: Any) -> str | None:
        """Why a run does not repeat another, as rows of `COLUMNS`, as a clause; None if it does."""
        if one.campaign_digest != other.campaign_digest:
            return OTHER_CAMPAIGN
        if not same_code(identity.of_row(one), identity.of_row(other)):
            return OTHER_CODE
        alike = all(getattr(one, name) == getattr(other, name) for name in _ALIKE)
        if alike and self._digest(one.id) == self._digest(other.id):
            return None
        if None not in (one.sample_seed, other.sample_seed) and one.sample_seed != other.sample_seed:
            return other_sample(other.sample_seed)
        return OTHER_RESULTS

    def newest(self, run: Any) -> int | None:
        """The newest later run that repeats one."""
        later = sa.select(*COLUMNS).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        later = later.where(Run.campaign_digest == run.campaign_digest, Run.id > run.id, *CONCLUDED)
        rows = self._reader.execute(later.order_by(Run.id.desc()).limit(LOOKED_AT)).all()
        return next((row.id for row in rows if self.difference(row, run) is None), None)

    def _digest(self, run_id: int) -> str:
        if run_id not in self._digests:
            self._digests[run_id] = repeat_digest(self._reader, run_id)
        return self._digests[run_id]


def same_code(one: Identity | None, other: Identity | None) -> bool:
    """Whether the same code ran two runs; what is not stored, or not identified, is not taken for equal."""
    return one is not None and other is not None and one.digest is not None and one.digest == other.digest
