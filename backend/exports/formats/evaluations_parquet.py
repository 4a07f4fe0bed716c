"""Every evaluation of a run as Parquet: the columns of evaluations.csv as numbers, with units in the schema.

Values that are missing are null.
"""

from __future__ import annotations

import io
import json
from functools import partial
from typing import TYPE_CHECKING, Any

import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.db.engine import read
from backend.exports.format import Format, missing, require, words
from backend.exports.sheet import Sheet, sheet
from backend.runs import service as runs

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
            place = [stage.position, stage.kind, stage.method]
            for block in found.rows(engine, stage):
                columns = zip(*(place + row for row in block), strict=True)
                arrays = [pa.array(values, kind.type) for values, kind in zip(columns, schema, strict=True)]
                writer.write_batch(pa.record_batch(arrays, schema=schema))
    return buffer.getvalue()


def _schema(found: Sheet) -> pa.Schema:
    import pyarrow as pa

    kinds: dict[str, Any] = {"index": pa.int64(), "status": pa.string(), "reason": pa.string()}
    fields = [pa.field("stage", pa.int32()), pa.field("kind", pa.string()), pa.field("method", pa.string())]
    units = ["", "", "", "s", *(unit for _, unit in [*found.criteria, *found.parameters])]
    for name, unit in zip(found.columns, units, strict=True):
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
