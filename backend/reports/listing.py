"""The list of reports: one for every run that has ended and is not removed."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.db.tables import Signoff
from backend.http.root import at
from backend.reports import pdf
from backend.reports.schemas import Report, ReportFile, ReportPage
from backend.runs import listing
from backend.runs.filters import Filters
from backend.runs.schemas import RunSummary
from campaigns.runs import ENDED, run_number


def page(reader: sa.Connection, q: str, cursor: str | None, limit: int) -> ReportPage:
    """One page, newest first. The digest of each run's results is computed from the stored results."""
    found = listing.page(reader, Filters(q=q, state=ENDED), "-created", cursor, limit)
    unavailable = None if pdf.browser() is not None else pdf.MISSING
    items = [_report(reader, run, unavailable) for run in found.items]
    return ReportPage(
        items=items, next_cursor=found.next_cursor, total=sum(found.counts.get(state, 0) for state in ENDED)
    )


def _report(reader: sa.Connection, run: RunSummary, unavailable: str | None) -> Report:
    run_id = run_number(run.id) or 0
    digest = results_digest(reader, run_id)
    standing = sa.select(Signoff.name, Signoff.digest).where(Signoff.run_id == run_id, Signoff.withdrawn.is_(None))
    signoffs = reader.execute(standing.order_by(Signoff.id)).all()
    valid = [row.name for row in signoffs if row.digest == digest]
    address = at(f"/api/v1/runs/{run.id}/report")
    return Report(
        id=f"CLR-{run.id}-{digest[:8]}",
        run=run.id,
        name=run.name,
        campaign_name=run.campaign_name,
        state=run.state,
        verdict=run.verdict,
        not_sampled=run.not_sampled,
        finished=run.finished,
        digest=digest,
        signed=len(valid),
        outdated=len(signoffs) - len(valid),
        signed_by=list(dict.fromkeys(valid)),
        files=[
            ReportFile(format="html", href=f"{address}.html", unavailable=None),
            ReportFile(format="pdf", href=f"{address}.pdf", unavailable=unavailable),
        ],
    )
