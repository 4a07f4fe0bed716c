"""`clearance runs`, `show`, `cancel`, `export`, `follow`, `validate --service` against a real service."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
import sqlalchemy as sa
import yaml

from backend.db.tables import Run
from campaigns.claims.numbers import signed
from campaigns.results.finding import HalfStep
from campaigns.results.verdict import headline
from clearance.cli import INTERNAL, VIOLATED, WRONG_INPUT
from clearance.cli._exports import LIST
from tests import results
from tests.given.refused_commands import refusal
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit
from tests.results import Marks

Command = Callable[..., int]


@pytest.fixture
def violated(service: Service, command: Command) -> str:
    """A run that is done, and two that are queued."""
    with service.signed_in() as client:
        answer = client.post("/api/v1/runs", json={"campaign": campaign(), "labels": {"branch": "main"}})
        assert answer.status_code == 201
        finish_fully(service, "violated")
        submit(client, name="Second")
        submit(client, name="Third")
    return "R-0001"


def statement(capsys: pytest.CaptureFixture[str]) -> str:
    return capsys.readouterr().out


def test_runs_are_listed_filtered_and_limited(
    violated: str, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command("runs") == 0
    lines = statement(capsys).splitlines()
    assert [line.split()[:2] for line in lines] == [["R-0003", "queued"], ["R-0002", "queued"], ["R-0001", "violated"]]
    assert lines[2].endswith("branch=main")
    for options, found in (
        (("--label", "branch=main"), ["R-0001"]),
        (("--state", "queued"), ["R-0003", "R-0002"]),
        (("--state", "queued", "--state", "done", "--limit", "2"), ["R-0003", "R-0002"]),
        (("--verdict", "violated"), ["R-0001"]),
        (("R-0002",), ["R-0002"]),
        (("--owner", "nobody"), []),
    ):
        assert command("runs", *options, "--json") == 0
        assert [run["id"] for run in json.loads(statement(capsys))] == found
    assert command("runs", "--label", "main") == WRONG_INPUT
    assert "give KEY=VALUE" in capsys.readouterr().err


def test_a_run_is_shown(violated: str, command: Command, capsys: pytest.CaptureFixture[str]) -> None:
    assert command("show", violated) == 0, "the exit code of a command that does not wait is not the verdict"
    text = statement(capsys)
    assert text.startswith(f"R-0001 Violated: {campaign()['name']}\n")
    for part in (
        "fails  X: holds",
        "F1: d_min 1.3 m, margin +0.8 m; vehicle.m = 6.0",
        "Labels: branch=main",
        "equally likely",
    ):
        assert part in text
    assert text.rstrip().endswith("/runs/R-0001")
    assert command("show", violated, "--json") == 0
    assert json.loads(statement(capsys))["id"] == violated
    assert command("show", "R-0042") == WRONG_INPUT
    assert refusal(capsys.readouterr().err) == "not-found"


def test_the_time_of_a_run_is_that_in_which_its_stages_worked(
    service: Service, violated: str, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not that from its start to its end, in which a retried run has lain failed."""
    with service.signed_in() as client:
        stages = client.get(f"/api/v1/runs/{violated}/stages").json()
    worked = f"{sum(stage['seconds'] for stage in stages):.3f}"
    assert float(worked) > 0
    with changed(service.engine, sa.update(Run).where(Run.id == 1).values(started=Run.started - 3600)):
        assert command("follow", violated, "--junit", tmp_path / "junit.xml") == VIOLATED
        assert command("show", violated) == 0
    assert Xml.parse(tmp_path / "junit.xml").getroot()[0].get("time") == worked
    assert f"worked {worked} s" in statement(capsys)


