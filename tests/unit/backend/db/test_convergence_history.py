"""The stored convergence history: all improvements while there are few, evenly thinned if there are many."""

from __future__ import annotations

import numpy as np
import pytest

from backend.db.convergence import MOST, extended


def test_history_starts_with_the_first_cost_and_decreases() -> None:
    costs = np.array([np.nan, 3.0, 3.5, 2.0, np.nan, 2.0, 1.0])
    assert extended([], 10, costs) == [[12, 3.0], [14, 2.0], [17, 1.0]]


def test_history_is_extended() -> None:
    assert extended([[2, 3.0]], 5, np.array([4.0, 2.5])) == [[2, 3.0], [7, 2.5]]
    assert extended([[2, 3.0]], 5, np.array([4.0, 3.0, np.nan])) is None
    assert extended([], 0, np.array([np.nan])) is None


@pytest.mark.parametrize("chunk", [1, 7, 1000])
def test_many_improvements_are_thinned_and_both_ends_are_retained(chunk: int) -> None:
    costs = 100.0 / np.arange(1.0, 1001.0)
    history: list[list[float]] = []
    for first in range(0, 1000, chunk):
        history = extended(history, first, costs[first : first + chunk]) or history
    assert len(history) <= MOST
    assert history[0] == [1, 100.0]
    assert history[-1] == [1000, 0.1]
    evaluations, lowest = zip(*history, strict=True)
    assert list(evaluations) == sorted(set(evaluations))
    assert list(lowest) == sorted(set(lowest), reverse=True)


def test_differences_beyond_its_digits_are_not_improvements() -> None:
    assert extended([[1, 0.941740]], 1, np.array([0.9417398])) is None
