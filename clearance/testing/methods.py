"""The contract of a search method: inside the box, within its budget, reproducible, for any outcomes.

`class TestMine(MethodContract): method = mine.method` in a test file of a package runs all of it with pytest; without
pytest, every function here is a check of its own, which raises AssertionError. Start reading at `MethodContract`.
"""

from __future__ import annotations

import inspect
import threading
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from types import ModuleType
from typing import Any, ClassVar

import numpy as np
from pydantic import TypeAdapter, ValidationError

from campaigns import Campaign, Catalogue, check, library, load_file
from campaigns.asked.load import load_document
from campaigns.catalogue import MethodEntry
from campaigns.checked.expected import expected
from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from clearance.testing.searching import (
    BUDGET,
    FUNCTIONS,
    Answer,
    answering,
    at_most,
    batch,
    driven,
    plain,
    rough,
    run,
    smooth,
    space,
)
from worker.engine.search.base import Floats, Method
from worker.running.catalogue.entries import method_entry
from worker.running.catalogue.installed import catalogue

STATUSES = (FAILED, TIMEOUT, EXCLUDED)
MANY = 40
"""Parameters of a large campaign."""
PARTLY = ("half of it fails", "what is best fails", "the middle fails")


class MethodContract:
    """Every check of one method."""

    method: ClassVar[Method]

    def test_it_is_documented(self) -> None:
        it_is_documented(self.method)

    def test_its_options_are_described_checked_and_taken(self) -> None:
        its_options_are_described(self.method)
        its_options_pass_the_check_and_come_back(self.method)
        whatever_the_check_lets_pass_the_method_takes(self.method)

    def test_any_option_that_passes_searches(self) -> None:
        any_option_that_passes_searches(self.method)

    def test_points_are_points_of_the_unit_cube(self) -> None:
        for name in FUNCTIONS:
            for dimension in (1, 2, 8):
                points_are_points_of_the_unit_cube(self.method, name, dimension)

    def test_the_budget_is_never_exceeded(self) -> None:
        for budget in (1, 2, 7, 100, 401):
            the_budget_is_never_exceeded(self.method, budget)

    def test_what_failed_is_survived_and_never_the_best(self) -> None:
        for name in PARTLY:
            for status in STATUSES:
                what_failed_is_survived_and_never_the_best(self.method, name, status)
        for status in STATUSES:
            when_nothing_succeeds_nothing_is_found(self.method, status)

    def test_it_can_be_abandoned_at_any_moment(self) -> None:
        it_is_not_begun_before_it_is_asked(self.method)
        for after in (0, 1, 2, 3, 10):
            it_can_be_abandoned_at_any_moment(self.method, after)

    def test_answers_may_be_changed_after_they_were_given(self) -> None:
        answers_may_be_changed_after_they_were_given(self.method)

    def test_the_same_seed_gives_the_same_points(self) -> None:
        the_same_seed_gives_the_same_points(self.method)


def points_are_points_of_the_unit_cube(method: Method, name: str, dimension: int) -> None:
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


def the_budget_is_never_exceeded(method: Method, budget: int) -> None:
    sizes: list[int] = []

    def evaluate(points: Floats) -> Answer:
        sizes.append(len(points))
        return batch(rough(points)), {}

    budget = at_most(method, budget)
    found = driven(method, evaluate, budget)
    assert sum(sizes) == found.tally.evaluations <= budget
    assert found.stop == "rule" or found.tally.evaluations == budget


def what_failed_is_survived_and_never_the_best(method: Method, name: str, status: int) -> None:
    found = driven(method, answering(FUNCTIONS[name], status), at_most(method, 600))
    tally = found.tally
    assert tally.best_point is not None
    assert tally.best is not None
    assert found.columns is not None
    assert tally.best == smooth(tally.best_point[None, :])[0] == found.columns.costs[found.columns.status == OK].min()
    assert FUNCTIONS[name](tally.best_point[None, :])[0] == tally.best
    counted = int((found.columns.status == status).sum())
    assert (tally.excluded if status == EXCLUDED else tally.failed) == counted


def when_nothing_succeeds_nothing_is_found(method: Method, status: int) -> None:
    found = driven(method, answering(FUNCTIONS["everything fails"], status), at_most(method, 200))
    assert (found.tally.best, found.tally.best_point) == (None, None)
    assert found.tally.evaluations <= 200


def it_can_be_abandoned_at_any_moment(method: Method, after: int) -> None:
    before = threading.active_count()
    search = plain(method.search(space(3, 10**6), method.options()))
    try:
        points = next(search) if after else None
        for _ in range(after - 1):
            assert points is not None
            points = search.send(batch(rough(points)))
    except StopIteration:
        pass
    search.close()
    assert threading.active_count() == before


def it_is_not_begun_before_it_is_asked(method: Method) -> None:
    before = threading.active_count()
    method.search(space(3, 100), method.options())
    assert threading.active_count() == before


def answers_may_be_changed_after_they_were_given(method: Method) -> None:
    def play(spoil: bool) -> Floats:
        search = plain(method.search(space(2, BUDGET), method.options()))
        batches: list[Floats] = []
        try:
            points = next(search)
            while sum(map(len, batches)) < at_most(method, BUDGET):
                batches.append(points.copy())
                answer = batch(rough(points))
                points, before = search.send(answer), points
                if spoil:
                    answer.costs[:] = -1e9
                    before[:] = -1.0
        except StopIteration:
            pass
        search.close()
        return np.concatenate(batches)

    assert np.array_equal(play(False), play(True))


