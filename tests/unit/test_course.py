"""The small picture of the best so far: every fall while there are few, an even choice of many."""

from __future__ import annotations

import numpy as np
import pytest

from backend.db.course import MOST, extended


def test_it_begins_with_the_first_cost_and_falls() -> None:
    costs = np.array([np.nan, 3.0, 3.5, 2.0, np.nan, 2.0, 1.0])
    assert extended([], 10, costs) == [[12, 3.0], [14, 2.0], [17, 1.0]]


def test_it_goes_on_where_it_was() -> None:
    assert extended([[2, 3.0]], 5, np.array([4.0, 2.5])) == [[2, 3.0], [7, 2.5]]
    assert extended([[2, 3.0]], 5, np.array([4.0, 3.0, np.nan])) is None
    assert extended([], 0, np.array([np.nan])) is None


@pytest.mark.parametrize("chunk", [1, 7, 1000])
def test_many_falls_are_thinned_but_ends_are_kept(chunk: int) -> None:
    costs = 100.0 / np.arange(1.0, 1001.0)
    course: list[list[float]] = []
    for first in range(0, 1000, chunk):
        course = extended(course, first, costs[first : first + chunk]) or course
    assert len(course) <= MOST
    assert course[0] == [1, 100.0]
    assert course[-1] == [1000, 0.1]
    evaluations, lowest = zip(*course, strict=True)
    assert list(evaluations) == sorted(set(evaluations))
    assert list(lowest) == sorted(set(lowest), reverse=True)


def test_differences_beyond_its_digits_are_no_fall() -> None:
    assert extended([[1, 0.941740]], 1, np.array([0.9417398])) is None
