"""The stored flights as a MAT-file of version 5, one structure each."""

from __future__ import annotations

import io
import re
from collections.abc import Collection, Sequence
from itertools import count
from typing import Any

import sqlalchemy as sa

from backend.exports.format import Format, whole, words
from backend.http.written import compact
from backend.results import service as results
from backend.runs import service as runs

OWN = ("units", "meta")
"""Fields of a flight that are no columns."""
LONGEST = 63
"""Maximum length of a name in MATLAB [characters]."""


def traces_mat(reader: sa.Connection, run_id: int) -> bytes:
    """The flights as structures of columns (`nominal.x`, `F1.separation`), with `run`, `units` and `meta`.

    `meta` is the stored JSON with `names`, which has the name of every column by its field.
    """
    from scipy.io import savemat  # imported here because it takes a third of a second

    detail = runs.summary(reader, run_id)
    saved: dict[str, object] = {
        "run": {"id": detail.id, "name": detail.name, "campaign_digest": detail.campaign_digest}
    }
    flights = [flight.name for flight in results.traces(reader, run_id)]
    for flight, structure in zip(flights, _fields(flights, saved), strict=True):
        row = results.stored(reader, run_id, flight)
        data, names = results.table(row), [c["name"] for c in row.columns]
        own = _fields(names, OWN)
        fields: dict[str, object] = {field: data[:, [k]] for k, field in enumerate(own)}
        fields["units"] = {field: c["unit"] for field, c in zip(own, row.columns, strict=True)}
        fields["meta"] = compact(row.meta | {"names": dict(zip(own, names, strict=True))})
        saved[structure] = fields
    buffer: Any = io.BytesIO()  # SciPy's type stubs allow only file names
    savemat(buffer, saved, long_field_names=True, do_compression=True)
    return bytes(buffer.getvalue())


def _fields(names: Sequence[str], reserved: Collection[str]) -> list[str]:
    """A field for each name, all different and none of the reserved ones: those that clash end in _2, _3.

    A name that can be a field as it stands is one.
    """
    fields, taken = [""] * len(names), set(reserved)
    for k in sorted(range(len(names)), key=lambda k: names[k] in reserved or _field(names[k]) != names[k]):
        field = clean = _field(names[k])
        for number in count(2):
            if field not in taken:
                break
            field = f"{clean[: LONGEST - len(f'_{number}')]}_{number}"
        fields[k] = field
        taken.add(field)
    return fields


def _field(name: str) -> str:
    """A valid MATLAB name: obstacle.0.x becomes obstacle_0_x."""
    clean = re.sub(r"\W", "_", name, flags=re.ASCII)[:LONGEST]
    return clean if clean[:1].isalpha() else f"c_{clean}"[:LONGEST]


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
