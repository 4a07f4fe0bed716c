"""A violation that a clear case separates from every known one is new, however small a part of nominal minus worst the
barrier between them is; two of one violating region are one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from campaigns.results.regression import Standing
from clearance.cli import VIOLATED, invoke
from tests.given.at_night import nightly_but, rows_nightly_but
from tests.given.corrupted_records import Folder
from worker.engine.stages.parts import between
from worker.running.catalogue import installed

SIMULATOR = '''
import clearance

@clearance.simulator(
    parameters={
        "x": clearance.Parameter(0.0, 1.0, nominal=0.0),
        "y": clearance.Parameter(0.0, 1.0, nominal=1.0),
        "slope": clearance.Parameter(0.0, 1000.0, nominal=200.0),
        "first": clearance.Parameter(-1.0, 1.0, nominal=-0.2),
        "second": clearance.Parameter(-1.0, 1.0, nominal=0.3),
        "ridge": clearance.Parameter(0.0, 100.0, nominal=10.0),
    },
    results={"s": clearance.Output(unit="m", worse="low")}, isolated=False,
)
def two_regions(x, y, slope, first, second, ridge):
    """Two wells with a ridge between them, and a nominal case far above."""
    one = first + ridge * ((x - 0.2) ** 2 + (y - 0.2) ** 2)
    other = second + ridge * ((x - 0.8) ** 2 + (y - 0.8) ** 2)
    return min(one, other) + slope * max(0.0, y - x - 0.6)
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "sims").mkdir()
    (tmp_path / "sims" / "two_regions.py").write_text(SIMULATOR, encoding="utf-8")
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(tmp_path / "sims"))
    monkeypatch.chdir(tmp_path)
    installed.forget_simulators()
    yield tmp_path
    installed.forget_simulators()


def ran(folder: Path, out: str, *words: str, barrier: float = 0.05, **values: float) -> int:
    stages: dict[str, Any] = {
        "search": [{"method": "direct", "evaluations": 300}, {"method": "mlsl", "evaluations": 300}],
        "validate": {"evaluations": 6000, "neighbours": 50},
        "certify": {"samples": 59},
        "findings": {"barrier": barrier},
    }
    campaign = {
        "name": "two",
        "simulator": {"name": "two_regions", "parameters": values},
        "uncertain": {f"simulator.{name}": {"low": 0.0, "high": 1.0} for name in "xy"},
        "criterion": {"result": "s", "threshold": 0.0},
        "regression": {"fail_on": ["new_violation", "new", "worse", "not_compared"]},
        "stages": stages,
    }
    (folder / f"{out}.json").write_text(json.dumps(campaign), encoding="utf-8")
    return invoke(["run", f"{out}.json", "--out", out, "--threads", "1", *words])


def changes(folder: Path, out: str) -> dict[tuple[str | None, str | None], Any]:
    """The changes by both labels, that of the baseline and the one here."""
    compared = Folder(folder / out).result["regression"]
    return {(case["before"], case["now"]): case for case in compared["cases"]}


RIDGES = list(product((-0.2, 0.3), ((0.05, 200.0), (1.0, 200.0), (0.3, 20.0), (0.05, 1000.0))))


# By day a region that violated and one that did not, each with the barrier that hides the ridge most and least.
@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("first", "given"), rows_nightly_but([(-0.2, (1.0, 200.0)), (-0.2, (0.3, 20.0)), (0.3, (0.05, 1000.0))], RIDGES)
)
def test_a_violation_beyond_a_clear_ridge_is_new(first: float, given: tuple[float, float], folder: Path) -> None:
    barrier, slope = given
    assert ran(folder, "old", barrier=barrier, slope=slope) == VIOLATED
    fails = ran(folder, "new", "--baseline", "old", barrier=barrier, slope=slope, first=first, second=-0.4)
    assert fails == VIOLATED
    found = changes(folder, "new")
    new, before = found[None, "F1"], next(case for labels, case in found.items() if labels[0] == "F1")
    assert (new["standing"], new["newly_violating"], new["fails"]) == (Standing.NEW, True, True)
    assert new["margin"] == pytest.approx(-0.4, abs=1e-3)
    assert before["now"] != "F1"
    assert before["margin_again"] == pytest.approx(first, abs=1e-3)
    assert not Folder(folder / "new").result["regression"]["accepted"]
    assert invoke(["audit", "new"]) == 0


@pytest.mark.nightly
@pytest.mark.parametrize("barrier", nightly_but((1.0,), [0.05, 1.0]))
def test_a_known_violation_hides_no_milder_one_beyond_a_clear_ridge(barrier: float, folder: Path) -> None:
    assert ran(folder, "old", barrier=barrier) == VIOLATED
    assert ran(folder, "new", "--baseline", "old", barrier=barrier, second=-0.1) == VIOLATED
    found = changes(folder, "new")
    standings = {labels: case["standing"] for labels, case in found.items()}
    assert standings == {(None, "F2"): Standing.NEW, ("F1", "F1"): Standing.SAME}
    assert found[None, "F2"]["newly_violating"]
    assert invoke(["audit", "new"]) == 0


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("second", "standing"), [(-0.2, Standing.SAME), (-0.4, Standing.WORSE)])
def test_two_of_one_violating_region_are_one(second: float, standing: Standing, folder: Path) -> None:
    """The line between the wells rises by a part of a metre, but not to the threshold."""
    assert ran(folder, "old", ridge=0.2, second=0.0) == VIOLATED
    ended = ran(folder, "new", "--baseline", "old", ridge=0.2, first=-0.19, second=second)
    assert ended == (0 if standing is Standing.SAME else VIOLATED)
    (found,) = changes(folder, "new").values()
    assert (found["before"], found["now"], found["standing"]) == ("F1", "F1", standing)
    assert not found["newly_violating"]
    line = Folder(folder / "new").evidence["results"][-1]["basins"][0]["line"]
    assert line["highest"] < 0.0
    assert Folder(folder / "new").result["regression"]["accepted"]
    assert invoke(["audit", "new"]) == 0


def test_without_an_allowance_for_the_line_the_finding_is_new(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert ran(folder, "old", ridge=0.2, second=0.0) == VIOLATED
    monkeypatch.setattr(between, "LINE", 10**6)
    assert ran(folder, "new", "--baseline", "old", ridge=0.2, first=-0.19, second=-0.2) == VIOLATED
    assert changes(folder, "new")[None, "F1"]["newly_violating"]
    assert invoke(["audit", "new"]) == 0


def lower(basin: Any) -> None:
    basin["line"]["highest"] = -0.1


def without(basin: Any) -> None:
    del basin["line"]


def elsewhere(basin: Any) -> None:
    basin["line"] = {"end": [0.2, 0.22], "highest": -0.1}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("forge", nightly_but((without, elsewhere), [lower, without, elsewhere]))
def test_the_audit_evaluates_the_line_again(forge: Any, folder: Path) -> None:
    ran(folder, "old", ridge=0.2, second=0.0)
    ran(folder, "new", "--baseline", "old", ridge=0.2, first=-0.19, second=-0.2)
    forged = Folder(folder / "new")
    forge(forged.evidence["results"][-1]["basins"][0])
    assert "possible" in {item.name for item in forged.items() if item.agrees is False}
