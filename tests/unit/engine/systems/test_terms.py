"""Simulators of packages written for one interface with all members: evaluated and described as they state."""

from __future__ import annotations

from dataclasses import replace

import pytest

from campaigns.asked.load import load_document
from campaigns.asked.spec import Simulator
from tests.simulators import package, two_basins
from tests.simulators.rig import BAR, Rig
from worker.engine.systems import base
from worker.engine.systems.base import Words
from worker.engine.systems.simulators.called import Called
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.simulator import Simulator as Declared
from worker.evidence.scopes.terms import terms
from worker.running.catalogue.installed import catalogue
from worker.running.opening.opened import simulated

OPENING = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")
TYRES = "The tyres were new."


class Extended(two_basins.TwoBasins):
    """States more than the usual, and has other words for it."""

    @property
    def words(self) -> Words:
        return replace(super().words, one="drive")  # type: ignore[misc]

    @property
    def caveat(self) -> str:
        return f"{super().caveat} {TYRES}"  # type: ignore[misc]


def test_a_package_extends_the_usual_terms() -> None:
    usual = terms(two_basins.TwoBasins(two_basins.ENTRY, OPENING))
    own = Extended(two_basins.ENTRY, OPENING)
    for _ in range(2):
        assert terms(own) == replace(usual, words=replace(usual.words, one="drive"), caveat=f"{usual.caveat} {TYRES}")
    assert terms(Called(own, Simulator(name="two_basins", retries=1))) == terms(own)


@pytest.mark.parametrize("retries", [0, 1])
def test_a_system_of_its_own_keeps_its_slots_and_its_terms(retries: int) -> None:
    campaign = load_document(package.campaign(simulator={"name": "two_basins", "retries": retries}))
    known = catalogue().model_copy(update={"simulators": [two_basins.ENTRY]})
    system = simulated(campaign, Declared(two_basins.ENTRY, Rig), known)
    assert (base.slots(system), base.slotted(system.fresh()).slots) == (2, 2)
    assert terms(system.fresh()) == terms(system)
    assert system.submit(system.nominal).result().costs.tolist() == [0.5]
    found = terms(system)
    assert (found.scope, found.words, found.caveat, found.bars) == (Rig.scope, Rig.words, "", (BAR,))
