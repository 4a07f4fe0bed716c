"""No adversarial campaign is cleared; one of most kinds by day.

All classes many times over: `make nightly`.
"""

from __future__ import annotations

import pytest

from tests.adversary.attack import CLASSES, attack, made
from tests.given.at_night import nightly_but

EACH = 20
"""Attacks of every class by night: more than 300 in all."""

NAMES = [kind.__name__ for kind in CLASSES]
BY_DAY = {
    "horizon_too_short",
    "never_moves",
    "collision",
    "one_realisation",
    "mass_outside",
    "through_a_wall",
    "near_the_worst",
    "coarse_step",
    "mild_violation",
}
"""One of each kind that no other test by day has. The others have by day: whole runs with what comes after the horizon
or between steps in tests/adversary/test_intentions.py, with what no search has met in tests/adversary/test_hidden.py,
with much that is excluded in tests/faults/test_functions.py; evidence of few evaluations, of one family, without
influence or avoidance in tests/unit/evidence/verdicts. `out_of_reach` is as `never_moves`, `tails` as `mass_outside`,
`mean_of_realisations` as `one_realisation`, `side_switch` as `mild_violation`."""


@pytest.mark.by_day(4)
@pytest.mark.timeout(600)
@pytest.mark.parametrize("kind", nightly_but(BY_DAY, NAMES))
def test_one_of_every_class(kind: str) -> None:
    outcome = attack(made(NAMES.index(kind), 0))
    assert not outcome.wrong, f"{outcome.wrong}: {outcome.sentence}"


@pytest.mark.nightly
@pytest.mark.timeout(600)
@pytest.mark.parametrize("seed", range(1, EACH + 1))
@pytest.mark.parametrize("kind", range(len(CLASSES)), ids=NAMES)
def test_many_of_every_class(kind: int, seed: int) -> None:
    outcome = attack(made(kind, seed))
    assert not outcome.wrong, f"{outcome.wrong}: {outcome.sentence}"
