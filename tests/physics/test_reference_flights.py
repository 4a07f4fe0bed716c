"""Simulations with the compiled reference integrator against SciPy's DOP853 in plain Python.

Where the loop switches nowhere, or at instants that are known, the two agree within SMOOTH of d_min over seconds: both
keep 1e-9 a step. Over whole simulations what is left of that grows to WHOLE; with 1e-11 a step it shrinks a
thousandfold (pioneer_latency: from 9e-7 to 1e-9 m). Where the loop slides along a switch neither has an order: from
there on both keep 1e-4 a step and agree within SLIDING.
"""

from __future__ import annotations

import ctypes
from types import SimpleNamespace
from typing import Any

import numba
import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.results.base import OK
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign
from tests.given.reference_in_python import PlainReference
from tests.physics.scenes import changed
from worker.engine.reference import compiled, flight, stepper
from worker.engine.reference.instants import Timetable
from worker.engine.reference.reference import Reference
from worker.engine.systems.closed_loop.confirm import Flight
from worker.running.opening import opened

SMOOTH, SLIDING = 1e-8, 1e-3
WHOLE = 1e-5
"""[m]"""

# Together: both dimensions, guidance continuous and sampled, with memory, noise that jumps, an obstacle with states.
SOME = {
    "unicycle_noise": 4.0,
    "unicycle_actuator_loss": 4.0,
    "uav_aca": 3.0,
}


def agree(problem: Problem, vector: Any, floor: float = 0.0) -> None:
    ours, theirs = (
        Reference(problem.system).simulate(vector),
        PlainReference(problem.system).simulate(vector),
    )
    if theirs.cost is None or ours.cost is None:
        assert ours == theirs
        return
    sliding = bool(ours.reason or theirs.reason)
    assert bool(ours.reason) == bool(theirs.reason)
    assert ours.cost == pytest.approx(theirs.cost, rel=SLIDING if sliding else SMOOTH, abs=floor)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", SOME)
def test_compiled_and_plain_agree(name: str) -> None:
    problem = Problem(changed(load_file(library()[name]), horizon=SOME[name]))
    agree(problem, problem.system.nominal)


@pytest.mark.nightly
@pytest.mark.parametrize("name", library())
def test_compiled_and_plain_agree_on_the_library(name: str) -> None:
    """Every campaign, whole flights: the nominal one and a few at random."""
    problem = Problem(load_file(library()[name]))
    points = np.random.default_rng(1).random((3, problem.dimension))
    for vector in [problem.system.nominal, *problem.vectors(points)]:
        agree(problem, vector, WHOLE)


@pytest.fixture(scope="module")
def case1() -> Problem:
    return Problem(campaign(scenario__horizon=4.0))


def test_compiled_and_interpreted_give_the_same_bits(case1: Problem) -> None:
    """The integrator in Python over the compiled loop, and compiled: nothing is reordered, fused or assumed away."""
    system = compiled.system(case1.system.loop)
    numbers = ctypes.POINTER(ctypes.c_double)

    def called(what: int, t: float, *rows: Any) -> float:
        return float(system.ctypes(what, t, *(row.ctypes.data_as(numbers) for row in rows)))

    here, there = Reference(case1.system), Reference(case1.system)
    there.__dict__["_system"] = SimpleNamespace(address=called), flight.fly
    assert there.simulate(case1.system.nominal) == here.simulate(case1.system.nominal)


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "name", ["unicycle_static", "unicycle_noise", pytest.param("uav_moving_gusts", marks=pytest.mark.nightly)]
)
def test_the_channels_alone_have_the_bits_that_they_have_with_the_slope(name: str) -> None:
    problem = Problem(changed(load_file(library()[name]), horizon=3.0))
    alone, beside = Reference(problem.system), Reference(problem.system)
    system, numbers, asked = alone._system[0], ctypes.POINTER(ctypes.c_double), set()

    def called(what: int, t: float, x: Any, dx: Any, *rows: Any) -> float:
        """The channels read with the whole slope, which is dropped."""
        asked.add(what)
        what, dx = (stepper.SLOPE, np.zeros_like(dx)) if what == stepper.SEE else (what, dx)
        return float(system.ctypes(what, t, *(row.ctypes.data_as(numbers) for row in (x, dx, *rows))))

    beside.__dict__["_system"] = SimpleNamespace(address=called), flight.fly
    assert beside.simulate(problem.system.nominal, 1) == alone.simulate(problem.system.nominal, 1)
    assert stepper.SEE in asked


