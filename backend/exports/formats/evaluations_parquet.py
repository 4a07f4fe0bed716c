"""Every evaluation of a run as Parquet: the columns of evaluations.csv as numbers, with units in the schema.

Values that are missing are null.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.db.digest import results_digest
from backend.db.engine import read
from backend.exports.format import Format, missing, require, words
from backend.exports.sheet import Block, Evaluated, Sheet, sheet
from backend.runs import service as runs
from campaigns.results.base import STATUS

if TYPE_CHECKING:
    import pyarrow as pa

MISSING = partial(missing, "pyarrow", "parquet")

FORMAT = "clearance-evaluations/1"


def evaluations_parquet(engine: sa.Engine, run_id: int) -> bytes:
    """One row for each evaluation of every stage, a row group for each block. Raises 503 without the package."""
    require(MISSING)
    import pyarrow as pa
    import pyarrow.parquet as pq

    with read(engine) as reader:
        run, digest = runs.summary(reader, run_id), results_digest(reader, run_id)
        found = sheet(reader, run_id, runs.campaign(reader, run_id))
    origin = {"format": FORMAT, "run": run.id, "campaign_digest": run.campaign_digest, "results_digest": digest}
    schema = _schema(found).with_metadata({"clearance": json.dumps(origin)})
    buffer = io.BytesIO()
    with pq.ParquetWriter(buffer, schema, compression="zstd") as writer:
        for stage in found.stages:
            for block in found.blocks(engine, stage):
                columns = zip(_columns(stage, block), schema, strict=True)
                arrays = [pa.array(values, kind.type, mask=_missing(values)) for values, kind in columns]
                writer.write_batch(pa.record_batch(arrays, schema=schema))
    return buffer.getvalue()


def _columns(stage: Evaluated, block: Block) -> Iterator[Any]:
    count = len(block.indices)
    for value in (stage.position, stage.kind, stage.method):
        yield [value] * count
    yield np.arange(block.indices.start, block.indices.stop)
    yield [STATUS[code] for code in block.status.tolist()]
    yield [block.reasons.get(index) for index in block.indices] if block.reasons else [None] * count
    yield block.seconds
    yield from block.costs
    yield from block.values
    if block.draws is not None:
        yield block.draws


def _missing(values: Any) -> NDArray[np.bool_] | None:
    return ~np.isfinite(values) if isinstance(values, np.ndarray) and values.dtype == np.float64 else None


def _schema(found: Sheet) -> pa.Schema:
    import pyarrow as pa

    kinds: dict[str, Any] = {"index": pa.int64(), "draw": pa.int64(), "status": pa.string(), "reason": pa.string()}
    fields = [pa.field("stage", pa.int32()), pa.field("kind", pa.string()), pa.field("method", pa.string())]
    units = ["", "", "", "s", *(unit for _, unit in [*found.criteria, *found.parameters]), ""]
    for name, unit in zip(found.columns, units, strict=False):
        meta = {"unit": unit} if unit else None
        fields.append(pa.field(name, kinds.get(name, pa.float64()), metadata=meta))
    return pa.schema(fields)


export = Format(
    file="evaluations.parquet",
    order=3,
    media_type="application/vnd.apache.parquet",
    words=words("Evaluations, Parquet", "The same as numbers with units, for pandas, Polars and DuckDB"),
    made=lambda engine, run_id: evaluations_parquet(engine, run_id),
    missing=MISSING,
)
