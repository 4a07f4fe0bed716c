"""The stored flights as a MAT-file of version 5, one structure each."""

from __future__ import annotations

import io
import re
from typing import Any

import sqlalchemy as sa

from backend.exports.format import Format, whole, words
from backend.http.written import compact
from backend.results import service as results
from backend.runs import service as runs


def traces_mat(reader: sa.Connection, run_id: int) -> bytes:
    """The flights as structures of columns (`nominal.x`, `F1.separation`), with `run`, `units` and `meta`."""
    from scipy.io import savemat  # imported here because it takes a third of a second

    detail = runs.summary(reader, run_id)
    saved: dict[str, object] = {
        "run": {"id": detail.id, "name": detail.name, "campaign_digest": detail.campaign_digest}
    }
    for flight in results.traces(reader, run_id):
        row = results.stored(reader, run_id, flight.name)
        data = results.table(row)
        fields: dict[str, object] = {_field(c["name"]): data[:, [k]] for k, c in enumerate(row.columns)}
        fields["units"] = {_field(c["name"]): c["unit"] for c in row.columns}
        fields["meta"] = compact(row.meta)
        saved[_field(flight.name)] = fields
    buffer: Any = io.BytesIO()  # SciPy's type stubs allow only file names
    savemat(buffer, saved, long_field_names=True, do_compression=True)
    return bytes(buffer.getvalue())


def _field(name: str) -> str:
    """A valid MATLAB name: obstacle.0.x becomes obstacle_0_x."""
    clean = re.sub(r"\W", "_", name, flags=re.ASCII)[:63]
    return clean if clean[:1].isalpha() else f"c_{clean}"[:63]


export = Format(
    file="traces.mat",
    order=6,
    media_type="application/x-matlab-data",
    words=words(
        "Flights, MAT-file",
        "Flights for MATLAB, Octave and SciPy (version 5)",
        ("Traces, MAT-file", "Traces for MATLAB, Octave and SciPy (version 5)"),
    ),
    made=lambda engine, run_id: whole(engine, run_id, traces_mat),
    needs="flights",
)
