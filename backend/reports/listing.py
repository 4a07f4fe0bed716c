"""The list of reports: one for every run that has ended and is not removed."""

from __future__ import annotations

from collections.abc import Mapping

import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.http.root import at
from backend.reports import numbers, pdf
from backend.reports.schemas import Report, ReportFile, ReportPage
from backend.runs import listing
from backend.runs.filters import Filters
from backend.runs.order import NEWEST
from backend.runs.schemas import RunSummary
from backend.signoffs.standing import UNSIGNED, Signed, signatures
from campaigns.runs import ENDED, run_number


def page(reader: sa.Connection, q: str, cursor: str | None, limit: int) -> ReportPage:
    """One page, newest first. The digest of each run's results is computed from the stored results."""
    words, note = numbers.searched(reader, q)
    found = listing.page(reader, Filters(q=words, state=list(ENDED)), NEWEST, cursor, limit, pins=False)
    unavailable = None if pdf.browser() is not None else pdf.MISSING
    signed = signatures(reader, [run_number(run.id) or 0 for run in found.items])
    items = [_report(reader, run, unavailable, signed) for run in found.items]
    total = sum(found.counts.get(state, 0) for state in ENDED)
    return ReportPage(items=items, next_cursor=found.next_cursor, total=total, note=note)


def _report(reader: sa.Connection, run: RunSummary, unavailable: str | None, signed: Mapping[int, Signed]) -> Report:
    run_id = run_number(run.id) or 0
    digest = results_digest(reader, run_id)
    address = at(f"/api/v1/runs/{run.id}/report")
    return Report(
        id=numbers.printed(run.id, digest),
        run=run.id,
        name=run.name,
        campaign_name=run.campaign_name,
        state=run.state,
        verdict=run.verdict,
        not_sampled=run.not_sampled,
        earlier_rules=run.earlier_rules,
        against=run.against,
        policy=run.policy,
        finished=run.finished,
        digest=digest,
        signoffs=[one.signoff() for one in signed.get(run_id, UNSIGNED).signatures if one.row.withdrawn is None],
        files=[
            ReportFile(format="html", href=f"{address}.html", unavailable=None),
            ReportFile(format="pdf", href=f"{address}.pdf", unavailable=unavailable),
        ],
    )
