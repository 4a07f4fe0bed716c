"""Which values of a parametrised test are tested by day, and which only by `make nightly`."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def nightly_but(by_day: Collection[object], values: Iterable[Any]) -> list[Any]:
    """The values, of which those that are not `by_day` are tested nightly."""
    return [value if value in by_day else pytest.param(value, marks=pytest.mark.nightly) for value in values]


def rows_nightly_but(by_day: Collection[object], rows: Iterable[tuple[Any, ...]]) -> list[Any]:
    """The same for a test of several parameters: a row has a value of each."""
    return [row if row in by_day else pytest.param(*row, marks=pytest.mark.nightly) for row in rows]
