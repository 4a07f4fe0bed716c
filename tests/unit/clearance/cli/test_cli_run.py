"""`clearance run` and `clearance validate`: exit codes, what is printed and what is written."""

from __future__ import annotations

import csv
import importlib
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns import Campaign, load_file
from campaigns.asked.load import load_document
from campaigns.asked.proposal import RETRIED
from campaigns.checked import prediction
from campaigns.checked.expected import fewer
from campaigns.checked.foreseen import foreseen
from campaigns.claims.numbers import count
from campaigns.refusals import RefusalCode
from campaigns.stages.plan import most
from clearance.cli import CLEARED, INCONCLUSIVE, INTERNAL, INTERRUPTED, NOT_A_RESULT, VIOLATED, WRONG_INPUT, invoke
from clearance.cli.validate import _print_usable
from tests.audited import audited_summary
from tests.faults.processes import until
from tests.given.case_campaigns import campaign, document, searching
from tests.given.refused_commands import refusal
from tests.simulators import package
from worker.engine.problem.problem import Problem
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened

PATIENCE = 120.0
"""[s]; a separate process may have to compile."""

DIRECT = {"method": "direct", "evaluations": 200}
SQP = {"method": "sqp", "evaluations": 200, "starts": [{"vehicle.m": 4.5, "vehicle.J": 0.05}]}
SAMPLE = {"method": "monte_carlo", "evaluations": 100}

FEW: dict[str, Any] = {"stages__certify": {"samples": 60}}
"""Samples: those of a probability of 5 % that is shown by no violation."""
SHORT = FEW | {"scenario__horizon": 4.0}
"""The closest approach comes at 3.1 s."""