def it_is_documented(method: Method) -> None:
    described = _entry(method)
    assert described.text == (_module(method).__doc__ or "").strip()
    assert len(described.text.splitlines()) >= 2
    assert described.kind in ("global", "local", "random", "multi")
    assert described.title
    assert described.source[-4:].isdigit() or described.source.rpartition("as ")[0][:-2][-4:].isdigit()
    assert described.how
    assert 1 <= described.evaluations <= 10**6
    assert method.options.__doc__
    assert _module(method).__name__.rpartition(".")[2] == method.name


def its_options_are_described(method: Method) -> None:
    described = _entry(method)
    properties = described.options.get("properties", {})
    defaults = method.options()
    assert set(properties) == {f.name for f in fields(method.options)}
    for name, rule in properties.items():
        assert rule["default"] == getattr(defaults, name)
        assert "type" in rule or "enum" in rule or "anyOf" in rule
        assert rule.get("description") or rule.get("enum"), f"{name}: what is it?"
    if method.kind == "random":
        sample = method.sampling(defaults, 1000, 0.95)
        assert (sample.barred, sample.level) == ("", None), "the bound that its points give is stated before a run"


def its_options_pass_the_check_and_come_back(method: Method) -> None:
    known: TypeAdapter[Any] = TypeAdapter(method.options)
    defaults = known.dump_python(method.options())
    campaign = _searching({"method": method.name, "evaluations": 10, "options": defaults})
    assert check(campaign, _catalogue(method)) == []
    assert known.validate_python(campaign.stages.search[0].options) == method.options()


def whatever_the_check_lets_pass_the_method_takes(method: Method) -> None:
    described = _entry(method)
    values: list[Any] = [None, True, "", "central", [], [1], -1, 0, 0.5, 1, 1.5, 2, 1e-5, 1e-300, 10**9]
    known: TypeAdapter[Any] = TypeAdapter(method.options)
    described_here = _catalogue(method)
    for name in described.options.get("properties", {}):
        for value in values:
            campaign = _searching({"method": method.name, "evaluations": 10, "options": {name: value}})
            if check(campaign, described_here):
                continue
            try:
                made = known.validate_python(campaign.stages.search[0].options)
            except ValidationError as error:
                raise AssertionError(f"{name} = {value!r} passes the check and not the method: {error}") from None
            assert getattr(made, name) == value


def any_option_that_passes_searches(method: Method) -> None:
    for name, value in _at_their_limits(method):
        limit = method.most_parameters.get(name, {}).get(str(value), MANY)
        for parameters in (2, min(MANY, limit)):
            found = run(method, rough, parameters, at_most(method, 100), options={name: value})
            text = f"{name} = {value} with {parameters} parameters: {found.text}; declare most_parameters"
            assert len(found.batches) > 0, text


def it_takes_at_least_what_is_announced(method: Method) -> None:
    """The least number of evaluations that is stated before a run, for the limits of every option."""
    described_here, budget = _catalogue(method), at_most(method, BUDGET)
    for options in [{}, *({name: value} for name, value in _at_their_limits(method))]:
        campaign = _searching({"method": method.name, "evaluations": budget, "options": options})
        if check(campaign, described_here):
            continue
        announced = {stage.kind: stage for stage in expected(campaign, described_here)}["search"]
        for name in ("smooth", "rough"):
            found = run(method, FUNCTIONS[name], len(campaign.uncertain), budget, options=options)
            taken = sum(map(len, found.batches))
            assert announced.least <= taken, f"{options} of a {name} cost: {announced.least} evaluations are announced"


def the_same_seed_gives_the_same_points(method: Method) -> None:
    one, two = (run(method, rough, 3, at_most(method, BUDGET), seed=5).points for _ in range(2))
    assert one.tobytes() == two.tobytes(), "take randomness from space.random alone"


def _at_their_limits(method: Method) -> Iterator[tuple[str, object]]:
    """Each option at each of its limits and values, the others as they are by default."""
    for name, rule in _entry(method).options.get("properties", {}).items():
        limits = [rule[word] for word in ("minimum", "maximum") if word in rule]
        for value in [*limits, *rule.get("enum", ()), *((True, False) if rule.get("type") == "boolean" else ())]:
            if isinstance(value, bool) or not isinstance(value, int | float) or value <= 5000:
                yield name, value


def _module(method: Method) -> ModuleType:
    module = inspect.getmodule(method.search)
    assert module is not None
    return module


def _entry(method: Method) -> MethodEntry:
    """The entry of the catalogue for the method, whose package need not be installed."""
    return method_entry(method, _module(method))


def _catalogue(method: Method) -> Catalogue:
    known = catalogue()
    others = [m for m in known.methods if m.name != method.name]
    return known.model_copy(update={"methods": [*others, _entry(method)]})


@cache
def _document() -> dict[str, Any]:
    return load_file(next(iter(library().values()))).document()


def _searching(search: Mapping[str, object]) -> Campaign:
    return load_document(_document() | {"stages": {"search": [search]}})
