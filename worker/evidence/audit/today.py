"""What a record of an earlier version claims by its rules alone: what is cleared, accepted, fixed or estimated by them,
and not by the rules of today.

A record states its own version, so that an exception for earlier ones shows nothing to whoever can write a record.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from worker.evidence.audit import limits
from worker.evidence.audit.checks import as_stated, required_checks
from worker.evidence.audit.estimate import estimated
from worker.evidence.audit.parts import written
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import MALFORMED, Record
from worker.evidence.audit.regression import examined, regression
from worker.evidence.audit.results import validated


def earlier(run: Run) -> bool:
    """Whether other rules than those of today judge a record."""
    return not run.sealed or run.wording < limits.RULES


def resting(run: Run, record: Record, searches: Mapping[int, Any], at_most: int, spot_checks: int) -> Iterator[str]:
    """The claims of a record that do not hold by the rules of today, as paths; or that these cannot judge."""
    claims, cleared = run.claims, run.claims["verdict"] == "cleared"
    stated, estimates = claims.get("regression"), [k for k, of in enumerate(run.plan) if of.kind == "estimate"]
    if not earlier(run) or not (cleared or stated or estimates):
        return
    try:
        today = Run(record, today=True)
        today.searched = searches
        today.describe()
        checks = required_checks(today, validated(today, at_most, spot_checks).ok)
    except MALFORMED:
        yield "verdict"
        return
    if cleared:
        yield from (f"checks.{name}" for name, holds in checks.items() if not holds)
    for k in estimates:
        yield from (f"results.{k}.{name}" for name in _estimate(today, k))
    if stated:
        yield from (f"regression.{name}" for name in _compared(today, stated, as_stated(run) | checks))


def _estimate(today: Run, k: int) -> Iterator[str]:
    """The numbers of an estimate that are others today."""
    stated = today.claims["results"][k]
    if stated.get("refused") is not None:
        return
    found = written(estimated(today, k))
    for name in ("probability", "low", "high"):
        one, other = (math.nan if of[name] is None else of[name] for of in (stated, found))
        if one != other and not (math.isnan(one) and math.isnan(other)):
            yield name


def _compared(today: Run, stated: Any, checks: dict[str, bool]) -> Iterator[str]:
    """What is accepted or fixed of a comparison with a baseline, or makes no check of it fail, and is not so today."""
    fixed = [k for k, case in enumerate(stated["cases"]) if case["standing"] == "fixed"]
    claimed = [name for name in ("ok", "accepted") if stated.get(name)] + [f"cases.{k}.standing" for k in fixed]
    if not claimed:
        return
    try:
        found = written(regression(today, checks)) if examined(today) else None
    except MALFORMED:
        found = None
    for name in claimed:
        if found is None:
            yield name
        elif name in ("ok", "accepted"):
            yield from [] if found[name] else [name]
        else:
            yield from [] if found["cases"][int(name.split(".")[1])]["standing"] == "fixed" else [name]
