"""The safety-case report as one HTML file; its route is that of reports."""

from backend.exports.format import Format, words

export = Format(
    file="safety-case-report.html",
    order=-2,
    media_type="text/html",
    words=words("Safety-case report, HTML", "One file that prints on A4"),
    address="report.html",
)
