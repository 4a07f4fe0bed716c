"""What a case is stated to have, and what was seen of it, by whatever means."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns.claims import say
from campaigns.claims.numbers import MINUS, NARROW, digits_between, interval, plain
from campaigns.claims.spans import words
from campaigns.results.finding import Calls, HalfStep, ReferenceCost, Repeated, Validation, granted

THRESHOLD = 0.5


def case(cost: float, calls: list[float | None] | None = None, **others: Any) -> Validation:
    repeats = None
    if calls is not None:
        low = sum(value is not None and value <= THRESHOLD for value in calls)
        failed = calls.count(None)
        repeats = Calls(values=calls, violating=low, failed=failed, confidence=0.95, low=0.0, high=1.0, statement=())
    values = [cost, *(other.cost for other in others.values())]
    violates = bool(repeats.violating) if repeats else all(value <= THRESHOLD for value in values)
    return Validation(
        name="F1",
        step=0.01,
        cost=cost,
        allowed=0.01,
        ok=True,
        agrees=False,
        violates=violates,
        repeats=repeats,
        **others,
    )


HALF = HalfStep(step=0.005, cost=0.4, difference=None)
OTHER = ReferenceCost(name="DOP853", cost=0.45, difference=None)
AGAIN = Repeated(name="a fresh evaluation", cost=0.3, difference=None)
CASES: Mapping[str, tuple[Validation, float, float]] = {
    "integrations": (case(0.2, half_step=HALF, integrator=OTHER), 0.45, 0.2),
    "a repetition": (case(0.2, again=AGAIN), 0.3, 0.2),
    "a violation in one call alone": (case(0.6, [0.6, None, 0.1, 0.7]), 0.1, 0.1),
    "calls of which some violate": (case(0.6, [0.3, 0.6, 0.1]), 0.3, 0.1),
    "an evaluation that is lower than its calls": (case(0.2, [0.3, 0.6, 0.4]), 0.4, 0.2),
    "no violation": (case(0.6, half_step=HALF), 0.6, 0.4),
    "calls of which none violates": (case(0.4, [0.6, 0.7]), 0.4, 0.4),
}
"""The value to state and the lowest that was seen."""


@pytest.mark.parametrize("name", CASES)
def test_a_violation_is_stated_with_a_value_that_violates_and_that_all_grant(name: str) -> None:
    validation, stated, lowest = CASES[name]
    assert validation.cost is not None
    value = granted(validation.cost, validation)
    assert (value, min(validation.values)) == (stated, lowest)
    assert not validation.violates or value <= THRESHOLD


@pytest.mark.parametrize(
    ("low", "high", "digits"),
    [
        (100_000.4, 100_000.6, 7), (4.999_999_6, 5.000_000_4, 8), (0.8 * 5, 1.2 * 5, 6), (1.2 * 0.9, 3.0, 6),
        (448_003.6, 448_004.4, 7), (-1e-10, 1e-10, 6), (1.0, 1.0, 6), (1e17, 1e17 + 6400, 16),
        (0.0, 2.999_999_999, 10), (0.0, 1 - 1e-12, 12), (-1 + 1e-13, 1.0, 13), (0.0, 2.99996, 6), (1e-13, 1.0, 6),
        (math.radians(10), math.radians(20), 15),
    ],
)  # fmt: skip
def test_bounds_are_written_with_the_digits_that_they_need(low: float, high: float, digits: int) -> None:
    assert digits_between(low, high) == digits
    apart = max(1e-9 * (high - low), 1e-15 * abs(high))
    assert all(abs(float(f"{value:.{digits}g}") - value) <= apart for value in (low, high))


@settings(max_examples=500)
@given(
    st.floats(-1e6, 1e6), st.sampled_from([0.0, 1e-15, 1e-13, 1e-9, 1e-6, 0.1]), st.integers(0, 9), st.floats(1e-9, 1e3)
)
def test_no_bounds_are_written_wider_than_they_are(end: float, off: float, decimals: int, length: float) -> None:
    """Bounds just inside or outside of a short number, in each function that writes them."""
    short = round(end, decimals)
    for low, high in ((short - length, short - off), (short + off, short + length)):
        bits = 4 * math.ulp(max(abs(low), abs(high)))
        digits = digits_between(low, high)
        texts = [interval(low, high), words(say.interval(low, high)), f"{plain(low, digits)} to {plain(high, digits)}"]
        for text in texts:
            first, last = (float(t.replace(MINUS, "-").replace(NARROW, "")) for t in text.split(" to "))
            assert first >= low - bits
            assert last <= high + bits
