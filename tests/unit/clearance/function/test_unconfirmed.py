"""A case that violates in the search and never again: every place names the violation that is confirmed instead."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path

import pytest

import clearance
from clearance.cli import invoke
from tests.audited import audited


@pytest.fixture(scope="module")
def result() -> clearance.Result:
    seen: set[tuple[float, float]] = set()

    def twice(x: float, y: float) -> float:
        """A well that is there only the first time at a point, and a shallower one that stays."""
        first = 1.5 * max(0.0, 1.0 - ((x - 0.2) ** 2 + (y - 0.2) ** 2) / 0.04)
        stays = 1.3 * max(0.0, 1.0 - ((x - 0.8) ** 2 + (y - 0.7) ** 2) / 0.04)
        if first > 0.4 and (x, y) in seen:
            first = 0.3
        seen.add((x, y))
        return 1.0 - max(first, stays)

    return clearance.search(twice, {"x": (0.0, 1.0), "y": (0.0, 1.0)}, 0.0, budget=2000, seed=3)


def test_the_worst_is_the_one_that_is_confirmed(result: clearance.Result) -> None:
    lowest = result.findings[0]
    assert lowest.parameters["x"] == pytest.approx(0.2, abs=0.05)
    assert result.verdict == "violated"
    assert result.worst is not None
    assert result.worst.parameters["x"] == pytest.approx(0.8, abs=0.05)
    assert result.worst.cost > lowest.cost
    assert f"{result.worst.cost:.6g}" in repr(result)


def test_the_report_has_its_parameters(result: clearance.Result, tmp_path: Path) -> None:
    assert result.worst is not None
    page = result.report(tmp_path / "report.html").read_text(encoding="utf-8")
    row = page.partition("Uncertain parameters")[2].partition("</table>")[0]
    assert all(f">{value:.4g}<" in row for value in result.worst.parameters.values())


def test_a_value_that_is_milder_when_evaluated_again_is_stated_as_in_the_verdict(tmp_path: Path) -> None:
    calls: list[None] = []
    seen: set[tuple[float, float]] = set()

    def milder(a: float, b: float) -> float:
        """It repeats itself in the first calls; a point that comes again later is milder than it was."""
        calls.append(None)
        again = len(calls) > 40 and (a, b) in seen
        seen.add((a, b))
        return 2.0 + (a - 0.3) ** 2 + (b + 0.2) ** 2 + (0.01 if again else 0.0)

    found = clearance.search(milder, {"a": (-1.0, 1.0), "b": (-1.0, 1.0)}, 2.3, unit="m", budget=200, certify=60)
    assert found.worst is not None
    assert found.worst.cost > found.worst.evaluated
    assert found.worst.margin == pytest.approx(found.worst.cost - 2.3)
    assert f"{found.worst.cost:.6g} m" in found.verdict.sentence
    assert f"{found.worst.cost:.6g} (evaluated: {found.worst.evaluated:.6g})" in str(found)
    found.save(tmp_path / "out")
    document = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    first = document["findings"][0]
    assert (first["cost"], first["granted"]) == (found.worst.evaluated, found.worst.cost)
    assert first["margin"] == document["worst"]["margin"] == found.worst.margin == found.findings[0].margin
    assert invoke(["audit", str(tmp_path / "out")]) == 0


@pytest.mark.by_day(1)
@pytest.mark.parametrize("repeats", [True, False])
def test_a_chance_of_a_lower_case_is_stated_only_where_results_repeat(repeats: bool, tmp_path: Path) -> None:
    calls = itertools.count()

    def later(a: float, b: float) -> float:
        """It repeats when that is measured."""
        call = next(calls)
        return 2.0 + (a - 0.3) ** 2 + (b + 0.2) ** 2 + (0.0 if repeats or call < 100 else 1e-4 * (call % 97))

    found = clearance.search(later, {"a": (-1.0, 1.0), "b": (-1.0, 1.0)}, 1.0, budget=300, certify=60)
    page = found.report(tmp_path / "report.html").read_text(encoding="utf-8")
    for text in (" ".join(str(found).split()), found._repr_html_(), page):
        assert ("chance that another" in text) == repeats
    assert (found.verdict.sureness is not None) == repeats


@pytest.mark.by_day(1)
@pytest.mark.parametrize("late", [0, 100])
@pytest.mark.parametrize("fails", [True, False])
def test_the_advice_can_be_followed_for_a_function(fails: bool, late: int, tmp_path: Path) -> None:
    """The cause decides: `search` has neither retries nor calls that are repeated."""
    calls = itertools.count()

    def differs(a: float, b: float) -> float:
        call = next(calls)
        if fails and call > late and call % 10 == 0:
            raise OSError("no licence")
        return 2.0 + a + b + (0.0 if fails or call < late else 1e-4 * (call % 97))

    found = clearance.search(differs, {"a": (-1.0, 1.0), "b": (-1.0, 1.0)}, -1.0, budget=300, certify=60)
    (noise,) = [check.text for check in found.verdict.checks if check.title == "Noise of the simulator"]
    assert ("reasons of the" in noise) == fails
    assert ("that it keeps" in noise) == ("a campaign file" in noise) == (not fails)
    assert "retries" not in noise
    audited(found.save(tmp_path / "saved"))


@pytest.mark.parametrize("side", [1, -1])
def test_no_value_is_read_on_the_other_side_of_its_threshold(side: int) -> None:
    """Rounded to six digits, the worst value and the threshold would be."""
    limit = 0.73912 + side * 1.2e-7

    def beside(a: float, b: float) -> float:
        return limit + side * 4e-8 + 0.3 * ((a - 0.5) ** 2 + (b - 0.5) ** 2)

    found = clearance.search(beside, {"a": (0, 1), "b": (0, 1)}, limit, methods={"direct": 30}, certify=20)
    page = found._repr_html_()
    rows = "".join(line for line in str(found).splitlines() if line.startswith(("nominal ", "F1 ")))
    for text in (repr(found), rows, page[page.index("<table") : page.index("</table>")], page[page.index("╌") :]):
        near = [float(number) for number in re.findall(r"\d\.\d+", text) if abs(float(number) - limit) < 2e-4]
        assert near, text
        assert [number for number in near if (number - limit) * side < 0] == [], text