@pytest.fixture(autouse=True)
def every_run_audited(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the command runs in this process is audited before it is printed."""
    monkeypatch.setattr(importlib.import_module("clearance.local.summary"), "summary", audited_summary)


@pytest.fixture
def file(tmp_path: Path) -> Callable[[Campaign | dict[str, Any] | str], str]:
    """Writes a campaign into a file; returns its name."""

    def write(given: Campaign | dict[str, Any] | str) -> str:
        made = given.document() if isinstance(given, Campaign) else given
        path = tmp_path / "campaign.yaml"
        path.write_text(made if isinstance(made, str) else json.dumps(made), encoding="utf-8")
        return str(path)

    return write


Write = Callable[[Campaign | dict[str, Any] | str], str]


def test_cleared_is_0(file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    made = searching(DIRECT, SQP, SAMPLE, **SHORT)
    assert invoke(["run", file(made)]) == CLEARED == 0
    out, err = capsys.readouterr()
    assert err.splitlines()[0] == f"At most {most(made):,} evaluations."
    assert "✓ Cleared" in out
    assert "search: DIRECT" in out
    assert "d_min stayed above 0.5 m" in out
    assert "from [4.5, 0.05]" in out
    assert "margin to 0.5 m" in out


def test_the_rows_of_a_stage_add_up(file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    """Of points that several descents request, each counts them and one evaluates them."""
    starts = [{"vehicle.m": 4.5, "vehicle.J": 0.05}] * 2 + [{"vehicle.m": 5.5, "vehicle.J": 0.05}]
    invoke(["run", file(searching({"method": "sqp", "evaluations": 500, "starts": starts}, SAMPLE, **SHORT))])
    rows = [[cell.strip() for cell in line.split("│")[1:]] for line in capsys.readouterr().out.splitlines()]
    table = [(row[0], int(row[2].replace("−", "-"))) for row in rows if len(row) == 8 and row[2].strip("−").isdigit()]
    at = [name for name, _ in table].index("search: SQP multistart")
    parts = [many for name, many in table[at + 1 :] if name.startswith(("from", "counted"))]
    assert len(parts) > 2
    assert parts[-1] < 0
    assert sum(parts) == table[at][1]


@pytest.mark.nightly  # by day tests/unit/clearance/cli/test_interrupted.py
def test_the_audit_lists_what_does_not_agree_and_counts_the_rest(
    file: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert invoke(["run", file(searching(DIRECT, SQP, SAMPLE, **SHORT)), "--out", str(out)]) == CLEARED
    capsys.readouterr()
    assert invoke(["audit", str(out)]) == 0
    short = capsys.readouterr().out
    assert len(short.splitlines()) == 2
    assert invoke(["audit", str(out), "--all"]) == 0
    rows = len(re.findall(r"(?m)│ agree +│$", capsys.readouterr().out))
    assert rows > 100
    assert f": {count(rows)} agree, 0 disagree, " in short
    result = out / "result.json"
    result.write_text(result.read_text(encoding="utf-8").replace('"verdict": "cleared"', '"verdict": "violated"'))
    assert invoke(["audit", str(out)]) == VIOLATED
    listed = capsys.readouterr().out
    assert "│ disagree" in listed
    assert "│ agree" not in listed


@pytest.mark.parametrize("usable", [1, 2])
def test_validate_names_every_file_that_can_be_used(
    usable: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [tmp_path / f"{number}.json" for number in range(usable)]
    for each in files:
        each.write_text(json.dumps(document()), encoding="utf-8")
    assert invoke(["validate", *map(str, files)]) == 0
    printed = capsys.readouterr().out
    assert all(f"{each}: " in printed for each in files)


def test_validate_states_calls_with_retries_and_stages_that_take_fewer_or_no_evaluations(
    file: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sample = {"samples": 20_000, "keep": "lowest", "until": "target"}
    stages = {"certify": sample, "estimate": {"evaluations": 1000}, "attraction": {}}
    made = campaign(stages=document()["stages"] | stages, target_probability=0.05)
    assert invoke(["validate", file(made)]) == 0
    shown = {line.split(":")[0].strip(): line for line in capsys.readouterr().out.splitlines()}
    assert shown["attraction"].startswith("  attraction: 0, which computes ")
    for kind in ("certify", "estimate"):
        shorter = fewer(made, kind)
        assert shorter is not None
        assert shown[kind].endswith(f"; {shorter.when}")
    given = package.campaign()
    given["simulator"] |= {"repeats": {"count": 2}, "retries": 5}
    _print_usable(tmp_path, load_document(given), "here")
    assert f" evaluations, {most(load_document(given)) * 12:,} calls {RETRIED}:\n" in capsys.readouterr().out


def test_validate_states_the_bound_that_the_sample_can_show_and_warns_where_that_is_too_high(
    file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    for target, warns in ((0.05, False), (0.001, True)):
        made = campaign(stages__certify={"samples": 59}, target_probability=target)
        best = prediction.predicted(made, catalogue())
        assert best is not None
        assert invoke(["validate", file(made)]) == 0
        out, err = capsys.readouterr()
        assert out.splitlines()[-1] == best.statement
        stated = [f"Warning: {each.statement}\n" for each in foreseen(made, catalogue())]
        assert err == "".join(stated)
        assert bool(stated) == warns


def violating() -> Campaign:
    """The threshold is between the worst case of 0.9417 m and the nominal 0.9436 m."""
    return searching(DIRECT, SQP, criterion__threshold=0.943, **SHORT)


def test_violated_is_1(file: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "run.sarif"
    given = file(violating())
    assert invoke(["run", given, "--sarif", str(log)]) == VIOLATED == 1
    results = json.loads(log.read_text())["runs"][0]["results"]
    assert (results[0]["ruleId"], results[0]["level"]) == ("violation", "error")
    place = results[0]["locations"][0]["physicalLocation"]
    assert place["artifactLocation"] == {"uri": Path(given).as_uri()}
    assert results[0]["properties"]["margin"] <= 0
    assert "✗ Violated" in capsys.readouterr().out


def test_inconclusive_is_2(file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", file(searching(DIRECT, scenario__horizon=1.0, **FEW))]) == INCONCLUSIVE == 2
    assert "? Inconclusive" in capsys.readouterr().out


def test_the_name_of_a_shipped_campaign_will_do(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["validate", "unicycle_static"]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"unicycle_static: {campaign().name} ")
    assert f" {campaign().digest[:16]}\n" in out
    assert " 28,044 evaluations:" in out
    assert "  search by direct: 3,000\n" in out


@pytest.mark.parametrize("command", ["run", "validate"])
@pytest.mark.parametrize(
    ("given", "statement"),
    [
        ("name: [", "not readable as YAML"),
        ("name: x\nname: y", "the key 'name' is given twice"),
        (document(scenario__step=-1), "scenario.step: expected a number above 0 (given: -1.0)"),
        (document(scenario__vehicle__component="unicyle"), "scenario.vehicle.component: no such vehicle; did you mean"),
        (document(**{"uncertain__vehicle.m": {"plus_minus": 1, "unit": "g"}}), "uncertain.vehicle.m.unit: the unit of"),
        (document(stages__search=[{"method": "magic", "evaluations": 1}]), "stages.search.0.method: no such method"),
    ],
)
def test_wrong_input_is_3(
    file: Write, capsys: pytest.CaptureFixture[str], command: str, given: Any, statement: str
) -> None:
    name = file(given)
    assert invoke([command, name]) == WRONG_INPUT == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"{name} cannot be used:\n")
    assert statement in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("arguments", "statement"),
    [
        (["run", "/nowhere/file.yaml"], "the file cannot be read: No such file or directory"),
        (["run", "/"], "the file cannot be read: Is a directory"),
        (["validate", "unicycle_statik"], "did you mean 'unicycle_static'?"),
        (["run", "unicycle_static", "--out", "/proc/nowhere/out"], "the folder /proc/nowhere/out cannot be written"),
        (["run", "unicycle_static", "--out", "/etc/passwd"], "--out"),
        (["run", "unicycle_static", "--threads", "-1"], "--threads"),
        (["run", "unicycle_static", "--threads", "many"], "--threads"),
        (["run", "unicycle_static", "unicycle_static"], "unexpected extra argument"),
        (["validate"], "give a campaign file, or --schema"),
        (["validate", "unicycle_static", "--schema"], "given alone"),
        (["run", "unicycle_static", "--baseline", ""], "--baseline is empty"),
        (["submit", "unicycle_static", "--baseline", " "], "--baseline is empty"),
    ],
)
def test_wrong_usage_is_3(capsys: pytest.CaptureFixture[str], arguments: list[str], statement: str) -> None:
    assert invoke(arguments) == WRONG_INPUT
    out, err = capsys.readouterr()
    assert out == ""
    assert statement in " ".join(err.split())


def test_a_failure_of_clearance_itself_is_4(
    file: Write, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Problem, "evaluate", lambda *_: 1 / 0)
    assert invoke(["run", file(searching(DIRECT)), "--json"]) == INTERNAL == 4
    out, err = capsys.readouterr()
    assert out == ""
    assert "ZeroDivisionError" in err
    assert err.endswith(f"{NOT_A_RESULT}\n")


KEYS = {
    "verdict", "reason", "nominal", "worst", "stages", "comparison", "checks", "statistics", "findings", "evaluations",
    "digest", "identity", "seed", "versions", "sentence", "scope", "statement", "holds_for", "values",
    "most_likely_violation",
}  # fmt: skip


def result(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    """The exit code of `clearance run --json`, and the one object that it printed."""
    code = invoke(["run", "--json", *arguments])
    out, err = capsys.readouterr()
    assert err == ""
    found = json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} in the result"))
    assert isinstance(found, dict)
    return code, found


def test_json_is_one_object_with_the_documented_keys(file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    asked = searching(DIRECT, SQP, SAMPLE, **SHORT)
    code, found = result(capsys, file(asked))
    assert code == 0
    assert set(found) == KEYS
    assert (found["verdict"], found["digest"], found["seed"]) == ("cleared", asked.digest, 1)
    assert set(found["nominal"]) == {"cost", "margin"}
    assert set(found["worst"]) == {"cost", "margin", "evaluated", "parameters", "method"}
    assert set(found["versions"]) == {"clearance", "wording", "code", "python", "packages", "cpu", "loop"}
    assert found["worst"]["parameters"] == {"vehicle.m": 6.0, "vehicle.J": 0.06}
    assert found["worst"]["cost"] == pytest.approx(0.9417402, abs=2e-6)
    assert [(s["kind"], s["method"]) for s in found["stages"]] == [
        ("nominal", None), ("sensitivity", None), ("search", "direct"), ("search", "sqp"), ("search", "monte_carlo"),
        ("certify", None), ("validate", None),
    ]  # fmt: skip
    for stage in found["stages"]:
        assert set(stage) == {
            "kind", "method", "best", "evaluations", "failed", "excluded", "seconds", "stop", "minima",
        }  # fmt: skip
    assert found["stages"][2]["evaluations"] == 200
    assert found["statistics"]["samples"] == 60
    assert [f["label"] for f in found["findings"]] == ["F1"]


def test_json_when_no_flight_is_possible(file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    uncertain = {"vehicle.m": {"plus_minus": "20%"}}
    asked = searching(DIRECT, scenario__vehicle__parameters__J=0.001, uncertain=uncertain)
    code, found = result(capsys, file(asked))
    assert (code, found["verdict"], found["worst"], found["findings"]) == (2, "inconclusive", None, [])
    assert found["nominal"] == {"cost": None, "margin": None}
    assert found["stages"][2]["best"] is None
    assert found["stages"][2]["failed"] == found["stages"][2]["evaluations"]


def test_the_report_when_no_flight_is_possible(file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    uncertain = {"vehicle.m": {"plus_minus": "20%"}}
    asked = searching(DIRECT, scenario__vehicle__parameters__J=0.001, uncertain=uncertain)
    assert invoke(["run", file(asked), "--json"]) == INCONCLUSIVE
    found = json.loads(capsys.readouterr().out)
    assert (found["worst"], found["findings"]) == (None, [])
    assert invoke(["run", file(asked)]) == INCONCLUSIVE
    assert found["sentence"] in capsys.readouterr().out


def test_a_run_writes_its_files_and_removes_earlier_ones(
    file: Write, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    asked, folder = searching(DIRECT, SQP, SAMPLE, **SHORT), tmp_path / "deep" / "out"
    result(capsys, file(asked), "--out", str(folder))
    for earlier in ("trace-F9.csv", "capsule-F9.zip"):
        (folder / earlier).touch()
    _, printed = result(capsys, file(asked), "--out", str(folder))
    assert {p.name for p in folder.iterdir()} == {
        "result.json", "campaign.json", "evaluations.csv", "evaluations.npz", "evidence.json", "trace-nominal.csv",
        "trace-F1.csv", "capsule-F1.zip",
    }  # fmt: skip
    assert invoke(["replay", str(folder / "capsule-F1.zip")]) == 0
    assert json.loads((folder / "result.json").read_text()) == printed
    assert load_file(folder / "campaign.json").digest == asked.digest
    with (folder / "evaluations.csv").open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    assert len(rows) == sum(s["evaluations"] for s in printed["stages"])
    assert list(rows[0]) == ["stage", "kind", "method", "index", "status", "cost", "vehicle.m", "vehicle.J", "reason"]
    problem = opened.problem(asked)
    vectors = np.array([problem.vector({p: float(r[p]) for p in ("vehicle.m", "vehicle.J")}) for r in rows])
    again = problem.system.simulate_vectors(vectors)[0].costs[:, 0]
    assert [float(r["cost"]) for r in rows] == again.tolist()  # full precision: a repeated simulation is bit-identical


def test_a_written_trace_contains_the_closest_approach(
    file: Write, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    _, printed = result(capsys, file(searching(DIRECT, SQP, **SHORT)), "--out", str(tmp_path / "out"))
    with (tmp_path / "out" / "trace-F1.csv").open(newline="") as lines:
        heading, *rows = csv.reader(lines)
    assert heading[:3] == ["t [s]", "x [m]", "y [m]"]
    assert heading[-1] == "separation [m]"
    assert len(rows) == 801
    lowest = min(float(row[-1]) for row in rows)
    assert 0 <= lowest - printed["worst"]["cost"] < 1e-4
    assert all(repr(float(v)) == v for row in rows[::100] for v in row)


def test_failed_evaluations_are_written_without_a_cost(
    file: Write, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    uncertain = {"vehicle.J": {"low": 0.001, "high": 0.06}}
    asked = searching(SAMPLE, uncertain=uncertain, scenario__horizon=1.0, **FEW)
    _, printed = result(capsys, file(asked), "--out", str(tmp_path / "out"))
    with (tmp_path / "out" / "evaluations.csv").open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    failed = [row for row in rows if row["status"] == "failed"]
    assert len(failed) == sum(s["failed"] for s in printed["stages"]) > 0
    assert {row["cost"] for row in failed} == {""}


@pytest.mark.nightly  # by day tests/unit/clearance/cli/test_interrupted.py
def test_the_threads_change_no_number(file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    name = file(searching(DIRECT, SQP, SAMPLE, scenario__horizon=1.0))
    found = [result(capsys, name, "--threads", n, "--sample-seed", "1")[1] for n in ("1", "2")]
    for one in found:
        for row in one["stages"] + one["comparison"]:
            del row["seconds"]
    assert found[0] == found[1]


def test_the_schema_and_the_whole_document(capsys: pytest.CaptureFixture[str], file: Write) -> None:
    assert invoke(["validate", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(Campaign.model_json_schema()))
    assert invoke(["validate", file(document()), "--normal"]) == 0
    assert json.loads(capsys.readouterr().out) == campaign().document()


# Processes of their own


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "clearance", *arguments]


@pytest.mark.nightly  # by day another one is interrupted, below, and one submits in tests/api/clients/test_ci_guide.py
def test_a_real_process_exits_with_the_code_of_the_verdict(file: Write, tmp_path: Path) -> None:
    name = file(violating())
    done = subprocess.run(command("run", name, "--json"), capture_output=True, timeout=PATIENCE, check=False)
    assert (done.returncode, done.stderr) == (VIOLATED, b"")
    assert json.loads(done.stdout)["verdict"] == "violated"


@pytest.mark.nightly  # by day tests/unit/clearance/cli/test_interrupted.py
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_is_130(file: Write, tmp_path: Path, number: signal.Signals) -> None:
    asked = searching({"method": "monte_carlo", "evaluations": 10_000_000}, stages__sensitivity=None)
    errors, junit = tmp_path / "errors", tmp_path / "junit.xml"
    with errors.open("wb") as sink:
        process = subprocess.Popen(
            command("run", file(asked), "--threads", "1", "--junit", str(junit)),
            stdout=subprocess.PIPE, stderr=sink, env={**os.environ, "FORCE_COLOR": "1", "TTY_INTERACTIVE": "1"},
        )  # fmt: skip
    # The bars appear once the campaign is running.
    until(lambda: b"Monte Carlo" in errors.read_bytes() or process.poll() is not None, "it is running", PATIENCE)
    assert process.poll() is None, errors.read_text()
    process.send_signal(number)
    out, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == INTERRUPTED == 130
    assert b"Cleared" not in out
    told = errors.read_text()
    assert "Traceback" not in told
    lost = r"interrupted: ([\d\u202f]+) evaluations were completed; they are not stored, .*start it again"
    found = re.search(lost, told)
    assert found is not None
    assert found[1][0] != "0", "the bars were shown, so some were completed"
    assert "cancelled" in junit.read_text(encoding="utf-8")


@pytest.mark.skipif(sys.platform != "linux", reason="address space is bounded on Linux alone")
def test_a_run_that_needs_more_memory_than_it_may_take_ends_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    import resource

    def greedy(*_: object, **__: object) -> None:
        np.zeros(2**31)  # 16 GiB, never touched

    monkeypatch.setattr("worker.running.runs.runner.execute", greedy)
    monkeypatch.setenv("CLEARANCE_CHILD_MEMORY", "1")
    before = resource.getrlimit(resource.RLIMIT_AS)
    assert invoke(["run", "unicycle_static"]) == WRONG_INPUT == 3
    assert refusal(capfd.readouterr().err) == RefusalCode.TOO_LITTLE_MEMORY
    assert resource.getrlimit(resource.RLIMIT_AS) == before


def test_a_memory_bound_that_is_no_number_is_wrong_input(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEARANCE_CHILD_MEMORY", "lots")
    assert invoke(["run", "unicycle_static"]) == 3
    assert "invalid CLEARANCE_CHILD_MEMORY 'lots': give a number of GiB such as 8" in capfd.readouterr().err
