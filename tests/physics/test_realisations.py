"""Realisations: every evaluation simulates the campaign's seeds and uses the worst or the mean of them.

Also what follows from noise being a function of seed and time alone: the same bits in every batch and process, the
same flight under another integrator; and that nothing within the limits of the faults' parameters ends badly unseen.
"""

from __future__ import annotations

import functools
import math
import subprocess
import sys
import tracemalloc
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import Campaign, CampaignError, check, library, load_file
from campaigns.asked.load import load_document
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.results.trace import Realisation
from clearance.testing.problems import Problem
from clearance.testing.scenes import FEW, scene
from tests.audited import audited
from tests.contract.hands import together
from tests.given.at_night import nightly_but
from tests.physics.scenes import uncompiled
from worker.engine.kernels.component import Environment, Fault
from worker.engine.reference.reference import Reference
from worker.engine.systems.closed_loop.trace import simulate, trace
from worker.running.catalogue.installed import catalogue, components
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

CASE = load_file(library()["unicycle_static"])
NOISE = {"component": "sensor_noise", "parameters": {"sigma": 0.05, "period": 0.1}}
SAMPLED = {"horizon": 8.0, "guidance": {"period": 0.1}}
POINTS = np.random.default_rng(3).random((9, 2))


def changed(campaign: Campaign, **scenario: Any) -> Campaign:
    """The campaign with parts of its scenario replaced and a small search."""
    document = campaign.document()
    document["scenario"] |= scenario
    document["stages"]["search"] = [{"method": "direct", "evaluations": 40}]
    return load_document(document)


def noisy(seeds: list[int], combine: str = "worst", noise: dict[str, Any] = NOISE, **scenario: Any) -> Campaign:
    return changed(CASE, faults=[noise], realisations={"seeds": seeds, "combine": combine}, **(SAMPLED | scenario))


@functools.cache
def costs(seeds: tuple[int, ...], combine: str = "worst") -> Any:
    batch, reasons = Problem(noisy(list(seeds), combine)).evaluate(POINTS)
    assert (batch.status == OK).all(), reasons
    return batch.costs[:, 0]


class TestCombining:
    SEEDS = (3, 1, 8, 5)

    def test_the_worst_is_the_lowest_of_the_single_ones(self) -> None:
        single = np.array([costs((s,)) for s in self.SEEDS])
        assert costs(self.SEEDS).tobytes() == single.min(axis=0).tobytes()
        assert len(set(single[:, 0])) == len(self.SEEDS)

    def test_the_mean_is_their_mean(self) -> None:
        single = np.array([costs((s,)) for s in self.SEEDS])
        assert costs(self.SEEDS, "mean") == pytest.approx(single.mean(axis=0), rel=1e-14)

    def test_without_deviation_all_realisations_are_the_flight_without_noise(self) -> None:
        silent = NOISE | {"parameters": {"sigma": 0.0}}
        quiet = Problem(noisy([1, 2, 3], noise=silent)).evaluate(POINTS[:2])[0].costs
        without = uncompiled(changed(CASE, **SAMPLED)).evaluate(POINTS[:2])[0].costs
        assert quiet == pytest.approx(without, abs=1e-12)

    def test_a_failed_flight_fails_the_evaluation_and_names_its_seed(self) -> None:
        wild = NOISE | {"parameters": {"sigma": 0.6}}
        seeds = list(range(40))
        alone = [Problem(noisy([s], noise=wild)).evaluate(POINTS[:1]) for s in seeds]
        failed = [s for s, (batch, _) in zip(seeds, alone, strict=True) if batch.status[0] == FAILED]
        fine = [s for s in seeds if s not in failed]
        assert failed
        assert fine
        batch, reasons = Problem(noisy([fine[0], failed[0], fine[-1]], noise=wild)).evaluate(POINTS[:1])
        assert batch.status[0] == FAILED
        assert math.isnan(batch.costs[0, 0])
        assert reasons[0] == f"with seed {failed[0]}: {alone[failed[0]][1][0]}"

    def test_an_excluded_evaluation_stays_excluded(self) -> None:
        problem = Problem(noisy([1, 2], start={"x": 4.0, "y": 4.3}))
        batch, reasons = problem.evaluate(POINTS[:2])
        assert batch.status.tolist() == [EXCLUDED, EXCLUDED]
        assert reasons[1].startswith("with seed 1: d_min ")

    def test_two_of_a_kind_are_independent_though_their_seeds_are_equal(self) -> None:
        # Twice the same noise would be one of twice the deviation, which two independent ones are not.
        half = NOISE | {"parameters": {"sigma": 0.025, "seed": 4.0}}
        twice = uncompiled(changed(CASE, faults=[half, half], **SAMPLED)).evaluate(POINTS[:2])[0].costs
        once = Problem(changed(CASE, faults=[NOISE | {"parameters": {"sigma": 0.05, "seed": 4.0}}], **SAMPLED))
        assert np.abs(twice - once.evaluate(POINTS[:2])[0].costs).min() > 1e-6

    def test_a_seed_of_its_own_selects_another_realisation(self) -> None:
        own = NOISE | {"parameters": NOISE["parameters"] | {"seed": 1.0}}
        assert np.abs(Problem(noisy([3], noise=own)).evaluate(POINTS)[0].costs[:, 0] - costs((3,))).min() > 1e-6


