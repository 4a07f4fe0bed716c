"""A simulator that declares its step: a campaign does not see it, and cases are confirmed at half of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from campaigns.codes import CheckCode
from tests.simulators.adversaries import adversary
from tests.simulators.noisy import campaign, ran
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import BadDescriptor, read
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.running.catalogue import installed

PROGRAM = """import json, sys
for line in sys.stdin:
    p = json.loads(line)["parameters"]
    print(json.dumps({"results": {"d": 10 - 3 * p["a"] - float(sys.argv[1]) * p["dt"]}}), flush=True)
"""


def described(folder: Path, slope: float = 1.0, **changes: Any) -> Path:
    (folder / "program.py").write_text(PROGRAM, encoding="utf-8")
    document = {
        "name": "stepped",
        "command": [sys.executable, "{folder}/program.py", str(slope)],
        "parameters": {
            "a": {"nominal": 0.5, "low": 0, "high": 1},
            "dt": {"unit": "s", "nominal": 0.01, "low": 0.001, "high": 0.1},
        },
        "results": {"d": {"unit": "m"}},
        "step": "dt",
        "slots": 1,
    }
    (folder / "simulator.yaml").write_text(yaml.safe_dump(document | changes), encoding="utf-8")
    return folder


def test_the_step_is_passed_and_halved_but_not_offered(tmp_path: Path) -> None:
    known = read(described(tmp_path))
    assert [p.name for p in known.entry.parameters] == ["a"]
    assert known.entry.step == "dt"
    simulator = CommandSimulator(known, Opening({"simulator.a": 0.5}, "d"))
    try:
        batch, _ = simulator.evaluate(np.array([[0.5]]))
        (case,) = simulator.confirm(np.array([[0.5]]), [None])
    finally:
        simulator.close()
    assert batch.costs[0, 0] == 8.5 - 0.01
    half, again = case.comparisons
    assert (half.kind, half.step, half.cost) == ("half_step", 0.005, 8.5 - 0.005)
    assert (again.kind, again.cost, case.step) == ("again", batch.costs[0, 0], 0.01)


@pytest.mark.parametrize(
    ("changes", "statement"),
    [
        ({"step": "h"}, "step: h is not one of its parameters (a, dt)"),
        ({"step": "a"}, "step: half of a"),
        ({"parameters": {"dt": {"nominal": 0.01, "low": 0.001, "high": 1}}}, "step: dt is the only parameter"),
    ],
)
def test_a_step_that_cannot_be_halved_is_refused(tmp_path: Path, changes: dict[str, Any], statement: str) -> None:
    if changes == {"step": "a"}:
        changes["parameters"] = {"a": {"nominal": 0.5, "low": 0.4, "high": 1}, "b": {"nominal": 0, "low": 0, "high": 1}}
    with pytest.raises(BadDescriptor) as refused:
        read(described(tmp_path, **changes))
    assert statement in str(refused.value)


@pytest.mark.parametrize(("by", "word"), [(1e-4, "cleared"), (0.5, "inconclusive")])
def test_half_the_step_is_judged_by_the_tolerance(by: float, word: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with adversary("none") as made:

        class Halved(made):  # type: ignore[misc, valid-type]
            def evaluate(self, *given: Any) -> Any:
                batch, reasons = super().evaluate(*given)
                return batch._replace(costs=batch.costs + by), reasons

        monkeypatch.setattr(made, "step", 0.01)
        monkeypatch.setattr(made, "halved", lambda self: Halved(self.entry, self.opening))
        entry = installed.simulators()["adversary"].entry.model_copy(update={"step": "dt"})
        opened = installed.simulators()["adversary"].open  # type: ignore[union-attr]
        installed.simulators()["adversary"] = type(installed.simulators()["adversary"])(entry, opened)  # type: ignore[call-arg]
        installed.catalogue.cache_clear()
        verdict, store = ran(campaign())
    assert verdict.verdict == word, verdict.reason
    validation = store.findings[0].validation
    assert validation is not None
    assert validation.half_step is not None
    assert validation.half_step.difference == pytest.approx(by)
    assert [one.ok for one in verdict.checks if one.code == CheckCode.REPETITION] == [word == "cleared"]
