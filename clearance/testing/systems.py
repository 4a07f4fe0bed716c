"""The contract of a system: parameters, results, failures, repeatable bits, confirmation.

`class TestMine(SystemContract): campaign = {...}` in a test file of a package that declares a simulator runs all of it
with pytest, on a campaign of the simulator.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from campaigns.asked.load import load_document
from campaigns.claims.spans import words
from campaigns.results.base import EXCLUDED, FAILED, OK
from worker.engine.problem.problem import Problem
from worker.engine.systems import optional
from worker.engine.systems.base import Floats, Slotted, indices
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.engine.systems.simulators.simulated import Simulated
from worker.evidence.scopes.terms import terms
from worker.running.opening import opened


class SystemContract:
    """Every check of one system, on `count` evaluations within the bounds of a campaign.

    failing, excluding: the value, of every parameter, with which an evaluation fails or is excluded; None if none is.
    """

    campaign: ClassVar[Mapping[str, object]]
    failing: ClassVar[float | None] = None
    excluding: ClassVar[float | None] = None
    count: ClassVar[int] = 40
    _opened: ClassVar[Problem | None] = None

    @classmethod
    def open(cls) -> Problem:
        """The problem of the campaign."""
        return opened.problem(load_document(cls.campaign))

    @classmethod
    def opened(cls) -> Problem:
        """The system, opened once for all tests of the class."""
        if cls._opened is None:
            cls._opened = cls.open()
        return cls._opened

    @classmethod
    def teardown_class(cls) -> None:
        """Called by pytest after the last test."""
        if cls._opened is not None:
            optional.close(cls._opened.system)
            cls._opened = None

    def vectors(self) -> Floats:
        """Within the bounds."""
        problem = self.opened()
        return problem.vectors(np.random.default_rng(1).random((self.count, problem.dimension)))

    def test_parameters_are_the_columns_of_its_vectors(self) -> None:
        system = self.opened().system
        paths = [p.path for p in system.parameters]
        assert len(set(paths)) == len(paths) <= len(system.nominal)
        assert [p.nominal for p in system.parameters] == system.nominal[: len(paths)].tolist()
        assert all(p.low <= p.nominal <= p.high and p.text for p in system.parameters)
        assert list(indices(system.parameters)) == paths

    def test_the_first_result_decides_and_is_worse_when_low(self) -> None:
        system, vectors = self.opened().system, self.vectors()
        batch, _ = system.evaluate(vectors)
        assert batch.costs.shape == (len(vectors), len(system.results))
        assert system.results[0].worse == "low"

    def test_what_is_not_ok_has_no_cost_and_a_reason(self) -> None:
        system, vectors = self.opened().system, self.vectors()
        for value, status in ((self.failing, FAILED), (self.excluding, EXCLUDED)):
            if value is None:
                continue
            broken = vectors.copy()
            broken[::3] = value
            batch, reasons = system.evaluate(broken)
            lost = np.flatnonzero(batch.status != OK)
            assert lost.tolist() == list(range(0, len(vectors), 3)) == sorted(reasons)
            assert (batch.status[lost] == status).all()
            assert np.isnan(batch.costs[lost]).all()
            assert all(reasons.values())

    def test_the_nominal_case_counts(self) -> None:
        system = self.opened().system
        batch, _ = system.evaluate(system.nominal[None])
        assert batch.status[0] != EXCLUDED

    def test_bits_depend_on_the_vector_alone(self) -> None:
        system, vectors = self.opened().system, self.vectors()
        assert system.repeatable
        together, _ = system.evaluate(vectors)
        alone = [system.evaluate(v[None])[0].costs[0] for v in vectors[:5]]
        assert np.array(alone).tobytes() == together.costs[:5].tobytes()

    def test_it_confirms_by_means_of_its_own(self) -> None:
        system, vectors = self.opened().system, self.vectors()
        batch, _ = system.evaluate(vectors[:2])
        confirmed = system.confirm(vectors[:2], [None, None])
        assert [c.cost for c in confirmed] == batch.costs[:, 0].tolist()
        stepped = isinstance(system, Simulated) and system.step is not None
        kinds = {"half_step", "integrator"} if optional.settings(system).integrator else {"again"}
        kinds |= {"half_step"} if stepped else set()
        for case, other in zip(confirmed, optional.compare(system, vectors[:2], [None, None]), strict=True):
            assert {c.kind for c in case.comparisons} == kinds
            # How much half the step of a simulator may change is the tolerance of a campaign.
            assert all(_near(c.cost, case.cost) for c in case.comparisons if not (stepped and c.kind == "half_step"))
            assert other == case.comparisons[-1]
        assert system.confirm(vectors[:2], [None, None], lambda: True) == []

    def test_only_what_shows_an_encounter_has_a_trace(self) -> None:
        system = self.opened().system
        trace, shows = system.trace("nominal", {}), terms(system).shows
        assert (trace is None) == (not shows) or not isinstance(system, ClosedLoop)  # a simulator may declare a trace
        assert (optional.encounter(system, trace) is None) == (not shows)

    def test_it_is_a_closed_loop_with_a_text_to_show_or_has_calls(self) -> None:
        system = self.opened().system
        assert isinstance(system, ClosedLoop) != isinstance(system, Slotted)
        assert isinstance(system, ClosedLoop) == bool(optional.settings(system).integrator)
        assert not isinstance(system, ClosedLoop) or "def closed_loop" in system.source.read_text(encoding="utf-8")

    def test_its_words_claim_an_integrator_only_where_there_is_one(self) -> None:
        system = self.opened().system
        of = terms(system)
        scope = [words(of.scope.what), words(of.scope.settings), of.scope.version]
        texts = json.dumps([vars(of.words), *scope, of.caveat])
        flown = [word for word in ("integrat", "step", "flight", "horizon") if word in texts]
        assert bool(flown) == bool(optional.settings(system).integrator)
        assert len(system.digest) >= 16


def _near(one: float | None, other: float | None) -> bool:
    return one is not None and other is not None and abs(one - other) <= 1e-4 * abs(other)