class TestShown:
    def test_the_trace_is_that_of_the_worst(self) -> None:
        problem = Problem(noisy([3, 1, 8, 5]))
        shown = trace(problem.system, "nominal", {})
        single = {s: trace(Problem(noisy([s])).system, "nominal", {}).meta.cost for s in (3, 1, 8, 5)}
        worst = min(single, key=lambda s: single[s])
        assert shown.meta.realisation == Realisation(seed=worst, seeds=4, combine="worst", cost=single[worst])
        assert shown.meta.cost == single[worst]
        assert shown.data[:, -1].min() == pytest.approx(single[worst], abs=1e-3)

    def test_one_realisation_is_simulated_alone_bit_for_bit_in_the_memory_of_one(self) -> None:
        problem = Problem(noisy(list(range(32))))
        flown = simulate(problem.system, {})
        vectors = problem.realisations.flights(problem.vector({})[None, :])
        every = problem.system.loop.simulate(
            vectors, problem.system.step, *problem.system.counts(problem.system.step), traced=len(vectors)
        )
        shown = int(np.argmin(every.costs[:, 0]))
        assert shown == flown.realisation > 0
        assert flown.states.tobytes() == every.trace[shown].tobytes()
        assert flown.costs[0, 0] == flown.own_cost == every.costs[shown, 0]
        tracemalloc.start()
        try:
            simulate(problem.system, {})
            peak = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        assert peak < 4 * flown.states.nbytes < every.trace.nbytes / 4

    def test_of_a_mean_the_trace_is_that_of_the_worst_and_the_cost_is_the_mean(self) -> None:
        shown = trace(Problem(noisy([3, 1, 8, 5], "mean")).system, "nominal", {}).meta
        assert shown.realisation is not None
        assert shown.realisation.cost is not None
        assert shown.cost is not None
        assert shown.realisation.cost < shown.cost

    @pytest.mark.parametrize("guidance", [pytest.param(0.0, marks=pytest.mark.nightly), 0.1])
    def test_another_integrator_and_half_the_step_agree(self, guidance: float) -> None:
        problem = Problem(noisy([3, 1], guidance={"period": guidance}))
        vector = problem.system.nominal
        found = problem.system.simulate_vectors(vector[None])[0].costs[0, 0]
        assert problem.system.simulate_vectors(vector[None], problem.system.step / 2)[0].costs[0, 0] == pytest.approx(
            found, abs=2e-6
        )
        assert Reference(problem.system).simulate(vector).cost == pytest.approx(found, abs=2e-6)

    @pytest.mark.nightly
    def test_a_run_states_what_its_verdict_holds_for(self) -> None:
        store = MemoryStore()
        execute(noisy([3, 1]), store)
        audited(store, noisy([3, 1]))
        assert store.verdict is not None
        assert " Sensor noise, worst of 2 realisations" in store.verdict.scope
        stated = [f.label for f in store.findings if f.validation is not None and f.realisation is None]
        shown = [store.traces[label].meta.realisation for label in stated]
        assert [None if r is None else r.seeds for r in shown] == [2] * len(stated)
        assert stated


class TestRefused:
    def problems(self, **scenario: Any) -> list[str]:
        return [str(p) for p in check(changed(CASE, **scenario), catalogue())]

    def test_seeds_where_nothing_is_random(self) -> None:
        (problem,) = self.problems(realisations={"seeds": [1, 2]})
        assert problem.startswith("scenario.realisations.seeds: ")
        assert "nothing in the scenario is random" in problem

    @pytest.mark.parametrize(
        ("random", "certify", "refused"),
        [
            (True, {"samples": 100_001}, True),
            (True, {"samples": 100_000}, False),
            (True, {"samples": 100_001, "keep": "lowest"}, False),
            (False, {"samples": 100_001}, False),
        ],
    )
    def test_a_sample_whose_draws_would_often_have_the_same_noise(
        self, random: bool, certify: dict[str, Any], refused: bool
    ) -> None:
        document = (noisy([1]) if random else CASE).document()
        document["stages"]["certify"] = certify
        found = [problem.field for problem in check(load_document(document), catalogue())]
        assert found == ["stages.certify.samples"] * refused

    def test_a_seed_as_something_uncertain(self) -> None:
        document = noisy([1]).document()
        document["uncertain"] = {"faults.0.seed": {"low": 0, "high": 9}}
        (problem,) = check(load_document(document), catalogue())
        assert problem.field == "uncertain.faults.0.seed"
        assert "is not a quantity" in str(problem)

    @pytest.mark.parametrize("seeds", [[], [1, 1], [-1], [2**20], [0.5], list(range(65))])
    def test_seeds_that_cannot_be(self, seeds: list[float]) -> None:
        with pytest.raises(CampaignError, match="seeds"):
            noisy(seeds)  # type: ignore[arg-type]


