"""The nine members of every system; what some systems define besides, those of packages too, and its defaults."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.results.finding import ClosestApproach
from campaigns.results.validate import Beyond
from clearance.testing.problems import Problem as Loop
from tests.given.case_campaigns import campaign
from tests.simulators import package, rig, two_basins
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts import noise
from worker.engine.systems import optional
from worker.engine.systems.base import (
    Comparison,
    ComponentLoop,
    PolynomialLoop,
    Realised,
    Settings,
    Shown,
    Slotted,
    System,
    indices,
    slotted,
)
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.simulator import Simulator as Declared
from worker.running.catalogue.installed import catalogue
from worker.running.opening.opened import simulated
from worker.running.runs import pulse

OPENING = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")
VECTORS = np.array([[0.1, 0.2], [0.3, 0.4]])
SHOWN = Shown(ClosestApproach(), 3.0, None)  # type: ignore[arg-type]
BEYOND = Beyond(times=2, flights=1, closer=0, lowest=None, unknown=None)
MODEL = PolynomialLoop((), (), (), (), (), lambda points: points, lambda *_: np.array([True]))


class Whole:
    """All that a system may define besides, and which of it was called."""

    settings = Settings(lanes=4, step=0.5)
    realisations = Realised((3, 4), "mean", True)
    longest = 10.0
    calls: list[str]

    def compare(self, vectors: Any, seeds: Any, cancelled: Any = lambda: False) -> list[Comparison]:
        return [Comparison("again", "another day", float(vector[1])) for vector in vectors]

    def encounter(self, nominal: Any) -> Shown | None:
        return SHOWN

    def beyond(self, names: Any, vectors: Any, seeds: Any, below: float, cancelled: Any) -> Beyond | None:
        return BEYOND

    def about_trim(self) -> PolynomialLoop | None:
        return MODEL

    def warm(self) -> None:
        self.calls = ["warm"]

    def close(self) -> None:
        self.calls.append("close")


class WholeRig(Whole, rig.Rig):
    """Derives from `System` alone."""

    def __init__(self, opening: Opening) -> None:
        rig.Rig.__init__(self, opening)


class WholeBasins(Whole, two_basins.TwoBasins):
    """Derives from `Simulated`."""


def opened(make: Callable[[Opening], System]) -> Slotted:
    known = catalogue().model_copy(update={"simulators": [two_basins.ENTRY]})
    return simulated(load_document(package.campaign()), Declared(two_basins.ENTRY, make), known)


def basins(opening: Opening) -> System:
    return two_basins.TwoBasins(two_basins.ENTRY, opening)


def whole_basins(opening: Opening) -> System:
    return WholeBasins(two_basins.ENTRY, opening)


def nothing_beyond(system: System) -> Beyond | None:
    return optional.beyond(system, ["nominal"], VECTORS[:1], [None], 0.0, lambda: False)


def test_every_system_has_nine_members() -> None:
    members = {name for kind in System.__mro__ for name in inspect.get_annotations(kind)} | {*dir(System)}
    assert {name for name in members if not name.startswith("_")} == {
        "parameters",
        "nominal",
        "results",
        "repeatable",
        "cost",
        "digest",
        "evaluate",
        "confirm",
        "trace",
    }


@pytest.mark.parametrize("make", [WholeRig, whole_basins])
@pytest.mark.parametrize("by", [opened, lambda make: make(OPENING)])
def test_what_a_system_of_a_package_defines_is_used(make: Any, by: Any) -> None:
    system = by(make)
    problem = Problem(load_document(package.campaign()), system)
    assert optional.settings(system) == Whole.settings
    assert problem.realisations == optional.realisations(system) == Whole.realisations
    assert pulse.longest(system) == len(Whole.realisations.seeds) * Whole.longest
    assert optional.encounter(system, None) is SHOWN
    assert nothing_beyond(system) is BEYOND
    assert optional.about_trim(system) is MODEL
    assert [found.cost for found in optional.compare(system, VECTORS, [None, None])] == VECTORS[:, 1].tolist()
    evaluate = InProcess(problem, threads=2)
    assert evaluate.threads == 2
    evaluate.close()
    optional.warm(system)
    optional.close(system)
    assert system.calls == ["warm", "close"]


@pytest.mark.parametrize("make", [rig.Rig, basins])
@pytest.mark.parametrize("by", [opened, lambda make: make(OPENING)])
def test_what_it_does_not_define_has_a_default(make: Any, by: Any) -> None:
    system = by(make)
    assert (optional.settings(system), optional.realisations(system)) == (Settings(), Realised())
    assert optional.encounter(system, None) is None
    assert nothing_beyond(system) is None
    assert optional.about_trim(system) is None
    optional.warm(system)
    optional.close(system)


def test_the_closed_loop_implements_its_interface() -> None:
    system = Loop(campaign(), compiled=False).system
    assert isinstance(system, ComponentLoop)
    assert not isinstance(system, Slotted)
    assert optional.settings(system) is system.settings
    assert optional.realisations(system) is system.realisations
    assert optional.about_trim(system) is not None
    optional.close(system)


@pytest.mark.parametrize("of", [lambda: Loop(campaign(), compiled=False).system, lambda: opened(basins)])
def test_a_comparison_spends_no_other_evaluation(of: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    system = of()
    monkeypatch.setattr(system, "confirm", None)
    monkeypatch.setattr(system, "evaluate", None)
    assert len(optional.compare(system, system.nominal[None], [None])) == 1


def test_a_system_without_a_comparison_is_compared_by_the_last_means_that_confirms_it() -> None:
    system = rig.Rig(OPENING)
    assert [found.cost for found in optional.compare(system, VECTORS, [None, None])] == VECTORS[:, 0].tolist()
    assert optional.compare(system, VECTORS, [None, None], lambda: True) == []


def test_a_fresh_form_that_derives_from_the_interface_alone_is_closed_after_the_noise_is_measured() -> None:
    problem = Problem(load_document(package.campaign()), rig.Rig(OPENING))
    *_, through = noise.measuring(problem, np.zeros((2, 2)))
    assert type(through.system) is rig.Rig


def test_the_indices_of_parameters_are_those_that_a_system_of_a_package_reads_by_name() -> None:
    system = opened(rig.Rig)
    assert system.names == indices(system.parameters) == {"simulator.x": 0, "simulator.y": 1}
    assert system.evaluate(VECTORS)[0].costs[:, 0].tolist() == VECTORS[:, 0].tolist()
    assert slotted(system) is system
