"""Figures that the guides state of shipped examples and benchmarks are those that they give now."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.bench import bounds
from tests.bench.attraction.__main__ import proved, simulated

pytestmark = pytest.mark.nightly

DOCS = Path(__file__).parents[2] / "docs"


def numbers(pattern: str, guide: str) -> list[float]:
    """Those in the groups of the pattern, whose spaces may be line ends."""
    found = re.search(pattern.replace(" ", r"\s+"), (DOCS / guide).read_text(encoding="utf-8"))
    assert found, f"{guide} does not state {pattern!r}"
    return [float(group.replace(",", "")) for group in found.groups()]


def compared(system: str, found: bounds.Row) -> None:
    """With the row of the table on evaluations that are stated and made."""
    searches, most, made = numbers(rf"\| {system} \| ([\d,]+) \| ([\d,]+) \| ([\d,]+) \|", "methods.md")
    assert found[:2] == (searches, most)
    assert found[2] == pytest.approx(made, rel=0.05), "a sample is drawn with every run"


@pytest.mark.parametrize(
    ("system", "run"),
    [
        ("Python function[^|]*", bounds.function),
        ("command `mass_spring`", lambda: bounds.program("mass_spring")[0]),
        ("[^|]*not repeat", bounds.unrepeatable),
    ],
)
def test_evaluations_of_own_systems(system: str, run: Callable[[], bounds.Row]) -> None:
    compared(system, run())


@pytest.mark.skipif(find_spec("jsbsim") is None, reason="the package jsbsim is not installed")
def test_evaluations_and_worst_case_of_jsbsim() -> None:
    row, store = bounds.program("jsbsim_intruder")
    compared("JSBSim, `jsbsim_intruder`", row)
    pattern = r"is ([\d.]+) m nominally and ([\d.]+) m in the worst case found, below the 60 m"
    nominal = next(case for stage in store.stages if stage.result and (case := stage.result.at_nominal))
    assert [nominal.cost, store.findings[0].cost] == pytest.approx(numbers(pattern, "your-own-simulator.md"), abs=0.051)


def test_the_area_that_is_proved() -> None:
    """Of OpenBLAS's kernels that for Sandy Bridge gives the least, those for Haswell and Zen the most."""
    pattern = r"attraction`\): ([\d.]+) to ([\d.]+) % of the simulated area, ([\d.]+), at degree 6"
    least, most, area = numbers(pattern, "methods.md")
    assert simulated() == pytest.approx(area, abs=1e-3)
    found = proved(6)
    assert found is not None
    assert (least - 0.05) / 100 * area <= found <= (most + 0.05) / 100 * area
