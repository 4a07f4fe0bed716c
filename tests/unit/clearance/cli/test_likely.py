"""`clearance run` states how likely its findings are, in its output and in every file that it writes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

import clearance.local.likelihood as local
from clearance.cli import VIOLATED, invoke
from tests.given.case_campaigns import searching

SEARCHES = (
    {"method": "direct", "evaluations": 200},
    {"method": "sqp", "evaluations": 200, "starts": [{"vehicle.m": 4.5, "vehicle.J": 0.05}]},
)
FEW: dict[str, Any] = {"stages__certify": {"samples": 60}}
NORMAL = {
    "vehicle.m": {"plus_minus": "20%", "distribution": {"kind": "normal", "mean": 5.0, "deviation": 0.4}},
    "vehicle.J": {
        "low": 0.04,
        "high": 0.06,
        "distribution": {"kind": "truncated_normal", "mean": 0.05, "deviation": 0.005},
    },
}


def test_a_violated_run_states_it_everywhere(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = searching(*SEARCHES, uncertain=NORMAL, criterion__threshold=0.943, scenario__horizon=4.0, **FEW)
    (tmp_path / "campaign.json").write_text(json.dumps(asked.document()))
    files = ["--out", str(tmp_path / "out"), "--junit", str(tmp_path / "j.xml"), "--sarif", str(tmp_path / "s.json")]
    with mock.patch.object(local, "most_likely", wraps=local.most_likely) as computed:
        assert invoke(["run", str(tmp_path / "campaign.json"), *files]) == VIOLATED
    assert computed.call_count == 1
    out = " ".join(capsys.readouterr().out.split())
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    worst, most = result["findings"][0]["likelihood"], result["most_likely_violation"]
    assert worst["distance"] == pytest.approx(np.hypot(1.0 / 0.4, 0.01 / 0.005))
    assert most["violations"] == result["evaluations"]["violating"]
    assert most["case"]["likelihood"]["distance"] < worst["distance"]
    assert f"F1: {worst['text']}." in out
    assert f"{most['text'][1:]}." in out
    assert worst["text"] in (tmp_path / "j.xml").read_text()
    assert worst["text"] in (tmp_path / "s.json").read_text()
    with np.load(tmp_path / "out" / "evaluations.npz") as stored:
        position, index = most["case"]["position"], most["case"]["index"]
        assert stored[f"costs_{position}"][index, 0] == most["case"]["cost"] <= 0.943
    assert invoke(["audit", str(tmp_path / "out")]) == 0


@pytest.mark.nightly
def test_in_a_box_one_line_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = searching(*SEARCHES, criterion__threshold=0.943, scenario__horizon=4.0, **FEW)
    (tmp_path / "campaign.json").write_text(json.dumps(asked.document()))
    assert invoke(["run", str(tmp_path / "campaign.json"), "--junit", str(tmp_path / "j.xml")]) == VIOLATED
    assert capsys.readouterr().out.count("equally likely") == 1
    assert "equally likely" not in (tmp_path / "j.xml").read_text()
