"""Both modes of a toy are findings of a search with nothing chosen, whatever their widths and the seed."""

from __future__ import annotations

import pytest

from tests.given.two_modes import WIDTHS, TwoModes

SEEDS = range(30)
DAY = {("equal", 0), ("unequal", 1)}
"""Of 2 and of 3 parameters."""
CASES = [
    pytest.param(widths, seed, marks=[] if (widths, seed) in DAY else [pytest.mark.nightly])
    for widths in WIDTHS
    for seed in SEEDS
]


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("widths", "seed"), CASES)
def test_both_modes_are_findings(widths: str, seed: int) -> None:
    found, result = TwoModes.drawn(2 + seed % 4, widths, seed).found(seed)
    assert found == [True, True]
    assert len(result.findings) == 2, "no mode is listed twice"
    assert str(result.verdict) == "violated"
