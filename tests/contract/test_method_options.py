"""Every search method describes itself, and its options have the effect stated in the catalogue."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import pytest
from pydantic import TypeAdapter, ValidationError

from campaigns import check
from tests.contract.searches import EACH, at_most, rough
from tests.unit.cases import searching
from tests.unit.searching import run
from worker.engine.search.base import Method
from worker.running.catalogue.installed import catalogue, source_of


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
            found = run(method, rough, 2, at_most(method, 100), options={name: value})
            assert len(found.batches) > 0, f"{name} = {value}"
