"""How much a run stores: counted in the transaction that writes it, so that a quota reads one column.

Its campaign (stored once for all runs of it, and counted for each), evaluations with their reasons, traces, original
text. Results of stages and findings are small and not counted.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import sqlalchemy as sa

from backend.db.tables import Run, Trace


def of_document(document: Any) -> int:
    """JSON as it is stored [bytes]."""
    return len(json.dumps(document))


def of_chunk(chunk: Mapping[str, Any]) -> int:
    """A row of the chunk table: its columns and the text of its reasons [bytes]."""
    return sum(len(value) for value in chunk.values() if isinstance(value, bytes)) + of_document(chunk["reasons"])


def grow(writer: sa.Connection, run_id: int, more: int) -> None:
    """Add to what a run stores [bytes]."""
    writer.execute(sa.update(Run).where(Run.id == run_id).values(size=Run.size + more))


def replace_traces(writer: sa.Connection, run_id: int, names: Sequence[str], data: Iterable[bytes]) -> None:
    """Count the traces that are about to replace those of the same names."""
    mine = (Trace.run_id == run_id, Trace.name.in_(names))
    before = writer.scalar(sa.select(sa.func.sum(sa.func.length(Trace.data))).where(*mine)) or 0
    grow(writer, run_id, sum(map(len, data)) - int(before))
