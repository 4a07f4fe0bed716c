"""Simulators of packages written for one interface with all members: evaluated and described as they state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import replace

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.asked.spec import Simulator
from campaigns.claims.say import say
from campaigns.claims.spans import Spans
from campaigns.results.base import OK
from tests.simulators import package, two_basins
from worker.engine.search.base import Batch
from worker.engine.systems import base
from worker.engine.systems.base import (
    Comparison,
    Confirmed,
    Evaluated,
    Floats,
    Parameter,
    Reasons,
    Result,
    Scope,
    Seeds,
    System,
    Words,
)
from worker.engine.systems.simulators.called import Called
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.simulator import Simulator as Declared
from worker.evidence.scopes.terms import terms
from worker.running.catalogue.installed import catalogue
from worker.running.opening.opened import simulated

OPENING = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")
BAR = ("rig", say("the rig was not calibrated"))


TYRES = "The tyres were new."


class Extended(two_basins.TwoBasins):
    """States more than the usual, and has other words for it."""

    @property
    def words(self) -> Words:
        return replace(super().words, one="drive")  # type: ignore[misc]

    @property
    def caveat(self) -> str:
        return f"{super().caveat} {TYRES}"  # type: ignore[misc]


class Rig(System):
    """Derives from the interface alone, and has slots."""

    results = (Result("separation", "Separation", "d_sep", "m", "low"),)
    digest = "d" * 64  # type: ignore[assignment]
    scope = Scope(say("a rig"), (), "rig 7")
    words = Words("drive", "the rig agrees", "the rig disagrees", "all drives", "driven again", "the rig")
    slots = 2

    def __init__(self, opening: Opening) -> None:
        self.opening = opening
        entries = two_basins.ENTRY.parameters
        nominal = [opening.nominal[f"simulator.{p.name}"] for p in entries]
        self.parameters = tuple(
            Parameter(f"simulator.{p.name}", p.unit, at, p.low, p.high, p.text)
            for p, at in zip(entries, nominal, strict=True)
        )
        self.nominal = np.array(nominal)

    def fresh(self) -> System:
        return type(self)(self.opening)

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        return Batch(vectors[:, self.names["simulator.x"], None], np.full(len(vectors), OK, dtype=np.uint8)), {}

    def submit(self, vector: Floats, seed: int | None = None) -> Future[Evaluated]:
        ended: Future[Evaluated] = Future()
        ended.set_result(Evaluated(vector[:1], OK, ""))
        return ended

    def confirm(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Confirmed]:
        return [Confirmed(float(v[0]), ()) for v in vectors]

    def compare(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Comparison]:
        return [Comparison("again", "another drive", float(v[0])) for v in vectors]

    def bars(self) -> list[tuple[str, Spans]]:
        return [BAR]


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
