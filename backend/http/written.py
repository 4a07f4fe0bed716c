"""Numbers and rows as text: at full precision (`repr`), so that they read back bit-identical. CSV: RFC 4180."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

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


def headed(name: str, unit: str) -> str:
    """The header of a column."""
    return f"{name} [{unit}]" if unit else name


def compact(value: Any) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
