"""The contract of all systems, tested on the closed loop, a simulator and functions."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from campaigns import Catalogue, check, library, load_file
from campaigns.asked.load import CampaignError, load_document
from campaigns.asked.spec import Repeats, Simulator
from campaigns.checked.snapshot import changes, snapshot
from campaigns.claims.spans import words
from campaigns.results.base import FAILED, OK
from tests.simulators import functions, isolated, package, two_basins
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.systems.base import System
from worker.engine.systems.simulators.called import Called
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.running.catalogue.files import PythonFunction
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened

BASINS = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")


@pytest.fixture(scope="module", params=["closed loop", "simulator", "function", "isolated function"])
def problem(request: pytest.FixtureRequest) -> Iterator[Problem]:
    if request.param == "closed loop":
        yield opened.problem(load_file(library()["unicycle_static"]))
    elif request.param == "simulator":
        yield Problem(load_document(package.campaign()), two_basins.TwoBasins(two_basins.ENTRY, BASINS))
    else:
        function = functions.together if request.param == "function" else isolated.alone
        place = {"module": function.__module__, "name": function.__name__}
        declared = PythonFunction(function.declaration, place, function.call)
        campaign = load_document(package.campaign(simulator={"name": function.declaration.name}))
        known = catalogue().model_copy(update={"simulators": [declared.entry]})
        found = Problem(campaign, opened.simulated(campaign, declared, known))
        yield found
        found.system.close()


@pytest.fixture(scope="module")
def system(problem: Problem) -> System:
    return problem.system


@pytest.fixture(scope="module")
def vectors(problem: Problem) -> Any:
    return problem.vectors(np.random.default_rng(1).random((40, problem.dimension)))


class TestSystem:
    def test_parameters_are_the_columns_of_its_vectors(self, system: System) -> None:
        paths = [p.path for p in system.parameters]
        assert len(set(paths)) == len(paths) <= len(system.nominal)
        assert [p.nominal for p in system.parameters] == system.nominal[: len(paths)].tolist()
        assert all(p.low <= p.nominal <= p.high and p.text for p in system.parameters)
        assert list(system.names) == paths

    def test_the_first_result_decides_and_is_worse_when_low(self, system: System, vectors: Any) -> None:
        batch, _ = system.evaluate(vectors)
        assert batch.costs.shape == (len(vectors), len(system.results))
        assert system.results[0].worse == "low"

    def test_what_is_not_ok_has_no_cost_and_a_reason(self, system: System, vectors: Any) -> None:
        broken = vectors.copy()
        broken[::3] = np.nan if system.settings.integrator else 0.99
        batch, reasons = system.evaluate(broken)
        lost = np.flatnonzero(batch.status != OK)
        assert lost.tolist() == list(range(0, len(vectors), 3)) == sorted(reasons)
        assert (batch.status[lost] == FAILED).all()
        assert np.isnan(batch.costs[lost]).all()
        assert all(reasons.values())

    def test_bits_depend_on_the_vector_alone(self, system: System, vectors: Any) -> None:
        assert system.repeatable
        together, _ = system.evaluate(vectors)
        alone = [system.evaluate(v[None])[0].costs[0] for v in vectors[:5]]
        assert np.array(alone).tobytes() == together.costs[:5].tobytes()

    def test_it_confirms_by_means_of_its_own(self, system: System, vectors: Any) -> None:
        batch, _ = system.evaluate(vectors[:2])
        confirmed = system.confirm(vectors[:2], [None, None])
        assert [c.cost for c in confirmed] == batch.costs[:, 0].tolist()
        kinds = {"half_step", "integrator"} if system.settings.integrator else {"again"}
        for case, other in zip(confirmed, system.compare(vectors[:2], [None, None]), strict=True):
            assert {c.kind for c in case.comparisons} == kinds
            assert all(c.cost == pytest.approx(case.cost, rel=1e-4) for c in case.comparisons)
            assert other == case.comparisons[-1]
        assert system.confirm(vectors[:2], [None, None], lambda: True) == []

    def test_only_what_shows_an_encounter_has_a_trace(self, system: System) -> None:
        trace = system.trace("nominal", {})
        assert (trace is None) == (not system.shows)
        assert (system.encounter(trace) is None) == (not system.shows)

    def test_only_a_closed_loop_has_a_text_to_show(self, system: System) -> None:
        assert (system.source is not None) == bool(system.settings.integrator)
        assert system.source is None or "def closed_loop" in system.source.read_text(encoding="utf-8")

    def test_its_words_claim_an_integrator_only_where_there_is_one(self, system: System) -> None:
        held = system.scope
        said = json.dumps([vars(system.words), words(held.what), words(held.settings), held.version, system.caveat])
        flown = [word for word in ("integrat", "step", "flight", "horizon") if word in said]
        assert bool(flown) == bool(system.settings.integrator)
        assert len(system.digest) >= 16


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
        with pytest.raises(CampaignError, match=r"give exactly one of scenario and simulator; (both|neither)"):
            load_document(document)

    def test_an_unknown_simulator_is_refused_with_a_sentence(self) -> None:
        problems = wrong(simulator={"name": "two_basin"})
        assert len(problems) == 1
        assert "no such simulator in this installation; did you mean 'two_basins'?" in problems[0]

    @pytest.mark.parametrize(
        ("change", "said"),
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
    def test_what_does_not_fit_is_refused(self, change: dict[str, Any], said: str) -> None:
        assert any(said in problem for problem in wrong(**change))

    def test_the_snapshot_contains_the_simulator_and_reports_what_changed(self) -> None:
        kept = snapshot(load_document(package.campaign()), known())
        assert [s.name for s in kept.simulators] == ["two_basins"]
        assert changes(kept, known()) == []
        assert changes(kept, catalogue()) == ["the simulator two_basins is no longer in this installation"]
        assert "simulators" not in snapshot(load_file(library()["unicycle_static"]), known()).model_dump()


def test_a_fresh_form_of_a_system_without_one_does_not_close_it() -> None:
    closed: list[str] = []

    class Plain(two_basins.TwoBasins):
        def fresh(self) -> System:
            return self

        def close(self) -> None:
            closed.append("closed")

    called = Called(Plain(two_basins.ENTRY, BASINS), Simulator(name="two_basins", repeats=Repeats(count=3), retries=1))
    called.fresh().close()
    called.single().fresh().close()
    assert closed == []
    called.close()
    assert closed == ["closed"]


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
