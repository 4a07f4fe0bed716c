"""Numbers and rows as text: at full precision (`repr`), so that they read back bit-identical. CSV: RFC 4180."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from campaigns.cells import Writer


def lines(rows: Iterable[Iterable[object]]) -> bytes:
    text = io.StringIO()
    Writer(text).writerows(rows)
    return text.getvalue().encode()


def finite(value: float | None) -> float | None:
    return value if value is not None and abs(value) != float("inf") and value == value else None


def finite_all(values: NDArray[np.float64]) -> list[float | None]:
    """The values (m,); None for those that are not finite."""
    return list(map(finite, values.tolist()))


def cells(values: NDArray[np.float64]) -> list[bytes]:
    """The `repr` of each value (m,), in a quarter of its time: the JSON of pydantic has the same digits, but writes
    small numbers in other forms."""
    found = to_json(values.tolist(), inf_nan_mode="constants")[1:-1].split(b",") if len(values) else []
    size = np.abs(values)
    for i in np.flatnonzero(~((size == 0.0) | (size >= 1e-4) & (size < 1e16))).tolist():
        found[i] = repr(float(values[i])).encode()
    return found


def headed(name: str, unit: str) -> str:
    """The header of a column."""
    return f"{name} [{unit}]" if unit else name


def compact(value: Any) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
