"""A claim is of the whole box and of all noise: what one stage, one seed or one large value hides of them bars it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from campaigns import load_file
from campaigns.checked.foreseen import one_realisation
from clearance.cli import INCONCLUSIVE, invoke
from tests.given.corrupted_records import Folder
from worker.running.catalogue import installed

SIMULATOR = '''
import math

import numpy as np

import clearance


@clearance.simulator(
    parameters={
        "a": clearance.Parameter(0.0, 1.0, nominal=0.95),
        "b": clearance.Parameter(0.0, 1.0, nominal=0.5),
        "noise_seed": clearance.Parameter(0.0, 1000.0, nominal=1.0),
        "from_a": clearance.Parameter(0.0, 1.0, nominal=0.0),
        "nowhere": clearance.Parameter(0.0, 1e7, nominal=0.0),
    },
    results={"s": clearance.Output(unit="m", worse="low")}, isolated=False,
)
def one(a, b, noise_seed, from_a, nowhere):
    """Nothing is known below a value of a; a large value at one place."""
    if a < from_a:
        raise clearance.Excluded("starts inside the zone")
    if nowhere and abs(a - 0.95) < 1e-3 and abs(b - 0.5) < 1e-3:
        return nowhere
    noise = 1.5 * np.random.default_rng(int(noise_seed)).normal()
    return 6.0 - a - 0.3 * b + noise + 0.2 * math.cos(9.0 * a) * math.cos(11.0 * b)
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "sims").mkdir()
    (tmp_path / "sims" / "one.py").write_text(SIMULATOR, encoding="utf-8")
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(tmp_path / "sims"))
    monkeypatch.chdir(tmp_path)
    installed.forget_simulators()
    yield tmp_path
    installed.forget_simulators()


SEEDS = {"simulator.noise_seed": {"low": 0.0, "high": 1000.0}}


def ran(folder: Path, samples: int = 60, uncertain: Any = SEEDS, a: Any = None, **values: float) -> Any:
    """The result of a run that `clearance audit` confirms."""
    campaign = {
        "name": "one",
        "simulator": {"name": "one", "parameters": values},
        "uncertain": {
            "simulator.a": {"low": 0.0, "high": 1.0} | (a or {}),
            "simulator.b": {"low": 0.0, "high": 1.0},
        }
        | uncertain,
        "criterion": {"result": "s", "threshold": -9.0},
        "stages": {
            "sensitivity": None,
            "search": [{"method": "auto", "evaluations": 150}],
            "certify": {"samples": samples},
        },
    }
    (folder / "one.json").write_text(json.dumps(campaign), encoding="utf-8")
    out = f"out{len(list(folder.glob('out*')))}"
    assert invoke(["run", "one.json", "--out", out, "--threads", "1"]) in (0, INCONCLUSIVE)
    assert invoke(["audit", out]) == 0
    return Folder(folder / out).result


def holds(result: Any, name: str) -> bool | None:
    return next((check["ok"] for check in result["checks"] if check["name"] == name), None)


NARROW = {"distribution": {"kind": "truncated_normal", "mean": 0.96, "deviation": 0.01}}


@pytest.mark.parametrize(("from_a", "within"), [(0.9, False), (0.02, True)])
def test_a_large_sample_elsewhere_hides_nothing_that_a_search_excludes(
    from_a: float, within: bool, folder: Path
) -> None:
    result = ran(folder, 3000, a=NARROW, from_a=from_a)
    counts = result["evaluations"]
    assert counts["excluded"] < 0.1 * counts["stored"]
    assert holds(result, "exclusions") is within
    assert result["verdict"] != "cleared" or within


def test_a_fixed_seed_of_any_part_is_one_realisation(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(folder, uncertain={}, noise_seed=1.0)
    assert (holds(result, "noise"), result["verdict"]) == (False, "inconclusive")
    assert one_realisation(load_file(folder / "one.json"), list(SEEDS)) in capsys.readouterr().err  # before it ran
    assert holds(ran(folder), "noise") is None


def test_so_is_one_of_few_values(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(folder, uncertain={"simulator.noise_seed": {"low": 1.0, "high": 1.9}})
    assert (holds(result, "noise"), result["verdict"]) == (False, "inconclusive")
    assert one_realisation(load_file(folder / "one.json"), list(SEEDS)) in capsys.readouterr().err


def test_a_large_nominal_value_is_no_scale_of_how_sure_a_search_is(folder: Path) -> None:
    assert ran(folder, uncertain={}).get("sureness") is not None
    assert ran(folder, uncertain={}, nowhere=1e6).get("sureness") is None
