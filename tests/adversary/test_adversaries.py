"""No adversarial campaign is cleared; a few of every class.

All classes many times over: `make nightly`.
"""

from __future__ import annotations

import pytest

from tests.adversary.attack import CLASSES, attack, made

EACH = 20
"""Attacks of every class by night: more than 300 in all."""


@pytest.mark.parametrize("kind", range(len(CLASSES)), ids=lambda kind: CLASSES[kind].__name__)
def test_one_of_every_class(kind: int) -> None:
    outcome = attack(made(kind, 0))
    assert not outcome.wrong, f"{outcome.wrong}: {outcome.sentence}"


@pytest.mark.nightly
@pytest.mark.timeout(600)
@pytest.mark.parametrize("seed", range(1, EACH + 1))
@pytest.mark.parametrize("kind", range(len(CLASSES)), ids=lambda kind: CLASSES[kind].__name__)
def test_many_of_every_class(kind: int, seed: int) -> None:
    outcome = attack(made(kind, seed))
    assert not outcome.wrong, f"{outcome.wrong}: {outcome.sentence}"
