"""The body of a message: the run that ended, and the newest earlier verdict of its campaign. Read `ended`."""

from __future__ import annotations

import datetime
import json
from typing import Any

import sqlalchemy as sa

from backend.db.tables import Run
from backend.runs.outcomes import Outcome, outcomes
from campaigns.runs import run_name, run_number

ENDED, TEST = "run.ended", "test"
"""The types of messages."""


def ended(reader: sa.Connection, run_id: int, public_url: str) -> str:
    (run,) = outcomes(reader, [Run.id == run_id])
    before = earlier(reader, run)
    address = f"{public_url.rstrip('/')}/runs/{run.id}" if public_url else None
    values = {name: getattr(run, name) for name in _REPORTED}
    campaign = {"name": run.campaign_name, "digest": run.campaign_digest, "seed": run.seed}
    changed = before is not None and run.verdict is not None and run.verdict != before.verdict
    owner, token = reader.execute(sa.select(Run.owner, Run.token).where(Run.id == run_id)).one()
    values |= {"owner": owner, "token": token}
    data = {"run": run.id, **values, "campaign": campaign, "address": address, "verdict_changed": changed}
    data["before"] = before and {"run": before.id, **{name: getattr(before, name) for name in _BEFORE}}
    return _written(ENDED, run.finished, data)


def unreadable(run_id: int, at: float) -> str:
    """The message about a run whose stored results this version cannot read."""
    return _written(ENDED, at, {"run": run_name(run_id), "error": "its results were stored by another version"})


def test(at: float) -> str:
    """A message that reports nothing, to try a receiver."""
    return _written(TEST, at, {})


def earlier(reader: sa.Connection, run: Outcome) -> Outcome | None:
    """The newest earlier run of the same campaign that has a verdict and is not removed."""
    same = (Run.campaign_digest == run.campaign_digest, Run.id < run_number(run.id))
    found = outcomes(reader, [*same, Run.verdict.is_not(None), Run.removed.is_(None)], 1)
    return found[0] if found else None


_REPORTED = (
    "name", "state", "verdict", "not_sampled", "earlier_rules", "against", "policy", "error", "unconfirmed", "quantity",
    "unit", "threshold", "worst_cost", "margin", "upper_bound", "bound_source", "excluded_samples", "excluded_fraction",
    "confidence", "code", "created", "finished",
)  # fmt: skip

_BEFORE = ("verdict", "against", "code")


def _written(kind: str, at: float | None, data: dict[str, Any]) -> str:
    when = None if at is None else datetime.datetime.fromtimestamp(at, datetime.UTC).isoformat(timespec="milliseconds")
    return json.dumps({"type": kind, "timestamp": when, "data": data}, allow_nan=False)
