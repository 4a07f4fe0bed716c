"""Values of a test that are tested by day: as many as its mark states, spread over those that are not nightly."""

from __future__ import annotations

from typing import Any

import pytest

from tests.given.at_night import others


class Item:
    """What a collected test has of what is read of it."""

    def __init__(self, nodeid: str, *marks: Any) -> None:
        self.nodeid = nodeid
        self.marks = {mark.name: mark for mark in marks}

    def get_closest_marker(self, name: str) -> Any:
        return self.marks.get(name)


def values(count: int, *marks: Any) -> list[Any]:
    return [Item(f"tests/test_it.py::test_it[{k}]", *marks) for k in range(count)]


@pytest.mark.parametrize(
    ("count", "of", "by_day"),
    [(1, 5, {0}), (2, 5, {0, 4}), (3, 5, {0, 2, 4}), (5, 5, {0, 1, 2, 3, 4}), (9, 5, {0, 1, 2, 3, 4}), (3, 1, {0})],
)
def test_as_many_as_stated_are_spread_over_all(count: int, of: int, by_day: set[int]) -> None:
    made = values(of, pytest.mark.by_day(count).mark)
    left = others(made)
    assert [k for k, item in enumerate(made) if item not in left] == sorted(by_day)


def test_what_is_nightly_already_is_not_counted() -> None:
    made = values(4, pytest.mark.by_day(2).mark)
    made[0].marks["nightly"] = made[3].marks["nightly"] = pytest.mark.nightly.mark
    made[1:1] = values(1, pytest.mark.by_day(2).mark)
    assert [made.index(item) for item in others(made)] == [2]


def test_tests_without_the_mark_and_tests_of_one_value_stay() -> None:
    assert others(values(3)) == []
    assert others([Item("tests/test_it.py::test_alone", pytest.mark.by_day(1).mark)]) == []  # type: ignore[list-item]
