"""A campaign file that contains the command of its simulator: refused, unless the command line permits it."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import pytest
import yaml

from campaigns import CampaignError, load_file
from campaigns.asked.reading import Dumper
from campaigns.refusals import RefusalCode
from clearance.cli import INTERNAL, WRONG_INPUT, invoke
from clearance.cli import _code as code
from clearance.cli._code import HOW
from clearance.local.results import read_folder
from tests.given.case_campaigns import campaign
from tests.given.refused_commands import fields, refusal, refused
from tests.simulators import package
from tests.simulators.adversaries import adversary
from worker.engine.stages.parts import offered
from worker.engine.systems.simulators.cluster.address import SETTING
from worker.engine.systems.simulators.declared import descriptor
from worker.evidence.audit import judge
from worker.running.catalogue import installed
from worker.running.catalogue.inline import NAME, InlineProgram
from worker.running.opening import opened

PROGRAM = """
import json, sys
for line in sys.stdin:
    given = json.loads(line)["parameters"]
    value = 3.0 + (given["x"] - 0.3) ** 2 + (given["y"] - 0.6) ** 2
    print(json.dumps({"results": {"separation": value}}), flush=True)
"""
GIVEN: dict[str, Any] = {
    "name": "bowl",
    "command": ["{python}", "-S", "{folder}/bowl.py"],
    "parameters": {name: {"nominal": 0.5, "low": 0.0, "high": 1.0} for name in "xy"},
    "results": {"separation": {"unit": "m", "title": "Separation"}},
    "timeout": 20,
    "slots": 1,
}


@pytest.fixture(autouse=True)
def undone() -> Iterator[None]:
    """What a campaign file gave is installed for its process, which here has further tests."""
    yield
    for name in ("bowl", NAME):
        installed.simulators().pop(name, None)
    installed.catalogue.cache_clear()


def written(folder: Path, **changes: Any) -> Path:
    """A campaign file with a command, next to its program; None removes a key."""
    (folder / "bowl.py").write_text(PROGRAM, encoding="utf-8")
    given = {key: value for key, value in (GIVEN | changes).items() if value is not None}
    file = folder / "campaign.yaml"
    stages = {"sensitivity": None, "search": [{"method": "direct", "evaluations": 20}], "validate": {"neighbours": 0}}
    document = package.campaign(2.0, simulator=given, stages=stages)
    file.write_text(yaml.dump(document, Dumper=Dumper, sort_keys=False), encoding="utf-8")
    return file


@pytest.mark.parametrize("command", ["run", "validate"])
def test_without_the_option_it_is_refused_and_never_started(
    tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = written(tmp_path, command=["sh", "-c", f"touch {tmp_path}/made"])
    assert invoke([command, str(file)]) == WRONG_INPUT
    errors = capsys.readouterr().err
    assert set(fields(errors)) == {"simulator.command"}, "what follows from it is not reported"
    assert HOW in errors
    assert not (tmp_path / "made").exists()


def test_the_option_changes_nothing_of_any_other_campaign(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["validate", "unicycle_static"]) == 0
    before = capsys.readouterr().out
    assert invoke(["validate", "unicycle_static", "--allow-code"]) == 0
    assert capsys.readouterr().out == before
    file = tmp_path / "campaign.json"
    file.write_text(json.dumps(package.campaign(simulator={"name": "drop", "python": "x"})), encoding="utf-8")
    assert invoke(["validate", str(file), "--allow-code"]) == WRONG_INPUT
    assert fields(capsys.readouterr().err) == ["simulator.python"]
    file.write_text("a: [1", encoding="utf-8")
    assert invoke(["validate", str(file), "--allow-code"]) == WRONG_INPUT


def test_a_run_names_the_command_and_identifies_its_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(offered, "SPOT_CHECKS", 5)  # each in a process of its own
    monkeypatch.setattr(judge.audit, "__defaults__", (offered.AT_MOST, 5))
    file, out = written(tmp_path), tmp_path / "out"
    assert invoke(["run", str(file), "--allow-code", "--json", "--out", str(out)]) == 2  # one method cannot clear
    found = json.loads(capsys.readouterr().out)
    assert found["versions"]["command"] == "'{python}' -S '{folder}/bowl.py'"
    assert "run by a command that the campaign file gives, " in found["scope"]
    assert "of its description in the campaign file and of bowl.py" in found["scope"]
    assert found["worst"]["cost"] == pytest.approx(3.0, abs=0.05)
    assert json.loads((out / "campaign.json").read_text())["simulator"] == {"name": "bowl", "parameters": {}}
    text = (out / "simulator.yaml").read_text(encoding="utf-8")
    assert text.startswith(f"# From {file}, where {{folder}} was {tmp_path}\n")
    assert yaml.safe_load(text) == GIVEN
    assert invoke(["audit", str(out)]) == 0


def test_a_run_whose_simulator_gives_no_value_fails_with_the_files_of_the_job(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, cases, texts, found = written(tmp_path), *(tmp_path / name for name in ("j.xml", "s.md", "c.sarif"))
    (tmp_path / "bowl.py").write_text("raise SystemExit('no licence')\n", encoding="utf-8")
    files = ["--junit", str(cases), "--summary", str(texts), "--sarif", str(found), "--label", "branch=main"]
    assert invoke(["run", str(file), "--allow-code", *files]) == INTERNAL
    assert "no licence" in capsys.readouterr().err
    [error] = Xml.parse(cases).getroot().iter("error")
    assert "no licence" in str(error.get("message"))
    summary = texts.read_text(encoding="utf-8")
    assert "exit code 4" in summary
    assert "no licence" in summary
    [result] = json.loads(found.read_text(encoding="utf-8"))["runs"][0]["results"]
    assert result["ruleId"] == "no-verdict"


@pytest.mark.nightly
def test_no_description_of_an_earlier_run_stays_among_the_results(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, file = tmp_path / "out", written(tmp_path)
    invoke(["run", str(file), "--allow-code", "--out", str(out)])
    assert (out / "simulator.yaml").exists()
    short = tmp_path / "short.json"
    searches = {"sensitivity": None, "search": [{"method": "direct", "evaluations": 5}], "validate": {"neighbours": 0}}
    short.write_text(campaign(stages=searches, scenario__horizon=1.0).model_dump_json(by_alias=True), encoding="utf-8")
    assert refused(capsys, "run", short, "--out", out) == RefusalCode.OTHER_CAMPAIGN
    assert (out / "simulator.yaml").exists()
    (tmp_path / "bowl.py").write_text("raise SystemExit('no licence')\n", encoding="utf-8")
    assert invoke(["run", str(file), "--allow-code", "--out", str(out)]) == INTERNAL
    assert not (out / "simulator.yaml").exists()
    (out / "simulator.yaml").write_text("name: own", encoding="utf-8")
    for _ in range(2):
        invoke(["run", str(short), "--out", str(out)])
        assert (out / "simulator.yaml").read_text(encoding="utf-8") == "name: own", "no run wrote it"


def test_a_description_that_no_run_wrote_is_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = written(tmp_path)
    own = tmp_path / "out" / "simulator.yaml"
    own.parent.mkdir()
    own.write_text("name: own", encoding="utf-8")
    assert refused(capsys, "run", file, "--allow-code", "--out", own.parent) == RefusalCode.EXISTS
    assert own.read_text(encoding="utf-8") == "name: own"


@pytest.mark.nightly
def test_a_run_in_other_units_is_no_baseline(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def run(folder: str, unit: str, *more: str) -> int:
        (tmp_path / folder).mkdir()
        result = {"separation": {"unit": unit, "title": "Separation"}}
        file = written(tmp_path / folder, results=result)
        return invoke(["run", str(file), "--allow-code", "--out", str(tmp_path / folder / "out"), *more])

    assert run("one", "m") == 2
    baseline = ("--baseline", str(tmp_path / "one" / "out"))
    capsys.readouterr()
    assert run("two", "km", *baseline) == WRONG_INPUT
    assert {"m,", "km"} <= set(capsys.readouterr().err.split())
    assert run("three", "m", *baseline) == 2
    evidence = tmp_path / "one" / "out" / "evidence.json"
    evidence.write_text(json.dumps(json.loads(evidence.read_text()) | {"components": None}), encoding="utf-8")
    assert run("four", "m", *baseline) == WRONG_INPUT


@pytest.mark.nightly
def test_its_findings_are_replayed_where_its_command_is_permitted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, out, cases = written(tmp_path, name="bowl"), tmp_path / "out", tmp_path / "j.xml"
    document = yaml.safe_load(file.read_text(encoding="utf-8"))
    document["criterion"]["threshold"] = 9.0
    file.write_text(yaml.dump(document, Dumper=Dumper, sort_keys=False), encoding="utf-8")
    assert invoke(["run", str(file), "--allow-code", "--out", str(out), "--junit", str(cases)]) == 1
    command = next(line for line in cases.read_text(encoding="utf-8").splitlines() if "clearance replay" in line)
    installed.simulators().pop("bowl")
    installed.catalogue.cache_clear()
    assert invoke(["replay", str(out), "F1"]) == WRONG_INPUT
    assert "--allow-code" in capsys.readouterr().err
    assert invoke(shlex.split(command.partition("</")[0])[1:]) == 0
    assert "F1" in capsys.readouterr().out
    assert invoke(["audit", str(out), "--replay", "3", "--allow-code"]) == 0


def test_calls_and_retries_stay_those_of_the_campaign(tmp_path: Path) -> None:
    campaign = code.read(written(tmp_path, name=None, repeats={"count": 3}, retries=1), allowed=True)
    assert campaign.simulator is not None
    assert (campaign.simulator.name, campaign.simulator.calls, campaign.simulator.retries) == (NAME, 3, 1)
    system = opened.system(campaign)
    assert system.campaign_command.startswith("'{python}' -S ")
    system.close()


def test_its_description_is_written_as_it_was_given(tmp_path: Path) -> None:
    """Text that one reader of YAML takes for a number or a truth value, and another one does not."""
    texts = ["1e5", "010", "0x10", "1:30", "no", "null", "2001-01-01", "~", "1_000"]
    file = written(tmp_path, environment={f"V{at}": text for at, text in enumerate(texts)}, text="1e5")
    campaign = code.read(file, allowed=True)
    code.write_description(tmp_path, campaign)
    again = descriptor.read(tmp_path)
    assert isinstance(again, descriptor.DescribedProgram)
    assert list(again.descriptor.environment.values()) == texts
    program = installed.simulators()["bowl"]
    assert isinstance(program, InlineProgram)
    assert again.descriptor == program.descriptor


def test_the_digest_changes_with_the_description_and_with_the_program(tmp_path: Path) -> None:
    def digest(**changes: Any) -> str:
        system = opened.system(code.read(written(tmp_path, **changes), allowed=True))
        found = system.digest
        system.close()
        return found

    first = digest()
    assert digest() == first
    assert digest(timeout=21) != first
    assert digest(command=["{python}", "{folder}/bowl.py"]) != first
    option = digest(command=["{python}", "{folder}/bowl.py", "--file={folder}/data.csv"])
    (tmp_path / "data.csv").write_text("1", encoding="utf-8")
    assert digest(command=["{python}", "{folder}/bowl.py", "--file={folder}/data.csv"]) != option


@pytest.mark.parametrize(
    ("changed", "field", "statement"),
    [
        ({"command": "python bowl.py"}, "simulator.command", "a list of words is expected"),
        ({"command": [1]}, "simulator.command.0", "a list of words is expected"),
        ({"command": []}, "simulator.command", "at least 1 entry"),
        ({"parameters": None}, "simulator.parameters", "this key is required"),
        ({"parameters": {"x": 0.5}}, "simulator.parameters.x", ""),
        ({"results": None}, "simulator.results", "this key is required"),
        ({"comand": ["x"]}, "simulator.comand", "not a key of a simulator's descriptor"),
        ({"fmu": "model.fmu"}, "simulator.fmu", "not a key of a simulator's descriptor"),
        ({"name": "../bowl"}, "simulator.name", ""),
        ({"timeout": float("inf")}, "simulator.timeout", ""),
        ({"repeats": {"count": 0}}, "simulator.repeats.count", ""),
    ],
)
def test_a_description_that_cannot_be_used_is_refused_by_its_key(
    tmp_path: Path, changed: dict[str, Any], field: str, statement: str
) -> None:
    with pytest.raises(CampaignError) as refused:
        code.read(written(tmp_path, **changed), allowed=True)
    problems = [p for p in refused.value.problems if p.field == field]
    assert len(problems) == 1, refused.value
    assert statement in problems[0].message
    assert "bowl" not in installed.simulators()


def test_it_does_not_take_the_place_of_an_installed_simulator(tmp_path: Path) -> None:
    with adversary(), pytest.raises(CampaignError) as refused:
        code.read(written(tmp_path, name="adversary"), allowed=True)
    assert [(p.field, p.given) for p in refused.value.problems] == [("simulator.name", "adversary")]


def test_another_file_takes_the_place_of_an_earlier_one(tmp_path: Path) -> None:
    for unit in ("m", "km"):
        code.read(written(tmp_path, results={"separation": {"unit": unit}}), allowed=True)
        entry = installed.catalogue().simulator("bowl")
        assert entry is not None
        assert entry.results[0].unit == unit


def test_it_evaluates_on_this_machine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(SETTING, "dask://127.0.0.1:1?patience=1")
    file = written(tmp_path)
    system = opened.system(code.read(file, allowed=True))
    assert (system.elsewhere, system.slots) == ("", 1)
    system.close()
    assert refused(capsys, "run", file, "--allow-code", "--evaluator", "local:2") == RefusalCode.NOT_THERE


def test_a_library_and_a_file_that_is_not_there_are_as_without_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["run", str(tmp_path / "none.yaml"), "--allow-code"]) == WRONG_INPUT
    with pytest.raises(CampaignError) as unreadable:
        load_file(tmp_path / "none.yaml")
    assert str(unreadable.value.problems[0]) in capsys.readouterr().err


def test_files_that_cannot_be_read_are_not_in_the_digest(tmp_path: Path) -> None:
    code.read(written(tmp_path, command=["/" + "x" * 5000, str(tmp_path), "{folder}/bowl.py"]), allowed=True)
    known = installed.simulators()["bowl"]
    assert isinstance(known, InlineProgram)
    assert [path.name for path in known.covered] == ["bowl.py"]
    assert known.covers.endswith("and of bowl.py")


@pytest.fixture
def ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Path:
    """The results of a run of a command, in a process that has forgotten it."""
    monkeypatch.setattr(offered, "SPOT_CHECKS", 3)  # each in a process of its own
    monkeypatch.setattr(judge.audit, "__defaults__", (offered.AT_MOST, 3))
    out = tmp_path / "out"
    assert invoke(["run", str(written(tmp_path)), "--allow-code", "--json", "--out", str(out)]) == 2
    forgotten()
    capsys.readouterr()
    return out


def forgotten() -> None:
    installed.simulators().pop("bowl", None)
    installed.catalogue.cache_clear()


def extended(out: Path, *options: str) -> int:
    return invoke(["run", "--continue", str(out), "--budget", "+20", *options])


@pytest.mark.nightly
def test_a_run_of_a_command_is_extended_where_that_is_permitted(
    ended: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = tmp_path / "more"
    assert extended(ended, "--out", str(more)) == WRONG_INPUT
    errors = capsys.readouterr().err
    assert refusal(errors) == RefusalCode.CODE_NOT_PERMITTED
    assert "'{python}' -S '{folder}/bowl.py'" in errors
    assert extended(ended, "--allow-code", "--out", str(more)) == 2
    before, after = (json.loads((folder / "result.json").read_text()) for folder in (ended, more))
    assert after["continues"] == {"run": str(ended), "digest": before["digest"]}
    assert after["command_given"] == before["command_given"]
    assert after["versions"]["simulator"] == before["versions"]["simulator"]
    assert (more / "simulator.yaml").read_text() == (ended / "simulator.yaml").read_text()
    earlier, later = read_folder(ended)[1].evaluations(1), read_folder(more)[1].evaluations(1)
    assert earlier is not None
    assert later is not None
    assert len(later.status) > len(earlier.status)
    assert later.costs[: len(earlier.costs)].tolist() == earlier.costs.tolist()
    assert invoke(["audit", str(more)]) == 0


@pytest.mark.nightly
def test_a_run_of_a_command_that_is_not_as_it_was_is_not_extended(
    ended: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def again() -> str:
        assert extended(ended, "--allow-code") == WRONG_INPUT
        forgotten()
        return capsys.readouterr().err

    program = (tmp_path / "bowl.py").read_text()
    (tmp_path / "bowl.py").write_text(program + "# changed")
    assert refusal(again()) == RefusalCode.OTHER_CODE
    (tmp_path / "bowl.py").write_text(program)
    description = (ended / "simulator.yaml").read_text()
    for content, why in (
        ("a: [1", "simulator.yaml in it cannot be read"),
        ("name: bowl", "this key is required"),
        (f"{description}timeout: 21\n", "the key 'timeout' is given twice"),
    ):
        (ended / "simulator.yaml").write_text(content)
        assert why in again()
    (ended / "simulator.yaml").unlink()
    assert "simulator.yaml" in again()
    (ended / "simulator.yaml").write_text(description)
    result = json.loads((ended / "result.json").read_text())
    for given, why in (
        ({"command_given": {"file": "x", "folder": str(tmp_path / "gone")}}, "no longer exists"),
        ({"command_given": {"file": "x"}}, "does not state where its campaign file was"),
        ({"command_given": [1]}, "does not state where its campaign file was"),
    ):
        (ended / "result.json").write_text(json.dumps(result | given))
        assert why in again()


def test_a_stored_run_has_no_command_to_permit(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "run", "--continue", "R-0001", "--budget", "+20", "--allow-code") == RefusalCode.OPTIONS
