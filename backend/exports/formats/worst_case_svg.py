"""The worst case and the nominal flight from above as a picture, for a summary of a CI job."""

from __future__ import annotations

import textwrap

import sqlalchemy as sa
from markupsafe import Markup

from backend.exports.format import Format, whole, words
from backend.http.errors import RefusedError
from backend.reports import figures, plan_view
from backend.reports.plot import INK, INK2
from backend.reports.record import Record, load
from campaigns.claims.legible import legible
from campaigns.claims.numbers import signed
from campaigns.results.verdict import headline

PAD, HEAD, LINE = 12, 44, 14
"""Around the figure, and the height of a line of its caption [px]."""
LONGEST = 110
"""Characters of a line of the caption."""
FONT = "system-ui, sans-serif"


def picture(reader: sa.Connection, run_id: int) -> bytes:
    """The SVG; 404 if there is no such run, or no flight of it is stored; 410 if it was purged."""
    record = load(reader, run_id)
    drawn = _drawn(record)
    if drawn is None:
        detail = f"{record.run.id} has no picture of a worst case: no flight of it is stored"
        raise RefusedError("not-found", detail)
    figure, caption, height = drawn
    lines = textwrap.wrap(caption, LONGEST)
    width, total = figures.WIDE + 2 * PAD, height + HEAD + LINE * len(lines) + PAD
    row = Markup('<text x="{}" y="{}" fill="{}">{}</text>')
    rows = Markup("").join(row.format(PAD, height + HEAD + LINE * k, INK2, line) for k, line in enumerate(lines, 1))
    form = (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="{2}" '
        'font-size="9.5"><title>{3}</title><rect width="{0}" height="{1}" fill="#fff"/>'
        '<text x="{4}" y="20" fill="{5}" font-size="13" font-weight="600">{3}</text>'
        '<text x="{4}" y="36" fill="{6}">{7}</text><g transform="translate({4} {8})">{9}</g>{10}</svg>\n'
    )
    values = (width, total, FONT, _title(record), PAD, INK, INK2, legible(record.run.name), HEAD, figure, rows)
    return str(Markup(form).format(*values)).encode()


def _drawn(record: Record) -> tuple[Markup, str, float] | None:
    if not record.cases:
        return None
    plan = plan_view.plan_view(record.cases, record.of)
    if plan is not None:
        return plan, plan_view.caption(record.cases, record.of), plan_view.HEIGHT
    timed = [case for case in record.cases if case.points("t", "separation")]
    if not timed:
        return None
    return figures.separation(timed, record.of), f"{record.of.symbol} over time.", figures.SEPARATION_HEIGHT


def _title(record: Record) -> str:
    """R-0001: violated, worst case F1 with a margin of -0.02 m."""
    run = record.run
    word = headline(run.verdict, run, run.policy, run.against) if run.verdict else run.state
    worst = record.worst
    if worst is None:
        return f"{record.run.id}: {word}"
    margin = f"{signed(worst.margin)} {record.of.unit}".rstrip()
    return f"{record.run.id}: {word}, worst case {worst.label} with a margin of {margin}"


export = Format(
    file="worst-case.svg",
    order=8,
    media_type="image/svg+xml",
    words=words(
        "Worst case, SVG",
        "Flights from above around the closest approach of the worst one",
        (
            "Worst case, SVG",
            "Nominal and worst case where the simulator declares positions, from above or from the side",
        ),
    ),
    made=lambda engine, run_id: whole(engine, run_id, picture),
    offered=lambda stored: None if stored.simulated and not stored.drawn else "",
    needs="flights",
)