@pytest.mark.nightly
def test_noise_cached_over_an_interval_and_noise_drawn_at_every_slope_give_the_same_bits() -> None:
    problem = Problem(changed(load_file(library()["uav_moving_gusts"]), horizon=3.0))
    assert compiled.draws(problem.system.loop) == 3
    drawn = numba.cfunc(compiled.SYSTEM, **compiled.STRICT)(compiled.bound(problem.system.loop, keep=False))
    keeping, drawing = Reference(problem.system), Reference(problem.system)
    drawing.__dict__["_system"] = drawn, compiled.integrator()
    for seed in (1, 2):
        vector = problem.vector({"environment.0.W": 5.0})
        assert keeping.simulate(vector, seed).cost is not None
        assert keeping.simulate(vector, seed) == drawing.simulate(vector, seed)
    assert keeping.simulate(vector, 1) != keeping.simulate(vector, 2)


@pytest.mark.parametrize("horizon", [4.0, 4.1, 4.4, 4.9])
def test_guidance_is_sampled_in_a_last_period_that_the_horizon_cuts_off(horizon: float) -> None:
    asked = campaign(scenario__horizon=horizon, scenario__guidance__period=0.5)
    flights = opened.flights(asked, compiled=False, lanes=1)
    stretches = Timetable(flights).of(flights.loop.extend(flights.vector({})))
    sampled = stretches.instants[:-1][stretches.asks]
    assert sampled == pytest.approx(np.arange(0.0, horizon, 0.5))
    assert stretches.instants[-1] == horizon


def test_the_seed_that_counts_need_not_be_searched_again() -> None:
    problem = Problem(changed(load_file(library()["unicycle_noise"]), horizon=3.0))
    vectors = problem.vectors(np.random.default_rng(3).random((3, problem.dimension)))
    batch, _, seeds = problem.system.simulate_realised(vectors)
    assert seeds is not None
    assert (batch.costs == problem.system.simulate_vectors(vectors)[0].costs).all()
    reference = Reference(problem.system)
    searched = reference.simulate_all(vectors)
    assert reference.simulate_all(vectors, counts=seeds) == searched == [reference.simulate(v) for v in vectors]
    assert all(f.cost is not None for f in searched)


def test_it_is_found_on_disk_by_a_digest_of_the_loop(case1: Problem) -> None:
    first, again = (compiled.system(case1.system.loop) for _ in range(2))
    assert again.cache_hits == 1
    assert (
        compiled.bound(case1.system.loop).__qualname__
        == compiled.bound(Problem(case1.campaign).system.loop).__qualname__
    )
    other = Problem(campaign(scenario__guidance={"period": 0.1}))
    assert compiled.bound(other.system.loop).__qualname__ != compiled.bound(case1.system.loop).__qualname__
    assert first.address != again.address


def test_a_batch_of_simulations_equals_single_ones(case1: Problem) -> None:
    reference = Reference(case1.system)
    vectors = case1.vectors(np.random.default_rng(2).random((5, case1.dimension)))
    assert reference.simulate_all(vectors) == [reference.simulate(vector) for vector in vectors]
    batch, _ = case1.system.simulate_vectors(vectors)
    assert (batch.status == OK).all()
    assert [f.cost for f in reference.simulate_all(vectors)] == pytest.approx(batch.costs[:, 0], abs=2e-6)
    assert reference.simulate_all(vectors[:0]) == []


@pytest.mark.parametrize("threads", [1, 2])
def test_cancelled_it_stops_with_what_there_is(case1: Problem, monkeypatch: pytest.MonkeyPatch, threads: int) -> None:
    monkeypatch.setenv("CLEARANCE_THREADS", str(threads))
    asked: list[None] = []

    def cancelled() -> bool:
        asked.append(None)
        return len(asked) > 2

    reference, vectors = Reference(case1.system), np.repeat(case1.system.nominal[None], 9, axis=0)
    flown = reference.simulate_all(vectors, cancelled)
    assert flown == [reference.simulate(case1.system.nominal)] * (2 * threads)


class TestWhatCannotBeFlown:
    @pytest.mark.parametrize("by", [Reference, PlainReference])
    def test_an_excluded_start_is_excluded_here_too(self, case1: Problem, by: type[Reference]) -> None:
        vector = case1.vector({"criterion.threshold": 100.0})
        _, reasons = case1.system.simulate_vectors(vector[None])
        assert by(case1.system).simulate(vector) == Flight(None, f"DOP853: {reasons[0]}")

    @pytest.mark.parametrize("by", [Reference, PlainReference])
    @pytest.mark.parametrize("value", [1e-300, 0.0, np.nan, np.inf, -1.0])
    def test_wrong_parameters_are_refused_with_a_sentence(
        self, case1: Problem, by: type[Reference], value: float
    ) -> None:
        found = by(case1.system).simulate(case1.vector({"vehicle.J": value}))
        assert found.cost is None
        assert found.reason.startswith("DOP853")
