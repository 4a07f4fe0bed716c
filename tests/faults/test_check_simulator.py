"""`clearance check-simulator` on the simulators that an installation may have."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db.engine import connect, default_url, read
from backend.db.tables import SimulatorMeasurement
from campaigns.asked.load import load_file
from campaigns.checked.expected import at_most
from campaigns.claims.spans import words
from campaigns.claims.stages import calls
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.results.measured import Measured
from campaigns.stages.plan import most
from clearance.cli import WRONG_INPUT, invoke
from clearance.cli._announce import announce
from clearance.cli.check_simulator import NOT_AS_IT_IS
from tests.simulators.adversaries import Call, adversary, never
from worker.running.catalogue.installed import catalogue, forget_simulators

CAMPAIGN = {
    "name": "Adversary",
    "simulator": {"name": "adversary"},
    "uncertain": {"simulator.a": {"low": 0.0, "high": 1.0}},
    "criterion": {"result": "d", "threshold": 0.0},
    "stages": {"search": [{"method": "direct", "evaluations": 50}]},
}


def test_one_that_can_be_used_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    with adversary():
        assert invoke(["check-simulator", "adversary", "--points", "7"]) == 0
    shown = capsys.readouterr().out
    assert {
        "  parameter a: nominal 0.5, 0 to 1", "  result d [m], worse when low",
        "21 of 21 evaluations of 7 points have a value of d",
    } <= set(shown.splitlines())  # fmt: skip
    assert words(calls.measured(7, 21, 0, True, True, None, "m")) in shown
    assert "Proposal" not in shown
    (asked,) = [line for line in shown.splitlines() if line.startswith("methods and budgets for it: clearance ")]
    assert invoke(asked.partition("clearance ")[2].split()) == 0


@pytest.mark.parametrize("how", ["noise", "tiny noise", "drift", "noise of the process", "by call count"])
def test_one_that_does_not_repeat(how: str, capsys: pytest.CaptureFixture[str]) -> None:
    with adversary(how):
        assert invoke(["check-simulator", "adversary"]) == NOT_AS_IT_IS
    shown = capsys.readouterr().out
    assert "repeats: {count: 5, combine: worst}" in shown
    assert ("recycle: 1" in shown) == (how == "noise of the process")


def test_one_that_declares_noise_but_shows_none(capsys: pytest.CaptureFixture[str]) -> None:
    with adversary(declared=False):
        assert invoke(["check-simulator", "adversary"]) == NOT_AS_IT_IS
    assert words(calls.measured(5, 15, 0, True, False, None, "m")) in capsys.readouterr().out


def test_one_that_fails_at_some_points(capsys: pytest.CaptureFixture[str]) -> None:
    def beyond(call: Call) -> int:
        return FAILED if call.a > 0.7 else OK

    with adversary("none", beyond):
        assert invoke(["check-simulator", "adversary", "--points", "9"]) == NOT_AS_IT_IS
    shown = capsys.readouterr().out
    assert " exit code 3" in shown
    assert "repeats: {" not in shown


def test_several_calls_are_no_help_to_one_that_fails_now_and_then(capsys: pytest.CaptureFixture[str]) -> None:
    with adversary("none", lambda call: FAILED if call.total % 2 else OK):
        assert invoke(["check-simulator", "adversary"]) == NOT_AS_IT_IS
    shown = capsys.readouterr().out
    assert "fail only sometimes" in shown
    assert "repeats: {" not in shown


@pytest.mark.parametrize(("most", "code"), [(0.7, 0), (0.4, NOT_AS_IT_IS)])
def test_one_that_excludes_some_points_and_one_that_excludes_the_nominal_case(
    most: float, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    with adversary("none", lambda call: EXCLUDED if call.a > most else OK):
        assert invoke(["check-simulator", "adversary", "--points", "9"]) == code
    shown = capsys.readouterr().out
    assert "excluded:" in shown
    assert "failed:" not in shown


def test_one_that_always_fails(capsys: pytest.CaptureFixture[str]) -> None:
    with adversary("none", never):
        assert invoke(["check-simulator", "adversary"]) == NOT_AS_IT_IS
    shown = capsys.readouterr().out
    assert "0 of 15 " in shown
    assert "whether it repeats is unknown" in shown
    assert "Proposal" not in shown


@pytest.mark.parametrize(
    ("given", "statement"),
    [
        (["adversari"], "did you mean 'adversary'?"),
        (["x"], "choose one of: "),
        (["adversary", "--result", "e"], "has no such result"),
        (["adversary", "--points", "1"], "--points"),
    ],
)
def test_what_does_not_fit_is_refused(given: list[str], statement: str, capsys: pytest.CaptureFixture[str]) -> None:
    with adversary():
        assert invoke(["check-simulator", *given]) == WRONG_INPUT
    assert statement in capsys.readouterr().err


def stored(folder: Path) -> list[Any]:
    engine = connect(default_url(folder))
    try:
        with read(engine) as reader:
            table = SimulatorMeasurement
            return list(reader.execute(sa.select(table.simulator, table.host, table.result)))
    finally:
        engine.dispose()


def test_with_data_the_measurement_is_stored_and_announced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A run without the database announces its bound alone, and creates none."""
    data = tmp_path / "new" / "data"
    campaign = tmp_path / "campaign.yaml"
    campaign.write_text(json.dumps(CAMPAIGN), encoding="utf-8")
    of = load_file(campaign)
    with adversary("noise"):
        assert announced(campaign, data, capsys).splitlines()[0] == f"{at_most(of, most(of))}."
        assert not data.exists()
        assert invoke(["check-simulator", "adversary", "--data", str(data)]) == NOT_AS_IT_IS
        assert f": {data / 'clearance.sqlite3'}\n" in capsys.readouterr().out
        (found,) = stored(data)
        entry = catalogue().simulator("adversary")
        assert entry is not None
        measured = Measured.model_validate(found.result)
        assert (found.simulator, found.host, measured.evaluations) == (entry.version, socket.gethostname(), 15)
        assert (measured.spread or 0.0) > 0.0
        text = announced(campaign, data, capsys)
    assert "evaluations; " in text
    assert "One evaluation took " in text
    assert "(clearance check-simulator on " in text


