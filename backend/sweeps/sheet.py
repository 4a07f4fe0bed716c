"""A sweep as CSV (RFC 4180): one row for each run; a number that was not computed is empty."""

from __future__ import annotations

from backend.http.written import headed, lines
from backend.runs.outcomes import Outcome
from backend.sweeps.schemas import PURGED, SweepDetail, SweepPoint
from campaigns.results.verdict import headline


def csv_of(sweep: SweepDetail) -> bytes:
    known = [point.outcome for point in sweep.points if point.outcome is not None]
    quantity = next((found.quantity for found in known if found.quantity), "value")
    unit = next((found.unit for found in known if found.quantity), "")
    headers = [
        headed(sweep.path, sweep.unit), "run", "state", "verdict", headed("criterion", unit),
        headed(f"worst {quantity}", unit), headed("margin", unit), "P(violation) upper bound", "violations",
        "of these failed", "samples", "confidence", "seed", "code", "error", "P(violation) bound source", "removed",
        "unconfirmed", "excluded samples", "excluded fraction", "against",
    ]  # fmt: skip
    rows = map(_row, sweep.points)
    return lines([headers, *([*row, *[None] * (len(headers) - len(row))] for row in rows)])


def _row(point: SweepPoint) -> list[object]:
    found = point.outcome
    if found is None:
        return [point.value, point.run, PURGED]
    return [
        point.value, point.run, found.state, _word(found), found.threshold, found.worst_cost, found.margin,
        found.upper_bound, found.violations, found.failed_samples, found.samples, found.confidence, found.seed,
        found.code, found.error, found.bound_source,
        "yes" if found.removed else "no", found.unconfirmed, found.excluded_samples, found.excluded_fraction,
        found.against,
    ]  # fmt: skip


def _word(found: Outcome) -> str | None:
    return None if found.verdict is None else headline(found.verdict, found, found.policy, found.against)
