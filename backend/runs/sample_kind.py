"""The sample of a run's bound with the draws that it leaves out, and whether nothing but an independent one is missing
to clear it.

The single source for lists and comparisons.
"""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any, Literal, NamedTuple, TypeAlias

import sqlalchemy as sa

from backend.db.tables import Run
from campaigns.results.verdict import VerdictWord, not_sampled
from campaigns.runs import RunState

BoundSource: TypeAlias = Literal["certify", "certify_stated", "search"]
"""The sample of a bound on P(violation); that of a certify stage by whether a user may have chosen its seed."""

STATED = sa.or_(Run.sample_seed.is_(None), Run.sample_seed_stated)
"""Whether the seed of the sample was stated; without one it is that of the campaign, which a user stated."""

COLUMNS = (
    sa.case((Run.verdict == VerdictWord.INCONCLUSIVE, Run.summary["checks"].as_string())).label("checks"),
    Run.summary["statistics", "source"].as_string().label("source"),
    Run.summary["statistics", "samples"].as_integer().label("samples"),
    Run.summary["statistics", "excluded"].as_integer().label("excluded_draws"),
    STATED.label("stated"),
)
"""The columns that `of` needs besides state, verdict and bound. A check of a cleared run does not fail, and in a
violated one never that of the sample alone; reading the checks takes half the time of a row."""


class Sampled(NamedTuple):
    """Fields of the same names of a summary and of an outcome."""

    not_sampled: bool
    bound_source: BoundSource | None
    excluded_samples: int | None
    excluded_fraction: float | None


def of(row: Any) -> Sampled:
    drawn = row.samples or 0 if row.source == "certify" else 0
    lacks = row.state == RunState.DONE and not_sampled(row.verdict, _failing(row.checks), drawn)
    if row.upper_bound is None:
        return Sampled(lacks, None, None, None)
    excluded = row.excluded_draws
    fraction = None if excluded is None else excluded / max(1, excluded + (row.samples or 0))
    return Sampled(lacks, _source(row), excluded, fraction)


def _source(row: Any) -> BoundSource:
    """The sample that gives the bound; a verdict that names none is older than the certify stage."""
    if row.source == "certify":
        return "certify_stated" if row.stated else "certify"
    return "search"


@lru_cache(maxsize=512)
def _failing(checks: str | None) -> tuple[str, ...]:
    """The names of the checks that fail; reading the checks of a page of the list takes a quarter of its time."""
    return tuple(check["name"] for check in json.loads(checks or "[]") or [] if not check["ok"])