class TestDeterminism:
    def test_bits_do_not_depend_on_the_batch(self) -> None:
        problem = Problem(noisy([3, 1, 8, 5]))
        together = problem.evaluate(POINTS)[0].costs
        alone = np.array([problem.evaluate(p[None])[0].costs[0] for p in POINTS])
        order = np.random.default_rng(1).permutation(len(POINTS))
        assert alone.tobytes() == together.tobytes()
        assert problem.evaluate(POINTS[order])[0].costs.tobytes() == together[order].tobytes()

    @pytest.mark.nightly  # by day tests/contract/test_methods.py: the same seed in every process
    def test_another_process_gives_the_same_bits(self) -> None:
        program = "import tests.physics.test_realisations as t; print(t.costs((3, 1, 8, 5)).tobytes().hex())"
        statement = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=250
        )
        assert statement.stdout.strip() == costs((3, 1, 8, 5)).tobytes().hex()


@functools.cache
def everything(sampled: bool) -> Problem:
    """Case 1 past a moving circle with every fault and every part of the environment in the loop."""
    known = components().values()
    faults = [
        {"component": f.name} | ({"on": "torque" if k % 2 else "force"} if f.path == "actuator" else {})
        for k, f in enumerate(f for f in known if isinstance(f, Fault))
        if sampled or f.path != "guidance"
    ]
    around = [{"component": e.name} for e in known if isinstance(e, Environment)]
    obstacle = {"position": {"x": 8.0, "y": 1.0}, "goal": {"x": 0.0, "y": 7.0}, "speed": 0.7}
    return Problem(
        changed(
            CASE,
            faults=faults,
            environment=around,
            obstacles=[{"component": "moving_circle", "parameters": obstacle}],
            horizon=6.0,
            guidance={"period": 0.05 * sampled},
        )
    )


@functools.cache
def together_in_plane(k: int) -> Problem:
    """Half of the faults and of the environment in a loop that tests/contract/test_compiled.py compiles too."""
    document = scene(*together()[k]).document
    document["scenario"]["horizon"] = 6.0
    return Problem(load_document(document), lanes=FEW)


LOOPS = {
    "some": lambda: together_in_plane(0),
    "others": lambda: together_in_plane(1),
    "all": lambda: everything(True),
    "all, guidance not sampled": lambda: everything(False),
}


@pytest.mark.parametrize("loop", nightly_but(("some",), LOOPS))
class TestWithinLimits:
    """Whatever the parameters within their limits: a finite cost or a status with a reason, never a crash or a NaN."""

    @pytest.mark.nightly
    @settings(max_examples=30)
    @given(seed=st.integers(0, 2**32 - 1), touched=st.floats(0.0, 1.0), reach=st.floats(0.0, 8.0))
    def test_nothing_ends_badly_unseen(self, loop: str, seed: int, touched: float, reach: float) -> None:
        problem, random = LOOPS[loop](), np.random.default_rng(seed)
        vectors = np.repeat(problem.system.nominal[None], 16, axis=0)
        for section in problem.system.loop.sections:
            for k, p in enumerate(section.parameters):
                if not section.prefix.startswith(("faults", "environment")):
                    continue
                wide = random.uniform(p.low, p.high, 16)
                near = np.clip(p.default + random.normal(size=16) * 10.0 ** random.uniform(-reach, 1.0), p.low, p.high)  # type: ignore[operator]
                ends = random.choice([p.low, p.high], 16)
                value = np.choose(random.integers(0, 8, 16), [wide, ends, *[near] * 6])
                chosen = random.random(16) < touched
                vectors[chosen, section.first + k] = value[chosen]
        batch, reasons = problem.system.simulate_vectors(vectors)
        ok = batch.status == OK
        assert np.isfinite(batch.costs[ok]).all()
        assert np.isnan(batch.costs[~ok]).all()
        assert sorted(reasons) == np.flatnonzero(~ok).tolist()
        assert all(reasons.values())
