"""A run of the command line that fails or is interrupted after it has evaluated something."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from campaigns.asked.problem import Problem
from clearance.cli import INTERNAL, INTERRUPTED, invoke
from tests.given.case_campaigns import document
from worker.running.runs import file_check

CHANGED = file_check.FilesChanged([Problem("simulator.name", "own", "own.py has changed")])


@pytest.mark.parametrize("threshold", [0.5, 1.5], ids=["above", "below"])
@pytest.mark.parametrize(
    ("ends", "code"), [(CHANGED, INTERNAL), (KeyboardInterrupt(), INTERRUPTED)], ids=["failed", "cancelled"]
)
def test_a_value_at_or_below_the_threshold_is_stated_although_the_run_ended_early(
    ends: BaseException, code: int, threshold: float, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
) -> None:  # fmt: skip
    """Such as a run whose simulator changes meanwhile: by the output and by the files of the job."""

    looks = iter(range(100))

    def look(*_: object) -> None:
        if next(looks) > 0:  # the first evaluations are stored
            raise ends

    monkeypatch.setattr(file_check, "check", look)
    asked = document(criterion__threshold=threshold, scenario__horizon=4.0)
    (tmp_path / "asked.yaml").write_text(yaml.safe_dump(asked), encoding="utf-8")
    files = {name: tmp_path / name for name in ("junit", "summary", "sarif")}
    options = [part for name, path in files.items() for part in (f"--{name}", str(path))]
    assert invoke(["run", str(tmp_path / "asked.yaml"), "--json", *options]) == code
    out, err = capsys.readouterr()
    stated = json.loads(out)
    assert stated["state"] == ("failed" if code == INTERNAL else "cancelled")
    sentence = stated.get("unconfirmed", "")
    assert bool(sentence) == (threshold == 1.5)
    for text in (err, *(file.read_text(encoding="utf-8") for file in files.values())):
        assert sentence in text
        assert ("lowest value" in text) == bool(sentence)
