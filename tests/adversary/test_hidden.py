"""What no search has found is not cleared: without a sample, with a seed that was chosen, or by methods that disagree.

Each kind also asserts that its attacks would succeed but for the rule: all other checks hold in most of them.
"""

from __future__ import annotations

import numpy as np
import pytest

import clearance
from tests.adversary import hidden

COUNTS = [3, pytest.param(40, marks=[pytest.mark.nightly, pytest.mark.timeout(1200)])]
"""Campaigns by day and by night."""


def generators(kind: int, count: int) -> list[np.random.Generator]:
    return [np.random.default_rng([20_261_124, kind, seed]) for seed in range(count)]


def left_by(result: clearance.Result) -> set[str]:
    """The titles of the checks that do not hold."""
    return {check.title for check in result.verdict.checks if check.standing != "holds"}


@pytest.mark.nightly
@pytest.mark.parametrize("count", COUNTS)
def test_without_an_independent_sample_nothing_is_cleared(count: int) -> None:
    barred = []
    for random in generators(3, count):
        result = hidden.hidden_box(random, 0, (0.02, 0.08)).search()
        assert result.verdict != "cleared", result.verdict.sentence
        barred.append(left_by(result))
    assert sum(len(titles) == 1 for titles in barred) >= count / 2, barred


@pytest.mark.parametrize("count", COUNTS)
def test_a_drawn_sample_finds_what_the_searches_missed(count: int) -> None:
    for random in generators(13, count):
        given = hidden.hidden_box(random, 300, (0.04, 0.08))
        result = given.search()
        assert result.verdict == "violated", (given.fraction, result.verdict.sentence)


@pytest.mark.nightly
@pytest.mark.parametrize("count", COUNTS)
def test_with_a_seed_that_was_chosen_nothing_is_cleared(count: int) -> None:
    barred = []
    for random in generators(6, count):
        given = hidden.hidden_box(random, 59, (0.01, 0.04))
        seed = hidden.lucky_seed(given)
        assert seed is not None
        result = given.search(sample_seed=seed)
        assert result.verdict != "cleared", result.verdict.sentence
        barred.append(left_by(result))
    assert sum(len(titles) == 1 for titles in barred) >= count / 4, barred  # findings meet half of the boxes


@pytest.mark.nightly
@pytest.mark.parametrize("count", COUNTS)
def test_methods_that_stop_further_apart_than_the_margin_do_not_agree(count: int) -> None:
    barred = []
    for random in generators(4, count):
        given = hidden.needle(random)
        result = given.search()
        assert result.verdict != "cleared", result.verdict.sentence
        barred.append(left_by(result))
    assert sum(len(titles) == 1 for titles in barred) >= count / 2, barred
