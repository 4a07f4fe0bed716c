"""Whether nothing but an independent sample is missing to clear a run: the single source for lists and comparisons."""

from __future__ import annotations

from typing import Any

from backend.db.tables import Run
from campaigns.results.verdict import not_sampled
from campaigns.runs import RunState

COLUMNS = (
    Run.summary["checks"].as_json().label("checks"),
    Run.summary["statistics", "source"].as_string().label("source"),
    Run.summary["statistics", "samples"].as_integer().label("samples"),
)
"""The columns that `of` needs besides state and verdict."""


def of(row: Any) -> bool:
    drawn = row.samples or 0 if row.source in (None, "certify") else 0
    failing = [check["name"] for check in row.checks or [] if not check["ok"]]
    return row.state == RunState.DONE and not_sampled(row.verdict, failing, drawn)
