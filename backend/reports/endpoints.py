"""A run's report for a safety case, as HTML and as PDF, and the list of reports."""

from __future__ import annotations

from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import HTMLResponse

from backend.db.engine import now, read
from backend.http.deps import Engine, Reader, account, capacities
from backend.http.errors import answers, problems
from backend.http.naming import disposition
from backend.http.schema import RunName
from backend.reports import listing, pdf, service
from backend.reports.cache import Page
from backend.reports.schemas import ReportPage
from backend.runs.service import number

router = APIRouter(tags=["reports"])

_HTML = answers("One self-contained file.", "text/html")
_WORDS = "Words in the name, campaign, tags, owner or number of the run, or the number of a report."
_PDF = answers("The report on A4 pages.", "application/pdf", binary=True)


@router.get(
    "/runs/{run}/report.html",
    response_class=HTMLResponse,
    responses=_HTML | problems("not-found", "other-version", "purged"),
)
async def get_report(run: RunName, request: Request, engine: Engine) -> Response:
    """The report of a run for a safety case: one self-contained file that prints on A4."""
    run_id = number(run)
    page = await capacities(request).files.run(
        account(request), lambda: _made(request, engine, run_id), request.is_disconnected
    )
    headers = {
        "Content-Disposition": disposition("inline", f"{page.file}.html"),
        "Content-Security-Policy": f"{page.policy}; frame-ancestors 'none'",
    }
    return HTMLResponse(page.html, headers=headers)


@router.get(
    "/runs/{run}/report.pdf",
    response_class=Response,
    responses=_PDF | problems("not-found", "other-version", "purged", "no-browser", "browser-failed", "busy"),
)
async def get_report_pdf(run: RunName, request: Request, engine: Engine) -> Response:
    """The report as PDF, printed by Chromium on the service's machine; 503 with instructions if it is not installed."""
    run_id = number(run)

    def printed() -> tuple[str, bytes]:
        page = _made(request, engine, run_id)
        return page.file, pdf.printed(page.html, request.app.state.settings.browser_sandbox)

    file, content = await capacities(request).pdf.run(account(request), printed, request.is_disconnected)
    headers = {"Content-Disposition": disposition("attachment", f"{file}.pdf")}
    return Response(content, headers=headers, media_type="application/pdf")


@router.get("/reports", responses=problems("bad-cursor"))
def list_reports(
    reader: Reader,
    q: Annotated[str, Query(max_length=200, description=_WORDS)] = "",
    cursor: Annotated[str | None, Query(max_length=1000, description="`next_cursor` of the previous page.")] = None,
    limit: Annotated[int, Query(ge=1, le=50, description="Maximum number of reports on a page.")] = 20,
) -> ReportPage:
    """The reports of all runs that have ended, newest first, with verdict, sign-offs and digest, in pages."""
    return listing.page(reader, q, cursor, limit)


def _made(request: Request, engine: sa.Engine, run_id: int) -> Page:
    with read(engine) as reader:
        return service.report_html(reader, run_id, now(reader), request.app.state.settings.pages)
