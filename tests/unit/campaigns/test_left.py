"""What a stage has left: only a sample draws again what is excluded, and no more often than it may."""

from __future__ import annotations

import pytest

from campaigns.limits import DRAWS
from campaigns.stages.plan import left


@pytest.mark.parametrize("kind", ["search", "sensitivity", "estimate", "validate", "kind_of_another_version"])
def test_what_is_excluded_is_part_of_a_budget(kind: str) -> None:
    assert left(kind, 300, 100, 50) == 200
    assert left(kind, 300, 320, 50) == 0


@pytest.mark.parametrize(
    ("evaluations", "excluded", "expected"),
    [(0, 0, 300), (100, 0, 200), (100, 50, 500), (300, 150, 300), (400, 300, 200), (10, 10, 590), (600, 500, 0)],
)
def test_a_sample_is_not_done_before_it_has_all_that_are_not_excluded(
    evaluations: int, excluded: int, expected: int
) -> None:
    assert left("certify", 300, evaluations, excluded) == expected
    assert evaluations + left("certify", 300, evaluations, excluded) <= DRAWS * 300


def test_a_sample_has_something_left_until_it_is_whole() -> None:
    for kept in range(300):
        for excluded in range(300):
            assert left("certify", 300, kept + excluded, excluded) > 0
    assert left("certify", 300, 450, 150) == 0
