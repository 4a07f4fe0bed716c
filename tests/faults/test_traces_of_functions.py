"""Traces of decorated functions: requested by a keyword, checked as those of programs, declared in advance."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import clearance
from tests.simulators import tracing
from worker.engine.systems.base import NoTrace
from worker.engine.systems.simulators.declared.columns import Column, columns
from worker.engine.systems.simulators.declared.function import Function
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.functions import InProcess, Isolated
from worker.running.catalogue.files import PythonFunction, entry_of, read_file


def opened(function: Function[..., Any]) -> InProcess | Isolated:
    declaration = function.declaration
    entry = entry_of(declaration)
    opening = Opening({f"simulator.{p.name}": p.default or 0.0 for p in entry.parameters}, "value")
    if not declaration.settings.isolated:
        return InProcess(function.call, entry, opening, declaration, "digest")
    place = {"module": tracing.__name__, "name": declaration.name}
    return Isolated(place, entry, opening, declaration, "digest")


@pytest.fixture(scope="module")
def alone() -> Iterator[InProcess | Isolated]:
    found = opened(tracing.wrong_alone)
    yield found
    found.close()


@pytest.mark.parametrize("function", [tracing.thrown, tracing.together], ids=["in a slot", "whole batches"])
def test_a_function_returns_its_trace_when_asked(function: Function[..., Any]) -> None:
    system = opened(function)
    batch, reasons = system.evaluate(np.array([[8.0]]))
    found = system.trace("F1", {"simulator.speed": 8.0})
    nominal = system.trace("nominal", {})
    system.close()
    assert reasons == {}
    assert found is not None
    assert nominal is not None
    assert found.meta.cost == batch.costs[0, 0]
    assert found.meta.parameters == {"simulator.speed": 8.0}
    assert nominal.meta.parameters == {"simulator.speed": 5.0}
    assert found.data[:, 0].tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert found.data[:, 1].max() == found.meta.cost
    assert [(c.name, c.unit, c.symbol, c.group, c.text) for c in found.columns] == [
        ("time", "s", "time", "time", ""),
        ("height", "m", "h", "signal", "Above ground"),
    ]


@pytest.mark.parametrize("act", range(len(tracing.ACTS)))
def test_whatever_a_function_returns_is_a_trace_or_a_sentence(act: int, alone: Isolated) -> None:
    for system in (opened(tracing.wrong), alone):
        reason = tracing.ACTS[act][1]
        if not reason:
            assert system.trace("F1", {"simulator.act": float(act)}) is not None
            continue
        with pytest.raises(NoTrace) as refused:
            system.trace("F1", {"simulator.act": float(act)})
        assert reason in str(refused.value) or "cannot be written as JSON" in str(refused.value)
        batch, reasons = system.evaluate(np.array([[float(act)]]))
        assert (batch.costs[0, 0], reasons) == (1.0, {})


def test_a_function_without_columns_is_never_asked() -> None:
    def fly(x: float) -> float:
        return x

    declared = clearance.simulator(parameters={"x": (0.0, 1.0)}, isolated=False)(fly)
    assert opened(declared).trace("nominal", {}) is None


def asking(x: float, trace: bool = False) -> Any:
    return x


def plain(x: float) -> float:
    return x


def demanding(x: float, trace: bool) -> Any:
    return x


def parameter(trace: float) -> float:
    return trace


@pytest.mark.parametrize(
    ("function", "trace", "reason"),
    [
        (plain, tracing.TRACE, "plain declares columns, so it needs the further parameter trace=False"),
        (demanding, tracing.TRACE, "cannot be called as demanding(x=...)"),
        (asking, {}, "the column time and 1 to 63 others are expected, given nothing"),
        (asking, {"height": {}}, "the column time and 1 to 63 others are expected, given height"),
        (asking, {"time": {"unit": "ms"}, "x": {}}, "time is in s, given the unit ms"),
        (asking, {"time": {}, "Height": {}}, "invalid name 'Height'"),
        (asking, {"time": {}, "x": {"units": "m"}}, "x has no 'units'; give unit, text, symbol"),
        (asking, {"time": {}, "x": "m"}, "x must be a dict such as {'unit': 'm'}, given 'm'"),
        (asking, {"time": {}, "x": {"unit": 3}}, "x: unit must be a text, given 3"),
        (asking, ["time", "x"], "trace must be a dict of columns by name"),
        (asking, {"time": {}} | {f"x{k}": {} for k in range(64)}, "1 to 63 others"),
    ],
)
def test_a_declaration_that_cannot_work_is_refused(function: Any, trace: Any, reason: str) -> None:
    with pytest.raises((TypeError, ValueError)) as refused:
        clearance.simulator(parameters={"x": (0.0, 1.0)}, trace=trace)(function)
    assert reason in str(refused.value)


def test_a_parameter_may_not_be_called_trace() -> None:
    with pytest.raises(ValueError, match="rename this parameter"):
        clearance.simulator(parameters={"trace": (0.0, 1.0)}, trace=tracing.TRACE)(parameter)
    assert clearance.simulator(parameters={"trace": (0.0, 1.0)})(parameter)(trace=2.0) == 2.0


def test_columns_travel_from_a_file(tmp_path: Any) -> None:
    source = """
import clearance
@clearance.simulator(parameters={"x": (0, 1)}, trace={"time": {}, "h": clearance.Column("m", "Height")})
def fly(x, trace=False):
    return (x, {"time": [0, 1], "h": [0, x]}) if trace else x
"""
    (tmp_path / "fly.py").write_text(source, encoding="utf-8")
    (found,) = read_file(tmp_path / "fly.py")
    assert isinstance(found, PythonFunction)
    assert found.declaration.trace == columns({"time": {}, "h": Column("m", "Height")})
    json.dumps(found.entry.model_dump())
