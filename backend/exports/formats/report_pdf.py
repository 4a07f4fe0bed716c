"""The safety-case report as PDF; its route is that of reports."""

from backend.exports.format import Format, words
from backend.reports import pdf

export = Format(
    file="safety-case-report.pdf",
    order=-1,
    media_type="application/pdf",
    words=words("Safety-case report, PDF", "The report on A4 pages"),
    address="report.pdf",
    missing=lambda: None if pdf.browser() else "needs Chromium on the service's machine",
)
