"""Every evaluation of every stage as CSV, written while it is sent; the column headers contain the units."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import repeat

import numpy as np
import sqlalchemy as sa
from pydantic_core import to_json

from backend.db.engine import read
from backend.exports.format import Format, words
from backend.exports.sheet import Block, Sheet, sheet
from backend.http.written import cells, lines
from backend.runs import service as runs
from campaigns.results.base import STATUS

END = b"\r\n"
_STATUS = [status.encode() for status in STATUS]


def evaluations_csv(engine: sa.Engine, run_id: int) -> Iterator[bytes]:
    with read(engine) as reader:
        found = sheet(reader, run_id, runs.campaign(reader, run_id))
    return _evaluations_csv(engine, found)


def _evaluations_csv(engine: sa.Engine, found: Sheet) -> Iterator[bytes]:
    yield lines([["stage", "kind", "method", *found.columns]])
    for stage in found.stages:
        stage_cells = lines([[stage.position, stage.kind, stage.method, ""]]).removesuffix(END)
        for block in found.blocks(engine, stage):
            rows = map(b",".join, zip(*_columns(block), strict=True))
            yield stage_cells + (END + stage_cells).join(rows) + END


def _columns(block: Block) -> Iterator[Iterable[bytes]]:
    """The cells of each column; a column at a time, because a row of Python objects takes four times as long."""
    yield to_json([*block.indices])[1:-1].split(b",")
    yield [_STATUS[code] for code in block.status.tolist()]
    yield [_text(block.reasons.get(i)) for i in block.indices] if block.reasons else repeat(b"", len(block.indices))
    yield cells(block.seconds)
    for costs in block.costs:
        written = cells(costs)
        for i in np.flatnonzero(~np.isfinite(costs)).tolist():
            written[i] = b""
        yield written
    yield from map(cells, block.values)
    if block.draws is not None:
        yield [b"" if draw is None else str(draw).encode() for draw in block.draws]


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
