"""Every evaluation of every stage as CSV, written while it is sent; the column headers contain the units."""

from __future__ import annotations

from collections.abc import Iterator

import sqlalchemy as sa

from backend.db.engine import read
from backend.exports.format import Format, words
from backend.exports.sheet import Sheet, sheet
from backend.http.written import lines
from backend.runs import service as runs

END = b"\r\n"


def evaluations_csv(engine: sa.Engine, run_id: int) -> Iterator[bytes]:
    with read(engine) as reader:
        found = sheet(reader, run_id, runs.campaign(reader, run_id))
    return _evaluations_csv(engine, found)


def _evaluations_csv(engine: sa.Engine, found: Sheet) -> Iterator[bytes]:
    yield lines([["stage", "kind", "method", *found.columns]])
    for stage in found.stages:
        stage_cells = lines([[stage.position, stage.kind, stage.method, ""]]).removesuffix(END)
        for block in found.blocks(engine, stage):
            rows = map(b",".join, zip(*block.written(b"", _text), strict=True))
            yield stage_cells + (END + stage_cells).join(rows) + END


def _text(text: str | None) -> bytes:
    """The cell of a text; one in a row of its own would be quoted if it is empty."""
    return b"" if text is None else lines([[text, ""]]).removesuffix(b"," + END)


export = Format(
    file="evaluations.csv",
    order=2,
    media_type="text/csv",
    words=words("Evaluations, CSV", "One row for each stored evaluation of every stage, parameters in their units"),
    streamed=lambda engine, run_id: evaluations_csv(engine, run_id),
)