def announced(campaign: Path, data: Path, capsys: pytest.CaptureFixture[str]) -> str:
    announce(load_file(campaign), data, "")
    return capsys.readouterr().err


def test_without_a_value_nothing_is_stored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with adversary("none", never):
        assert invoke(["check-simulator", "adversary", "--data", str(tmp_path)]) == NOT_AS_IT_IS
        assert str(tmp_path) not in capsys.readouterr().out
        assert stored(tmp_path) == []


@pytest.mark.parametrize("given", [["--database", "mysql://x"], ["--data", "/proc/1/none"]])
def test_a_database_that_cannot_be_used_is_reported_before_anything_is_evaluated(
    given: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with adversary():
        assert invoke(["check-simulator", "adversary", *given]) == WRONG_INPUT
    assert "evaluations" not in capsys.readouterr().out


def test_more_parameters_than_a_campaign_may_vary_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also in a folder whose name has spaces and letters beyond ASCII."""
    folder = tmp_path / "my räume" / "many"
    folder.mkdir(parents=True)
    program = "import json, sys\nfor s in sys.stdin: print(json.dumps({'results': {'d': len(s)}}), flush=True)"
    (folder / "the program.py").write_text(program, encoding="utf-8")
    described = {
        "name": "many",
        "command": ["{python}", "{folder}/the program.py"],
        "parameters": {f"p{k}": {"nominal": 0.5, "low": 0, "high": 1} for k in range(200)},
        "results": {"d": {}},
    }
    (folder / "simulator.yaml").write_text(json.dumps(described), encoding="utf-8")
    (folder.parent / "named.py").write_text(
        'import clearance\n@clearance.simulator(parameters={"µ": (0.0, 1.0)})\ndef größe(µ): return µ', encoding="utf-8"
    )
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(folder.parent))
    forget_simulators()
    try:
        invoke(["check-simulator", "many", "--points", "2"])
        shown = capsys.readouterr().out
        assert "varied: 64 of 200 parameters" in shown
        assert "6 of 6 " in shown
        assert invoke(["check-simulator", "named"]) == WRONG_INPUT
        assert "named.py: " in capsys.readouterr().err, "a file that is skipped is reported with its reason"
    finally:
        forget_simulators()
