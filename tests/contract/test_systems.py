"""The contract of all systems, on the closed loop, a simulator and functions; and campaigns of a simulator."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Any

import numpy as np
import pytest

from campaigns import Catalogue, check, library, load_file
from campaigns.asked.load import CampaignError, load_document
from campaigns.asked.spec import Repeats, Simulator
from campaigns.checked import expected
from campaigns.checked.snapshot import changes, snapshot
from campaigns.results.base import EXCLUDED, FAILED, FLAKY, OK, TIMEOUT
from clearance.testing import SystemContract
from tests.simulators import functions, isolated, package, tracing, two_basins
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.systems.base import Evaluated, Slotted
from worker.engine.systems.simulators.called import Called
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.running.catalogue.files import PythonFunction
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened

BASINS = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")


class TestClosedLoop(SystemContract):
    campaign = load_file(library()["unicycle_static"]).document()
    failing = float("nan")


class TestSimulator(SystemContract):
    failing = 0.99

    @classmethod
    def open(cls) -> Problem:
        return Problem(load_document(package.campaign()), two_basins.TwoBasins(two_basins.ENTRY, BASINS))


def of_function(function: Any, document: dict[str, Any]) -> Problem:
    declared = PythonFunction(
        function.declaration, {"module": function.__module__, "name": function.__name__}, function.call
    )
    campaign = load_document(document)
    known = catalogue().model_copy(update={"simulators": [declared.entry]})
    return Problem(campaign, opened.simulated(campaign, declared, known))


class TestFunction(SystemContract):
    failing, excluding = 0.99, 1.6
    function: Any = functions.together

    @classmethod
    def open(cls) -> Problem:
        return of_function(cls.function, package.campaign(simulator={"name": cls.function.declaration.name}))


class TestIsolatedFunction(TestFunction):
    function = isolated.alone


class TestFunctionWithATrace(SystemContract):
    function: Any = tracing.together

    @classmethod
    def open(cls) -> Problem:
        name = cls.function.declaration.name
        asked = {"simulator": {"name": name}, "uncertain": {"simulator.speed": {"low": 1.0, "high": 9.0}}}
        return of_function(cls.function, package.campaign(**asked, criterion={"result": "value", "threshold": 0.1}))


class TestIsolatedFunctionWithATrace(TestFunctionWithATrace):
    function = tracing.thrown


def known() -> Catalogue:
    return catalogue().model_copy(update={"simulators": [two_basins.ENTRY]})


def wrong(**changes: Any) -> list[str]:
    return [str(p) for p in check(load_document(package.campaign(**changes)), known())]


class TestCampaign:
    def test_it_is_accepted_and_comes_back_as_it_was(self) -> None:
        asked = load_document(package.campaign())
        assert wrong() == []
        assert load_document(asked.document()) == asked
        assert "scenario" not in asked.document()
        assert asked.document()["criterion"] == {"result": "separation", "parameters": {}, "threshold": 5.0}

    @pytest.mark.parametrize("both", [True, False])
    def test_exactly_one_of_scenario_and_simulator(self, both: bool) -> None:
        document = package.campaign()
        document |= {"scenario": load_file(library()["unicycle_static"]).document()["scenario"]} if both else {}
        if not both:
            del document["simulator"]
        with pytest.raises(CampaignError, match="both" if both else "neither"):
            load_document(document)

    def test_an_unknown_simulator_is_refused_with_a_sentence(self) -> None:
        problems = wrong(simulator={"name": "two_basin"})
        assert len(problems) == 1
        assert problems[0].startswith("simulator.name: ")
        assert "'two_basins'?" in problems[0]

    @pytest.mark.parametrize(
        ("change", "statement"),
        [
            (
                {"simulator": {"name": "two_basins", "parameters": {"x": 3.0}}},
                "Offset along the track must be within -1",
            ),
            ({"simulator": {"name": "two_basins", "parameters": {"z": 3.0}}}, "no such parameter"),
            ({"criterion": {"result": "effort", "threshold": 1.0}}, "worse when high and cannot decide"),
            ({"criterion": {"result": "gap", "threshold": 1.0}}, "no such result of two_basins"),
            ({"uncertain": {"simulator.z": {"low": 0.0, "high": 1.0}}}, "no such parameter"),
            ({"objectives": [{"component": "duration"}]}, "remove this for a simulator"),
            ({"encounter": {"intended": {"motion": "it stands"}}}, "does not apply to a simulator"),
        ],
    )
    def test_what_does_not_fit_is_refused(self, change: dict[str, Any], statement: str) -> None:
        assert any(statement in problem for problem in wrong(**change))

    def test_the_snapshot_contains_the_simulator_and_reports_what_changed(self) -> None:
        kept = snapshot(load_document(package.campaign()), known())
        assert [s.name for s in kept.simulators] == ["two_basins"]
        assert changes(kept, known()) == []
        (change,) = changes(kept, catalogue())
        assert change.startswith("the simulator two_basins ")
        assert "simulators" not in snapshot(load_file(library()["unicycle_static"]), known()).model_dump()


def test_a_fresh_form_of_a_system_without_one_does_not_close_it() -> None:
    closed: list[str] = []

    class Plain(two_basins.TwoBasins):
        def fresh(self) -> Slotted:
            return self

        def close(self) -> None:
            closed.append("closed")

    called = Called(Plain(two_basins.ENTRY, BASINS), Simulator(name="two_basins", repeats=Repeats(count=3), retries=1))
    called.fresh().close()
    called.single().fresh().close()
    assert closed == []
    called.close()
    assert closed == ["closed"]


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("retries", [0, 2])
def test_evaluations_that_all_fail_take_the_calls_that_are_announced_as_the_most(count: int, retries: int) -> None:
    made: list[int] = []

    class Failing(two_basins.TwoBasins):
        def evaluate(self, vectors: Any, seeds: Any = None) -> Any:
            made.append(len(vectors))
            return Batch(np.full((len(vectors), 1), np.nan), np.full(len(vectors), FAILED, dtype=np.uint8)), {}

    request = Simulator(name="two_basins", repeats=Repeats(count=count), retries=retries)
    Called(Failing(two_basins.ENTRY, BASINS), request).evaluate(np.array([[0.1, 0.2], [0.3, 0.4]]))
    campaign = load_document(package.campaign(), "the test").model_copy(update={"simulator": request})
    stated = expected.called(campaign, 2)
    assert f", {sum(made)} calls" in stated if stated else sum(made) == 2


@pytest.mark.parametrize(
    ("repeats", "expected"),
    [
        (Repeats(count=3), [0.5, 3.5]),
        (Repeats(count=3, combine="mean"), [2.0, 5.0]),
        (Repeats(count=3, combine="quantile", quantile=0.5), [1.5, 4.5]),
    ],
)
def test_an_evaluation_combines_its_own_calls(repeats: Repeats, expected: list[float]) -> None:
    class Counting(two_basins.TwoBasins):
        def evaluate(self, vectors: Any, seeds: Any = None) -> Any:
            numbers = np.array([1.5, 0.5, 4.0, 4.5, 3.5, 7.0])[: len(vectors), None]
            return Batch(numbers, np.zeros(len(vectors), dtype=np.uint8)), {}

    called = Called(Counting(two_basins.ENTRY, BASINS), Simulator(name="two_basins", repeats=repeats))
    batch, reasons = called.evaluate(np.array([[0.1, 0.2], [0.3, 0.4]]))
    assert batch.costs[:, 0].tolist() == expected
    assert reasons == {}
    assert called.single() is called.inner


STARTS = "starts inside"
CALLS = {
    "excluded by every call": (2, 0, [(EXCLUDED, STARTS)] * 2, (EXCLUDED, STARTS)),
    "excluded by some": (2, 0, [(OK, ""), (EXCLUDED, STARTS)], (FAILED, f"call 2 of 2: excluded ({STARTS})")),
    "a failure first": (2, 0, [(EXCLUDED, STARTS), (TIMEOUT, "late")], (TIMEOUT, "call 2 of 2: late")),
    "no retry": (1, 2, [(EXCLUDED, STARTS), (OK, "")], (EXCLUDED, STARTS)),
    "no way out of a failure": (
        1,
        2,
        [(FAILED, "broke"), (EXCLUDED, STARTS), (OK, "")],
        (FAILED, "broke; tried again"),
    ),
    "a value when tried again": (1, 2, [(FAILED, "broke"), (OK, "")], (OK, f"{FLAKY}broke")),
}
"""Calls for each evaluation, retries, what successive calls return, and the evaluation that they make."""


@pytest.mark.parametrize("slots", [False, True])
@pytest.mark.parametrize("name", CALLS)
def test_several_calls_are_excluded_failed_or_tried_again(name: str, slots: bool) -> None:
    count, retries, returned, (status, reason) = CALLS[name]
    coming = iter(returned)

    class Told(two_basins.TwoBasins):
        slots = 1

        def evaluate(self, vectors: Any, seeds: Any = None) -> Any:
            found = [next(coming) for _ in vectors]
            costs = np.array([[1.0 if code == OK else np.nan] for code, _ in found])
            return Batch(costs, np.array([c for c, _ in found], dtype=np.uint8)), {
                k: why for k, (_, why) in enumerate(found) if why
            }

        def submit(self, vector: Any, seed: int | None = None) -> Future[Evaluated]:
            batch, reasons = self.evaluate(vector[None])
            ended: Future[Evaluated] = Future()
            ended.set_result(Evaluated(batch.costs[0], int(batch.status[0]), reasons.get(0, "")))
            return ended

    Told.slots = int(slots)
    request = Simulator(name="two_basins", repeats=Repeats(count=count) if count > 1 else None, retries=retries)
    batch, reasons = Called(Told(two_basins.ENTRY, BASINS), request).evaluate(np.array([[0.1, 0.2]]))
    assert int(batch.status[0]) == status
    assert np.isnan(batch.costs[0, 0]) == (status != OK)
    assert reasons.get(0, "").startswith(reason)
