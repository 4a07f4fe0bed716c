"""Traces of simulators: requested from a program, checked, stored only where they show the stored evaluation."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from campaigns.results import TraceHead, ValidateResult
from campaigns.results.trace import TraceColumn
from campaigns.stages.nominal import NominalResult
from campaigns.stored.records import Trace
from tests.simulators.adversaries import adversary
from tests.simulators.noisy import REPEATS, campaign, ran
from worker.engine.systems.base import NoTrace
from worker.engine.systems.simulators import traced
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import BadDescriptor, DescribedColumn, read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.running.runs.store import MemoryStore

LINES = """import json, os, sys, time
for line in sys.stdin:
    asked = json.loads(line)
    a = asked["parameters"]["a"]
    answer = {"results": {"d": 2 * a}}
    if asked.get("trace") is True:
        act = sys.argv[1]
        if act == "dies":
            os._exit(3)
        if act == "hangs":
            time.sleep(60)
        if act == "error":
            answer = {"error": "no trace today"}
        elif act == "too long":
            answer["trace"] = {"time": "y" * 17_000_000}
        elif act != "ignores":
            answer["trace"] = {"time": [0, 1], "x": [a, 2 * a]}
    print(json.dumps(answer), flush=True)
"""
FILES = """import json, sys
given, results, trace = sys.argv[1:]
a = json.load(open(given))["a"]
json.dump({"d": 2 * a}, open(results, "w"))
json.dump({"time": [0, 1], "x": [a, 2 * a]}, open(trace, "w"))
"""
COLUMNS = {"time": {"unit": "s"}, "x": {"unit": "m", "symbol": "x_1", "text": "Distance"}}
CONSTANT = {"name": "traced", "results": {"d": {"unit": "m"}}, "slots": 1, "timeout": 5}


def folder(place: Path, program: str, *arguments: str, **changes: Any) -> Path:
    (place / "program.py").write_text(program, encoding="utf-8")
    document = CONSTANT | {
        "command": [sys.executable, "{folder}/program.py", *arguments],
        "parameters": {"a": {"nominal": 0.5, "low": 0, "high": 1}},
        "trace": COLUMNS,
    }
    (place / "simulator.yaml").write_text(yaml.safe_dump(document | changes), encoding="utf-8")
    return place


@contextmanager
def opened(place: Path) -> Iterator[CommandSimulator]:
    simulator = CommandSimulator(read(place), Opening({"simulator.a": 0.5}, "d"))
    try:
        yield simulator
    finally:
        simulator.close()


@pytest.mark.parametrize("protocol", ["lines", "files"])
def test_a_program_returns_a_trace_on_request_alone(tmp_path: Path, protocol: str) -> None:
    files = ["{parameters}", "{results}", "{trace}"]
    given = (LINES, "right") if protocol == "lines" else (FILES, *files)
    with opened(folder(tmp_path, *given, protocol=protocol)) as simulator:
        batch, reasons = simulator.evaluate(np.array([[0.25]]))
        found = simulator.trace("F1", {"simulator.a": 0.25})
        nominal = simulator.trace("nominal", {})
        after, _ = simulator.evaluate(np.array([[0.25]]))
    assert reasons == {}
    assert found is not None
    assert found.data.tolist() == [[0.0, 0.25], [1.0, 0.5]]
    assert [(c.name, c.symbol, c.unit, c.group, c.text) for c in found.columns] == [
        ("time", "time", "s", "time", ""),
        ("x", "x_1", "m", "signal", "Distance"),
    ]
    assert (found.name, found.meta.cost, found.meta.parameters) == ("F1", 0.5, {"simulator.a": 0.25})
    assert nominal is not None
    assert nominal.data[:, 1].tolist() == [0.5, 1.0]
    assert batch.costs.tobytes() == after.costs.tobytes()


@pytest.mark.parametrize(
    ("act", "reason"),
    [
        ("ignores", "its answer has no object `trace`, in which time, x are expected"),
        ("dies", "its process ended with exit code 3"),
        ("hangs", "no answer within 3 s"),
        ("error", "no trace today"),
        ("too long", "its answer is longer than 16000000 bytes"),
    ],
)
def test_a_trace_that_fails_costs_no_evaluation(tmp_path: Path, act: str, reason: str) -> None:
    with opened(folder(tmp_path, LINES, act, timeout=3 if act == "hangs" else 30)) as simulator:
        with pytest.raises(NoTrace) as refused:
            simulator.trace("nominal", {})
        batch, reasons = simulator.evaluate(np.array([[0.25]]))
    assert reason in str(refused.value)
    assert (batch.costs[0, 0], reasons) == (0.5, {})


def test_without_a_declared_trace_none_is_requested(tmp_path: Path) -> None:
    with opened(folder(tmp_path, LINES, "dies", trace={})) as simulator:
        assert simulator.trace("nominal", {}) is None


BIG = 10**400
WRONG: dict[str, tuple[Any, str]] = {
    "no object": ([1, 2], "no object `trace`"),
    "a column is missing": ({"time": [0, 1]}, "its trace lacks x; it has time"),
    "not a list": ({"time": [0, 1], "x": 3}, "the column x of its trace is 3, not a list"),
    "a text": ({"time": [0, 1], "x": "ab"}, "not a list of numbers"),
    "lengths": ({"time": [0, 1], "x": [1]}, "x of its trace has 1 rows and time has 2"),
    "one row": ({"time": [0], "x": [1]}, "its trace has 1 rows; 2 to 100000 are expected"),
    "too many rows": ({"time": [0] * 100_001, "x": [0] * 100_001}, "100001 rows"),
    "NaN": ({"time": [0, 1], "x": [1, float("nan")]}, "x of its trace is nan in row 2; a finite number or null"),
    "infinite": ({"time": [0, 1], "x": [float("-inf"), 1]}, "is -inf in row 1"),
    "beyond a double": ({"time": [0, 1], "x": [BIG, 1]}, "is inf in row 1"),
    "words": ({"time": [0, 1], "x": ["1", 2]}, "x of its trace is '1' in row 1, not a number or null"),
    "true": ({"time": [0, 1], "x": [True, 2]}, "is True in row 1"),
    "nested": ({"time": [0, 1], "x": [[1], [2]]}, "is [1] in row 1"),
    "time is null": ({"time": [0, None], "x": [1, 2]}, "time of its trace is None in row 2, not a number"),
    "time goes back": ({"time": [0, 2, 1], "x": [1, 2, 3]}, "goes back from 2 s to 1 s after row 2"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_trace_is_a_sentence(case: str) -> None:
    given, reason = WRONG[case]
    columns = {name: DescribedColumn.model_validate(c) for name, c in COLUMNS.items()}
    with pytest.raises(NoTrace) as refused:
        traced.read("nominal", columns, {"trace": given}, TraceHead())
    assert reason in str(refused.value)


def test_null_and_further_columns_are_permitted() -> None:
    columns = {name: DescribedColumn.model_validate(c) for name, c in COLUMNS.items()}
    found = traced.read("nominal", columns, {"trace": {"time": [0, 1], "x": [None, 2], "y": "?"}}, TraceHead())
    assert np.isnan(found.data[0, 1])
    assert found.data.shape == (2, 2)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"trace": {"x": {}}}, "trace: the column time and at least one other are expected, given x"),
        ({"trace": {"time": {}}}, "trace: the column time and at least one other"),
        ({"trace": {"time": {"unit": "ms"}, "x": {}}}, "trace: time is in s, given the unit ms"),
        ({"protocol": "files"}, "command: {trace}, the file for the trace, is missing"),
        ({"command": ["p", "{trace}"]}, "command: {trace} is only for the protocol files"),
        ({"command": ["p", "{trace}"], "protocol": "files", "trace": {}}, "declare its columns under the key trace"),
        ({"trace": {"time": {}, "x": {}, "position": ["x", "y", "z"]}}, "trace.position"),
    ],
)
def test_a_declaration_that_cannot_be_used_is_refused(tmp_path: Path, changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(BadDescriptor) as refused:
        read(folder(tmp_path, LINES, **changes))
    assert reason in str(refused.value)


def execution(monkeypatch: pytest.MonkeyPatch, kind: str = "none", by: float = 0.0, **simulator: Any) -> MemoryStore:
    """A run of an adversary that gives traces, whose own evaluations differ by `by`."""
    with adversary(kind) as made:

        def trace(self: Any, name: str, values: Mapping[str, float], seed: int | None = None) -> Trace:
            if by > 1:
                raise NoTrace("no trace today")
            vector = np.array([values.get(p.path, p.nominal) for p in self.parameters])
            batch, _ = self.evaluate(vector[None])
            head = TraceHead(parameters=dict(values), cost=float(batch.costs[0, 0]) + by)
            column = TraceColumn(name="time", symbol="t", unit="s", group="time")
            return Trace(name, [column], np.array([[0.0], [1.0]]), head)

        monkeypatch.setattr(made, "trace", trace)
        return ran(campaign(**simulator))[1]


def untraced(store: MemoryStore) -> dict[str, str]:
    found = [stage.result for stage in store.stages]
    assert isinstance(found[0], NominalResult)
    assert isinstance(found[-1], ValidateResult)
    assert "untraced" not in found[0].model_dump() or found[0].untraced
    return found[0].untraced | found[-1].untraced


def test_the_nominal_case_and_every_finding_have_traces(monkeypatch: pytest.MonkeyPatch) -> None:
    store = execution(monkeypatch)
    assert sorted(store.traces) == sorted(["nominal", *(f.label for f in store.findings)])
    assert untraced(store) == {}
    for finding in store.findings:
        assert store.traces[finding.label].meta.cost == finding.cost
        assert finding.closest is None


@pytest.mark.parametrize(("by", "reason"), [(1e-12, "the stored cost"), (2.0, "no trace today")])
def test_one_that_shows_something_else_is_not_stored(monkeypatch: pytest.MonkeyPatch, by: float, reason: str) -> None:
    store = execution(monkeypatch, by=by)
    assert store.traces == {}
    assert sorted(untraced(store)) == sorted(["nominal", *(f.label for f in store.findings)])
    assert all(reason in why for why in untraced(store).values())
    json.dumps([stage.result.model_dump(mode="json") for stage in store.stages if stage.result], allow_nan=False)


def test_with_repeats_a_trace_shows_one_more_call(monkeypatch: pytest.MonkeyPatch) -> None:
    store = execution(monkeypatch, by=1e-3, **REPEATS)
    assert "nominal" in store.traces
    assert untraced(store) == {}
