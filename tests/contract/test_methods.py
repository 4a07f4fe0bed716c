"""Every search method: inside the box, within its budget, reproducible from its seed, for any outcomes."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest

from campaigns.results.base import EXCLUDED, FAILED, TIMEOUT
from clearance.testing import methods as contract
from clearance.testing import searching
from clearance.testing.searching import BUDGET, FUNCTIONS, at_most, rough, run
from tests.contract.searches import EACH, with_each
from tests.given.at_night import nightly_but
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Method
from worker.engine.systems.simulators.slots.given import THREADS
from worker.running.catalogue.installed import methods


@pytest.fixture(autouse=True)
def no_thread_stays() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    assert set(threading.enumerate()) <= before


@pytest.mark.by_day(30)
@pytest.mark.parametrize(("method", "name", "dimension"), with_each(FUNCTIONS, (1, 2, 8), share=2))
def test_points_are_points_of_the_unit_cube(method: Method, name: str, dimension: int) -> None:
    contract.points_are_points_of_the_unit_cube(method, name, dimension)


@EACH
@pytest.mark.parametrize("budget", nightly_but((1, 7, 100), [1, 2, 7, 100, 401]))
def test_the_budget_is_never_exceeded(method: Method, budget: int) -> None:
    contract.the_budget_is_never_exceeded(method, budget)


@pytest.mark.by_day(17)
@pytest.mark.parametrize(
    ("method", "name", "status"),
    with_each(("half of it fails", "what is best fails", "the middle fails"), (FAILED, TIMEOUT, EXCLUDED)),
)
def test_what_failed_is_survived_and_never_the_best(method: Method, name: str, status: int) -> None:
    contract.what_failed_is_survived_and_never_the_best(method, name, status)


@EACH
@pytest.mark.parametrize("status", [FAILED, TIMEOUT, EXCLUDED])
def test_when_nothing_succeeds_nothing_is_found(method: Method, status: int) -> None:
    contract.when_nothing_succeeds_nothing_is_found(method, status)


@EACH
@pytest.mark.parametrize("after", [0, 1, 2, 3, 10])
def test_it_can_be_abandoned_at_any_moment(method: Method, after: int) -> None:
    contract.it_can_be_abandoned_at_any_moment(method, after)


@EACH
def test_it_is_not_begun_before_it_is_asked(method: Method) -> None:
    contract.it_is_not_begun_before_it_is_asked(method)


@EACH
def test_answers_may_be_changed_after_they_were_given(method: Method) -> None:
    contract.answers_may_be_changed_after_they_were_given(method)


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


@pytest.mark.nightly
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
    monkeypatch.setattr(searching, "COSTLY", 10**9)
    for name in FUNCTIONS:
        test_points_are_points_of_the_unit_cube(method, name, 3)
    for budget in (100, 401):
        test_the_budget_is_never_exceeded(method, budget)
    for name in ("half of it fails", "what is best fails", "the middle fails"):
        test_what_failed_is_survived_and_never_the_best(method, name, FAILED)
    test_when_nothing_succeeds_nothing_is_found(method, TIMEOUT)
    assert fingerprint(method.name, 3) == fingerprint(method.name, 3)
