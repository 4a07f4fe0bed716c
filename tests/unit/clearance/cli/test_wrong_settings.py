"""A setting that is no number is refused before anything is started, by every command that simulates."""

from __future__ import annotations

from pathlib import Path

import pytest

from clearance.cli import WRONG_INPUT, invoke
from tests.given.case_campaigns import campaign


@pytest.mark.parametrize("command", ["run", "worker", "serve"])
@pytest.mark.parametrize(
    ("setting", "value"),
    [(name, value) for name in ("CLEARANCE_CHILD_MEMORY", "CLEARANCE_THREADS") for value in ("x", "-1", "1.5.2")],
)
def test_it_is_refused(
    command: str,
    setting: str,
    value: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv(setting, value)
    (tmp_path / "campaign.json").write_text(campaign().model_dump_json(), encoding="utf-8")
    of_run = [str(tmp_path / "campaign.json"), "--out", str(tmp_path / "out")]
    arguments = of_run if command == "run" else ["--data", str(tmp_path / "data")]
    assert invoke([command, *arguments]) == WRONG_INPUT
    told = capsys.readouterr().err
    assert f"{setting} {value!r}" in told
    assert "Traceback" not in told
    assert not (tmp_path / "data").exists()
