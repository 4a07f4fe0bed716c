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


def others(items: Iterable[pytest.Item]) -> list[pytest.Item]:
    """What is tested nightly because of `pytest.mark.by_day(count)`: all values of such a test but `count` of those
    that are not nightly already, from the first one to the last one at equal distances."""
    tests: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("by_day") and not item.get_closest_marker("nightly"):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    return [item for values in tests.values() for item in _left(values)]


def _left(values: list[pytest.Item]) -> list[pytest.Item]:
    mark = values[0].get_closest_marker("by_day")
    assert mark is not None
    (count,) = mark.args
    chosen = {round(k * (len(values) - 1) / max(count - 1, 1)) for k in range(count)}
    return [item for place, item in enumerate(values) if place not in chosen]