def test_runs_are_cancelled(
    service: Service, violated: str, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command("cancel", "R-0003", violated) == 0
    assert statement(capsys).splitlines() == ["R-0003 cancelled", "R-0001 done: violated"]
    with changed(service.engine, sa.update(Run).where(Run.id == 1).values(verdict="cleared", summary={})):
        assert command("cancel", violated) == 0
        assert statement(capsys) == f"R-0001 done: {headline('cleared', Marks(True, True), None, None)}\n"
    assert command("cancel", "R-0002", "../x") == WRONG_INPUT
    capsys.readouterr()
    assert command("runs", "--state", "queued", "--json") == 0
    assert [run["id"] for run in json.loads(statement(capsys))] == ["R-0002"], "nothing is sent before all are read"


def test_a_name_cannot_write_to_the_terminal_or_break_the_picture(
    service: Service, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with service.signed_in() as client:
        submit(client)
    with service.engine.begin() as writer:  # as earlier versions permitted
        writer.execute(sa.update(Run).values(name="a\x1b[2J\r<b>"))
    for words in (("runs",), ("show", "R-0001")):
        assert command(*words) == 0
        assert "a\ufffd[2J\ufffd<b>" in statement(capsys)
    finish_fully(service)
    assert command("export", "R-0001", "--out", tmp_path, "--file", "worst-case.svg") == 0
    assert "a\ufffd[2J\ufffd<b>" in "".join(Xml.parse(tmp_path / "worst-case.svg").getroot().itertext())


def test_files_are_exported(
    violated: str, command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command("export", violated) == 0
    listed = statement(capsys).splitlines()
    assert sorted([*map(Path, listed), Path(violated, LIST)]) == sorted(Path(violated).iterdir())
    assert len(listed) == 5
    assert command("export", violated, "--out", ".", "--file", "findings.csv") == 0
    assert Path("findings.csv").is_file()
    assert command("export", violated, "--out", "p", "--file", "worst-case.svg", "--file", "traces.csv") == 0
    assert sorted(path.name for path in Path("p").iterdir()) == [LIST, "traces.csv", "worst-case.svg"]
    begins = {"capsule-F1.zip": b"PK\x03\x04", "traces.mcap": b"\x89MCAP0\r\n", "evaluations.parquet": b"PAR1"}
    files = [word for name in begins for word in ("--file", name)]
    assert command("export", violated, "--out", "e", *files) == 0
    assert {path.name for path in Path("e").iterdir()} == {LIST, *begins}
    assert {name: Path("e", name).read_bytes()[: len(begin)] for name, begin in begins.items()} == begins
    picture = Xml.parse("p/worst-case.svg").getroot()
    assert picture.tag == "{http://www.w3.org/2000/svg}svg"
    told = "".join(picture.itertext())
    assert re.search(r"R-0001: violated, .* F1 .* \+0\.8 m", told)
    assert "East (x), m" in told
    assert command("export", violated, "--file", "passwd") == WRONG_INPUT
    assert "'passwd'" in capsys.readouterr().err
    assert command("export", "R-0002", "--out", "q", "--file", "worst-case.svg") == WRONG_INPUT
    assert refusal(capsys.readouterr().err) == "not-found"
    assert not Path("q").exists()


def test_follow_writes_the_files_of_a_job(violated: str, command: Command, tmp_path: Path, service: Service) -> None:
    files = {name: tmp_path / name for name in ("junit.xml", "summary.md", "run.sarif")}
    options = ("--junit", files["junit.xml"], "--summary", files["summary.md"], "--sarif", files["run.sarif"])
    assert command("follow", violated, *options) == VIOLATED
    names = {str(case.get("name")) for case in Xml.parse(files["junit.xml"]).iter("testcase")}
    assert {"verdict", "criterion: d_min", "check: Nominal case", "check: X"} <= names
    assert "](summary-R-0001.svg)" in files["summary.md"].read_text()
    assert (tmp_path / "summary-R-0001.svg").read_text().startswith("<svg ")
    results = json.loads(files["run.sarif"].read_text())["runs"][0]["results"]
    assert [result["ruleId"] for result in results] == ["check/x"]
    place = results[0]["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == f"{service.url}/api/v1/runs/R-0001/campaign.yaml"
    assert place["region"]["startLine"] > 1


@pytest.mark.nightly
def test_the_picture_of_a_step_of_github_is_among_its_files(
    violated: str, command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    summary = tmp_path / "step" / "summary"
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    assert command("follow", violated, "--summary", summary, "--out", tmp_path / "out") == VIOLATED
    assert (tmp_path / "out" / "worst-case.svg").exists()
    assert "![" not in summary.read_text(), "GitHub would show a broken one"
    assert list(summary.parent.iterdir()) == [summary]


def test_a_submission_of_a_group_says_what_it_supersedes(
    violated: str, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "campaign.yaml"
    file.write_text(yaml.safe_dump(campaign()))
    options = ("--group", "p/main", "--no-wait", "--priority", "-3")
    assert command("submit", file, *options) == 0
    assert command("submit", file, *options) == 0
    out, err = capsys.readouterr()
    assert (out, err) == ("R-0004\nR-0005\n", "R-0004 of the group p/main superseded\n")
    assert command("show", "R-0004", "--json") == 0
    assert json.loads(statement(capsys))["superseded_by"] == "R-0005"
    for shown in ("show", "follow"):
        assert command(shown, "R-0004") == (0 if shown == "show" else 130)
        assert re.search("R-0005 .* p/main", statement(capsys)), shown
    assert command("submit", file, "--sweep", "avoider.d_0=1,2", "--group", "g") == WRONG_INPUT


def test_a_campaign_is_validated_by_a_service(
    command: Command, service: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    right, wrong = tmp_path / "right.yaml", tmp_path / "wrong.yaml"
    right.write_text(yaml.safe_dump(campaign()))
    other = campaign()
    other["scenario"]["vehicle"]["component"] = "hovercraft"
    wrong.write_text(yaml.safe_dump(other))
    assert command("validate", right, "--service", service.url) == 0
    assert f" {service.url}. Digest" in statement(capsys)
    assert command("validate", wrong, right, "--service", service.url) == WRONG_INPUT
    out, err = capsys.readouterr()
    assert "scenario.vehicle.component" in err
    assert "hovercraft" in err
    assert "1 of 2 " in err
    assert f" {service.url}. Digest" in out, "the others are checked all the same"
    assert service.rows()["runs"] == 0
    assert command("validate", right, "--service", service.url, "--normal") == WRONG_INPUT
    assert command("validate", right, "--service", "http://127.0.0.1:9", "--patience", "0") == INTERNAL


def test_a_removed_run_is_stated_as_removed_everywhere(
    violated: str, command: Command, service: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with service.signed_in() as client:
        assert client.post("/api/v1/runs/R-0002/cancel").status_code == 200
        removed = client.post("/api/v1/runs/remove", json={"runs": [violated, "R-0002"], "reason": "Wrong mass."})
        assert removed.status_code == 200, removed.text
    for run, code in ((violated, VIOLATED), ("R-0002", 130)):
        files = {name: tmp_path / f"{run}-{name}" for name in ("junit", "summary", "sarif")}
        assert command("follow", run, *(part for name in files for part in (f"--{name}", files[name]))) == code
        texts = {"follow": statement(capsys)} | {name: file.read_text() for name, file in files.items()}
        assert command("show", run) == 0
        texts["show"] = statement(capsys)
        for name, text in texts.items():
            assert re.search("Removed .* by .*: Wrong mass", text), (run, name)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("side", [1, -1])
def test_no_value_is_read_on_the_other_side_of_its_threshold(
    command: Command, service: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str], side: int
) -> None:
    """Nothing that states a run rounds a value or the threshold across the other one: to six digits it would."""
    limit, below = 0.73912 + side * 1.2e-7, 4e-8
    # A violation of which another evaluation is milder, or a case above the threshold.
    value = limit + below if side > 0 else limit - 2 * below
    milder = {"half_step": HalfStep(step=0.0025, cost=limit + side * below, difference=below), "integrator": None}
    again = results.validation("F1", value, agrees=side > 0, violates=side < 0).model_copy(update=milder)
    found = results.finding("F1", value, value - limit, {"vehicle.m": 6.0}, validation=again)
    with service.signed_in() as client:
        run = submit(client, criterion=campaign()["criterion"] | {"threshold": limit})
        finish_fully(service, "violated" if side < 0 else "cleared", found=[found], threshold=limit, worst=value)
        texts = {"report": client.get(f"/api/v1/runs/{run}/report.html").text}
    files = {name: tmp_path / name for name in ("junit", "summary", "sarif")}
    assert command("follow", run, *(part for name in files for part in (f"--{name}", files[name]))) in (0, 1)
    texts["follow"] = statement(capsys)
    assert command("show", run) == 0
    texts |= {"show": statement(capsys)} | {name: file.read_text() for name, file in files.items()}
    for name, text in texts.items():
        near = [float(number) for number in re.findall(r"\d\.\d+", text) if abs(float(number) - limit) < 2e-4]
        assert [number for number in near if (number - limit) * side < 0] == [], name
        if name in ("report", "show"):
            assert any((number - limit) * side > 0 for number in near), name
    assert command("runs") == 0
    for text in (texts["show"], statement(capsys)):
        assert any(f" {signed(n * side * below)} m" in text for n in (1, 2)), "a margin is written alike"
