"""Evaluations of several criteria: stored with every bit, the first one counts, exported in their own sign."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from backend.db.records import Columns
from backend.db.store import as_columns, blobs, lowest
from backend.exports.sheet import Sheet, _criteria, _turned
from backend.results.improvements import Improvements
from tests.unit.cases import campaign
from worker.catalog import catalogue

COLUMNS = Columns(
    np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]]),
    np.array([[0.9, -3.0, -0.1 - 0.2], [0.8, 0.0, -9.0], [np.nan, np.nan, np.nan]]),
    np.array([0, 0, 1], dtype=np.uint8),
    np.array([0.1, 0.2, 0.3]),
    {2: "it failed"},
)


def row() -> Any:
    """The columns as a row of the table of chunks."""
    return SimpleNamespace(first=0, count=3, **blobs(COLUMNS))


def test_every_column_is_stored_and_found_again() -> None:
    found = as_columns(row())
    assert found.costs.shape == (3, 3)
    assert found.costs.tobytes() == COLUMNS.costs.tobytes()
    assert found.points.tobytes() == COLUMNS.points.tobytes()


def test_the_best_is_that_of_the_criterion_that_decides() -> None:
    assert lowest(COLUMNS) == (0.8, 1)
    improvements = Improvements()
    improvements._add(row())
    assert (improvements.index, improvements.cost) == ([0, 1], [0.9, 0.8])


def test_an_export_has_all_of_them_in_their_own_sign() -> None:
    document = campaign().document()
    document["objectives"] = [{"component": "goal_miss"}, {"component": "peak_command"}]
    asked = type(campaign()).model_validate(document)
    named = _criteria(asked, catalogue(), 3)
    turned = [_turned(name, catalogue()) for name in ("separation", "goal_miss", "peak_command")]
    assert turned == [False, True, True]
    sheet = Sheet(1, [], named, turned, [("vehicle.m", "kg")], {"vehicle.m": (5.0, 4.0, 6.0)})
    assert sheet.columns[4:7] == ["d_min [m]", "d_goal [m]", "u_peak"]
    rows = sheet._block(row())
    assert [r[4:] for r in rows] == [[0.9, 3.0, 0.1 + 0.2, 4.0], [0.8, 0.0, 9.0, 5.0], [None, None, None, 6.0]]
    assert str(rows[1][5]) == "0.0"
