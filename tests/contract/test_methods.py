"""Every search method: inside the box, within its budget, the same from the same seed, whatever the evaluations do."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from campaigns import check
from tests.unit.cases import campaign, case1, searching
from tests.unit.searching import Function, batch, run, space
from worker.catalog import catalogue, methods, source_of
from worker.search.base import EXCLUDED, FAILED, OK, TIMEOUT, Batch, Floats, Method, Search
from worker.stages.base import Context, Driven, drive
from worker.store import MemoryStore, StagePlan

EACH = pytest.mark.parametrize("method", methods().values(), ids=lambda m: m.name)
BUDGET = 400


@pytest.fixture(autouse=True)
def no_thread_stays() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    assert set(threading.enumerate()) <= before


def smooth(x: Floats) -> Floats:
    return np.asarray(((x - 0.3) ** 2).sum(axis=1))


def rough(x: Floats) -> Floats:
    return np.asarray((np.abs(x - 0.7)).sum(axis=1) + 0.3 * np.cos(40 * x).prod(axis=1))


def flat(x: Floats) -> Floats:
    return np.zeros(len(x))


def steps(x: Floats) -> Floats:
    return np.asarray(np.floor(4 * x).sum(axis=1))


def huge(x: Floats) -> Floats:
    return np.asarray(1e11 * (x - 0.5).sum(axis=1))


def failing(where: Callable[[Floats], Any]) -> Function:
    return lambda x: np.where(where(x), np.nan, smooth(x))


FUNCTIONS: dict[str, Function] = {
    "smooth": smooth, "rough": rough, "flat": flat, "steps": steps, "huge": huge,
    "half of it fails": failing(lambda x: x[:, 0] > 0.5),
    "what is best fails": failing(lambda x: np.abs(x - 0.3).max(axis=1) < 0.2),
    "the middle fails": failing(lambda x: np.abs(x - 0.5).max(axis=1) < 0.2),
    "some fail here and there": failing(lambda x: np.sin(1e4 * x[:, 0]) > 0.5),
    "everything fails": failing(lambda x: np.ones(len(x), dtype=bool)),
}  # fmt: skip


@EACH
@pytest.mark.parametrize("dimension", [1, 2, 8])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_points_are_points_of_the_unit_cube(method: Method, name: str, dimension: int) -> None:
    found = run(method, FUNCTIONS[name], dimension, BUDGET)
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


def driven(method: Method, evaluate: Callable[[Floats], tuple[Batch, dict[int, str]]], budget: int) -> Driven:
    """The method under the real driver."""
    store = MemoryStore()
    store.plan([StagePlan("search", method.name, budget)])
    context = Context(campaign(), case1(), evaluate, store)
    return drive(context, 0, method.search(space(2, budget), method.options()), budget, method.repeats)


def answering(function: Function, status: int) -> Callable[[Floats], tuple[Batch, dict[int, str]]]:
    return lambda points: (batch(function(points), status), {})


@EACH
@pytest.mark.parametrize("budget", [1, 2, 7, 100, 401])
def test_the_budget_is_never_exceeded(method: Method, budget: int) -> None:
    asked: list[int] = []

    def evaluate(points: Floats) -> tuple[Batch, dict[int, str]]:
        asked.append(len(points))
        return batch(rough(points)), {}

    found = driven(method, evaluate, budget)
    assert sum(asked) == found.tally.evaluations <= budget
    assert found.stop == "rule" or found.tally.evaluations == budget


@EACH
@pytest.mark.parametrize("status", [FAILED, TIMEOUT, EXCLUDED])
@pytest.mark.parametrize("name", ["half of it fails", "what is best fails", "the middle fails"])
def test_what_failed_is_survived_and_never_the_best(method: Method, name: str, status: int) -> None:
    found = driven(method, answering(FUNCTIONS[name], status), 600)
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
    found = driven(method, answering(FUNCTIONS["everything fails"], status), 200)
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
            while sum(map(len, asked)) < BUDGET:
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
    """The bits of all points that a method asks for."""
    found = run(methods()[name], rough, 3, 600, seed=seed)
    return hashlib.sha256(found.points.tobytes()).hexdigest()


def test_the_same_seed_gives_the_same_points_in_every_process() -> None:
    here = {name: [fingerprint(name, seed) for seed in (1, 2)] for name in methods()}
    code = (
        "import json; from worker.catalog import methods; from tests.contract.test_methods import fingerprint; "
        "print(json.dumps({name: [fingerprint(name, seed) for seed in (1, 2)] for name in methods()}))"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "4711", "OMP_NUM_THREADS": "1"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True, timeout=120)
    assert json.loads(done.stdout) == here
    random = [name for name, method in methods().items() if method.kind == "random"]
    assert random
    assert all(here[name][0] != here[name][1] for name in random)


@EACH
def test_it_is_documented(method: Method) -> None:
    described = catalogue().method(method.name)
    assert described is not None
    assert described.text == (source_of(method).__doc__ or "").strip()
    assert len(described.text.splitlines()) >= 2
    assert described.kind in ("global", "local", "random", "multi")
    assert described.title
    assert described.source[-4:].isdigit() or described.source.rpartition("as ")[0][:-2][-4:].isdigit()
    assert described.how
    assert 1 <= described.evaluations <= 10**6
    assert method.options.__doc__
    assert source_of(method).__name__.rpartition(".")[2] == method.name


@EACH
def test_its_options_are_described(method: Method) -> None:
    described = catalogue().method(method.name)
    assert described is not None
    properties = described.options.get("properties", {})
    defaults = method.options()
    assert set(properties) == {f.name for f in fields(method.options)}
    for name, rule in properties.items():
        assert rule["default"] == getattr(defaults, name)
        assert "type" in rule or "enum" in rule or "anyOf" in rule
        assert rule.get("description") or rule.get("enum"), f"{name}: what is it?"


@EACH
def test_its_options_pass_the_check_and_come_back(method: Method) -> None:
    known = TypeAdapter(method.options)
    defaults = known.dump_python(method.options())
    asked = searching({"method": method.name, "evaluations": 10, "options": defaults})
    assert check(asked, catalogue()) == []
    assert known.validate_python(asked.stages.search[0].options) == method.options()


@EACH
def test_whatever_the_check_lets_pass_the_method_takes(method: Method) -> None:
    described = catalogue().method(method.name)
    assert described is not None
    values: list[Any] = [None, True, "", "central", [], [1], -1, 0, 0.5, 1, 1.5, 2, 1e-5, 1e-300, 10**9]
    known = TypeAdapter(method.options)
    for name in described.options.get("properties", {}):
        for value in values:
            asked = searching({"method": method.name, "evaluations": 10, "options": {name: value}})
            if check(asked, catalogue()):
                continue
            try:
                made = known.validate_python(asked.stages.search[0].options)
            except ValidationError as error:
                pytest.fail(f"{name} = {value!r} passes the check and not the method: {error}")
            assert getattr(made, name) == value


@EACH
def test_any_option_that_passes_searches(method: Method) -> None:
    described = catalogue().method(method.name)
    assert described is not None
    for name, rule in described.options.get("properties", {}).items():
        limits = [rule.get(word) for word in ("minimum", "maximum")]
        for value in [v for v in limits if v is not None] + rule.get("enum", []):
            if isinstance(value, int | float) and value > 5000:
                continue
            found = run(method, rough, 2, 100, options={name: value})
            assert len(found.batches) > 0, f"{name} = {value}"
