"""Parameters whose bounds are close for their size are read within them, in the terminal and in a notebook."""

from __future__ import annotations

import re

import pytest

import clearance
from clearance.cli._report import print_report

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
