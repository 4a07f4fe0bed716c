"""What a descent evaluates: slopes apart from points, and its end when steps no longer pay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from clearance.testing.searching import Function, batch
from worker.engine.search.base import Floats
from worker.engine.search.parts.descent import End, Settings, descend

PLAIN = Settings(differences="forward", iterations=60)
START = np.array([0.9, 0.1, 0.8, 0.2, 0.7])


def curved(x: Floats) -> Floats:
    """Its first steps overshoot, so that line searches go back."""
    return np.asarray((np.arange(1, 6) ** 3 * (x - 0.45) ** 2).sum(axis=1) + ((x - 0.3) ** 4).sum(axis=1))


def descent(function: Function, settings: Settings) -> tuple[End, int]:
    """The end, and the number of distinct points evaluated."""
    seen: set[bytes] = set()
    search = descend(START, settings)
    try:
        asked = next(search)
        while True:
            seen.update(p.tobytes() for p in asked)
            asked = search.send(batch(function(asked)))
    except StopIteration as end:
        return end.value, len(seen)


def test_no_slope_is_evaluated_where_a_line_search_goes_back() -> None:
    (plain, many), (apart, few) = (descent(curved, replace(PLAIN, apart=a)) for a in (False, True))
    assert apart.cost == pytest.approx(plain.cost, rel=1e-6)
    assert few < 0.8 * many
    assert apart.evaluations == few


def test_a_descent_ends_when_two_steps_together_gain_too_little() -> None:
    (all_of_it, many), (some, few) = (descent(curved, replace(PLAIN, apart=True, gain=g)) for g in (0.0, 0.1))
    assert few < many
    assert 0.0 <= some.cost - all_of_it.cost < 0.2
