"""Parameters whose bounds are close for their size are read within them, in the terminal and in a notebook, and costs
on their own side of the threshold."""

from __future__ import annotations

import re
from typing import Any

import pytest

import clearance
from clearance.cli._report import print_report
from clearance.local.progress import Progress
from worker.engine.stages.parts.context import Tally

LOW, HIGH = 100000.4, 100000.6


def lowest_at(x: float) -> float:
    return abs(x - 100000.53)


@pytest.fixture(scope="module")
def result() -> clearance.Result:
    return clearance.search(lowest_at, {"x": (LOW, HIGH)}, 0.0, budget=60, seed=3)


def parameters(text: str) -> list[float]:
    return [float(value) for value in re.findall(r"\b100\d{3}(?:\.\d+)?", text)]


def test_in_the_tables_of_python(result: clearance.Result) -> None:
    for text in (str(result), result._repr_html_()):
        stated = parameters(text)
        assert len(stated) >= 2
        assert all(LOW <= value <= HIGH for value in stated)
        assert 100000.5 in stated


def test_in_the_report_of_the_command_line(result: clearance.Result, capsys: pytest.CaptureFixture[str]) -> None:
    store = result.origin.store
    assert store.verdict is not None
    print_report(result.origin.campaign, store, store.verdict, None)
    (row,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("│ simulator.x ")]
    assert len(stated := parameters(row)) >= 2
    assert all(LOW <= value <= HIGH for value in stated)


def test_every_cost_of_the_tables_is_on_its_own_side_of_the_threshold(capsys: pytest.CaptureFixture[str]) -> None:
    """Of stages, methods and their parts, and in the lines of progress."""
    found = clearance.search(lambda x: 1.0 + 1e-9 + x * x, {"x": (0.0, 1.0)}, 1.0, budget=60, seed=3)
    of: Any = found.origin
    print_report(of.campaign, of.store, of.store.verdict, None)
    shown = Progress(of.campaign)
    with shown:
        shown.show(0, Tally(evaluations=1, best=1.0 + 1e-9))
    text = "".join(capsys.readouterr())
    assert "best 1.000000001" in text
    (stages,) = [line for line in text.splitlines() if line.startswith("\u2502 all stages ")]
    assert float(stages.split("\u2502")[2]) > 1.0
    methods = text[text.index("Within 1") : text.index("Parameter")]
    assert all(float(cell) > 1.0 for cell in re.findall(r"^\u2502[^\u2502]+\u2502 +([\d.]+) \u2502", methods, re.M))
