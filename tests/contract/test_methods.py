"""Every search method: inside the box, within its budget, reproducible from its seed, for any outcomes."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator

import numpy as np
import pytest

from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from tests.contract import searches
from tests.contract.searches import (
    BUDGET,
    EACH,
    FUNCTIONS,
    Answer,
    answering,
    at_most,
    driven,
    rough,
    smooth,
    with_each,
)
from tests.unit.functions import on_unit_cube
from tests.unit.searching import batch, run, space
from worker.engine.search.base import Floats, Method, Search
from worker.engine.systems.simulators.slots.given import THREADS
from worker.running.catalogue.installed import methods


@pytest.fixture(autouse=True)
def no_thread_stays() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    assert set(threading.enumerate()) <= before


@pytest.mark.parametrize(("method", "name", "dimension"), with_each(FUNCTIONS, (1, 2, 8)))
def test_points_are_points_of_the_unit_cube(method: Method, name: str, dimension: int) -> None:
    found = run(method, FUNCTIONS[name], dimension, at_most(method, BUDGET))
    for points in found.batches:
        assert points.dtype == np.float64
        assert points.ndim == 2
        assert points.shape[1] == dimension
        assert len(points) > 0
        assert np.isfinite(points).all()
        assert points.min() >= 0.0
        assert points.max() <= 1.0
    assert found.text is None or len(found.text) > 10
    for minimum in found.minima:
        assert np.isfinite(minimum.cost)
        assert minimum.cost == FUNCTIONS[name](minimum.point[None, :])[0]
        assert minimum.point.min() >= 0.0
        assert minimum.point.max() <= 1.0
        assert 0 < minimum.evaluations <= sum(map(len, found.batches))


@EACH
@pytest.mark.parametrize("budget", [1, 2, 7, 100, 401])
def test_the_budget_is_never_exceeded(method: Method, budget: int) -> None:
    asked: list[int] = []

    def evaluate(points: Floats) -> Answer:
        asked.append(len(points))
        return batch(rough(points)), {}

    budget = at_most(method, budget)
    found = driven(method, evaluate, budget)
    assert sum(asked) == found.tally.evaluations <= budget
    assert found.stop == "rule" or found.tally.evaluations == budget


@pytest.mark.parametrize(
    ("method", "name", "status"),
    with_each(("half of it fails", "what is best fails", "the middle fails"), (FAILED, TIMEOUT, EXCLUDED)),
)
def test_what_failed_is_survived_and_never_the_best(method: Method, name: str, status: int) -> None:
    found = driven(method, answering(FUNCTIONS[name], status), at_most(method, 600))
    tally = found.tally
    assert tally.best_point is not None
    assert tally.best is not None
    assert found.columns is not None
    assert tally.best == smooth(tally.best_point[None, :])[0] == found.columns.costs[found.columns.status == OK].min()
    assert FUNCTIONS[name](tally.best_point[None, :])[0] == tally.best
    counted = int((found.columns.status == status).sum())
    assert (tally.excluded if status == EXCLUDED else tally.failed) == counted


@EACH
@pytest.mark.parametrize("status", [FAILED, TIMEOUT, EXCLUDED])
def test_when_nothing_succeeds_nothing_is_found(method: Method, status: int) -> None:
    found = driven(method, answering(FUNCTIONS["everything fails"], status), at_most(method, 200))
    assert (found.tally.best, found.tally.best_point) == (None, None)
    assert found.tally.evaluations <= 200


@EACH
@pytest.mark.parametrize("after", [0, 1, 2, 3, 10])
def test_it_can_be_abandoned_at_any_moment(method: Method, after: int) -> None:
    before = threading.active_count()
    search: Search = method.search(space(3, 10**6), method.options())
    try:
        points = next(search) if after else None
        for _ in range(after - 1):
            assert points is not None
            points = search.send(batch(rough(points)))
    except StopIteration:
        pass
    search.close()
    assert threading.active_count() == before


@EACH
def test_it_is_not_begun_before_it_is_asked(method: Method) -> None:
    before = threading.active_count()
    method.search(space(3, 100), method.options())
    assert threading.active_count() == before


@EACH
def test_answers_may_be_changed_after_they_were_given(method: Method) -> None:
    def play(spoil: bool) -> Floats:
        search, asked = method.search(space(2, BUDGET), method.options()), []
        try:
            points = next(search)
            while sum(map(len, asked)) < at_most(method, BUDGET):
                asked.append(points.copy())
                answer = batch(rough(points))
                points, before = search.send(answer), points
                if spoil:
                    answer.costs[:] = -1e9
                    before[:] = -1.0
        except StopIteration:
            pass
        search.close()
        return np.concatenate(asked)

    assert np.array_equal(play(False), play(True))


def fingerprint(name: str, seed: int) -> str:
    """The bits of all points that a method requests: on a rough function and on three of the table."""
    method = methods()[name]
    digest = hashlib.sha256(run(method, rough, 3, at_most(method, BUDGET), seed=seed).points.tobytes())
    for function in ("Ackley 10", "Levy 8", "excluded region"):
        f = on_unit_cube(function, seed)
        found = run(method, f, f.dimension, at_most(method, 100), seed=seed, status=f.status)
        digest.update(found.points.tobytes())
    return digest.hexdigest()


def fingerprints(seed: int = 1) -> dict[str, str]:
    return {name: fingerprint(name, seed) for name in methods()}


def test_the_same_seed_gives_the_same_points_in_every_process() -> None:
    here = fingerprints()
    code = "import json; from tests.contract.test_methods import fingerprints; print(json.dumps(fingerprints()))"
    environment = {**os.environ, "PYTHONHASHSEED": "4711", THREADS: "4"}  # here: 1
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True, timeout=120)
    assert json.loads(done.stdout) == here
    random = [name for name, method in methods().items() if method.kind == "random"]
    assert random
    assert all(fingerprint(name, 2) != here[name] for name in random)


@pytest.mark.nightly
@pytest.mark.parametrize("method", [m for m in methods().values() if m.costly], ids=lambda m: m.name)
def test_costly_methods_at_full_budgets(method: Method, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searches, "COSTLY", 10**9)
    for name in FUNCTIONS:
        test_points_are_points_of_the_unit_cube(method, name, 3)
    for budget in (100, 401):
        test_the_budget_is_never_exceeded(method, budget)
    for name in ("half of it fails", "what is best fails", "the middle fails"):
        test_what_failed_is_survived_and_never_the_best(method, name, FAILED)
    test_when_nothing_succeeds_nothing_is_found(method, TIMEOUT)
    assert fingerprint(method.name, 3) == fingerprint(method.name, 3)
