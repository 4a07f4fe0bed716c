"""All rows of the stored flights as CSV; the column `flight` identifies the flight."""

from __future__ import annotations

from collections.abc import Iterator

import sqlalchemy as sa

from backend.exports.format import Format, whole, words
from backend.http.written import finite, headed, lines
from backend.results import service as results


def traces_csv(reader: sa.Connection, run_id: int) -> Iterator[bytes]:
    """All flights in sequence; columns that a flight does not have are empty."""
    flights = results.traces(reader, run_id)
    heads = {c.name: headed(c.name, c.unit) for flight in flights for c in flight.columns}
    yield lines([["flight", *heads.values()]])
    for flight in flights:
        row = results.stored(reader, run_id, flight.name)
        data = results.table(row)
        place = {column["name"]: k for k, column in enumerate(row.columns)}
        chosen = [data[:, place[name]].tolist() if name in place else [None] * len(data) for name in heads]
        yield lines([[flight.name, *map(finite, values)] for values in zip(*chosen, strict=True)])


export = Format(
    file="traces.csv",
    order=5,
    media_type="text/csv",
    words=words(
        "Flights, CSV",
        "Nominal flight and every finding over time",
        ("Traces, CSV", "Nominal case and every finding over time"),
    ),
    made=lambda engine, run_id: whole(engine, run_id, traces_csv),
    needs="flights",
)
