"""No adversarial campaign is cleared; one of almost every class by day.

All classes many times over: `make nightly`.
"""

from __future__ import annotations

import pytest

from tests.adversary.attack import CLASSES, attack, made
from tests.given.at_night import nightly_but

EACH = 20
"""Attacks of every class by night: more than 300 in all."""

NAMES = [kind.__name__ for kind in CLASSES]
LONG = {
    "side_switch",  # by day mild_violation
    "mean_of_realisations",  # one_realisation
    "turning_after_the_horizon",  # straight_after_the_horizon
    "aliased_on_the_path",  # aliased
    "there_and_back",  # aliased
}
"""Classes whose attacks take long; by day one of the same kind is run."""
BY_DAY = [kind for kind, name in enumerate(NAMES) if name not in LONG]


@pytest.mark.parametrize("kind", nightly_but(BY_DAY, range(len(NAMES))), ids=NAMES)
def test_one_of_every_class(kind: int) -> None:
    outcome = attack(made(kind, 0))
    assert not outcome.wrong, f"{outcome.wrong}: {outcome.sentence}"


@pytest.mark.nightly
@pytest.mark.timeout(600)
@pytest.mark.parametrize("seed", range(1, EACH + 1))
@pytest.mark.parametrize("kind", range(len(CLASSES)), ids=NAMES)
def test_many_of_every_class(kind: int, seed: int) -> None:
    outcome = attack(made(kind, seed))
    assert not outcome.wrong, f"{outcome.wrong}: {outcome.sentence}"
