"""`clearance run --out` in a folder with results: those of the same campaign go when the run begins, others stay."""

from __future__ import annotations

import errno
import json
import os
import shutil
from pathlib import Path
from typing import Any

import pytest

from campaigns.refusals import RefusalCode
from clearance.cli import INCONCLUSIVE, INTERNAL, INTERRUPTED, WRONG_INPUT, _exports, invoke
from tests.given.case_campaigns import searching
from tests.given.refused_commands import refused
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.simulators.cluster.address import EvaluatorLost
from worker.running.runs.runner import execute

SHORT: dict[str, Any] = {"scenario__horizon": 4.0, "stages__certify": None}
"""Without a sample or a second method: inconclusive."""
OWN = ("notes.txt", "run.json", "junit.xml")
"""Files in the folder that no run of this command wrote."""


def write(file: Path, evaluations: int) -> Path:
    """Write a campaign with this budget into a file."""
    campaign = searching({"method": "direct", "evaluations": evaluations}, **SHORT)
    file.write_text(json.dumps(campaign.document()), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a campaign, another one, and the results of the first."""
    folder = tmp_path_factory.mktemp("ended")
    write(folder / "other.json", 90)
    campaign = write(folder / "campaign.json", 60)
    assert invoke(["run", str(campaign), "--out", str(folder / "out")]) == INCONCLUSIVE
    for name in OWN:
        (folder / "out" / name).write_text("own", encoding="utf-8")
    return folder


@pytest.fixture
def here(ended: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it, in which the command runs."""
    monkeypatch.chdir(shutil.copytree(ended, tmp_path / "here"))
    return tmp_path / "here"


def files(folder: str = "out") -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def fails(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """Whatever is simulated from now on ends so."""

    def failing(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("worker.running.runs.runner.execute", failing)


FAILURES = [
    (RuntimeError("a bug"), INTERNAL),
    (CampaignUnusable([]), INTERNAL),
    (EvaluatorLost("the cluster has gone"), INTERNAL),
    (KeyboardInterrupt(), INTERRUPTED),
    (MemoryError(), WRONG_INPUT),
]


@pytest.mark.by_day(2)
@pytest.mark.parametrize(("error", "code"), FAILURES, ids=[type(error).__name__ for error, _ in FAILURES])
def test_a_run_that_fails_leaves_no_earlier_verdict(
    here: Path, error: BaseException, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert invoke(["audit", "out"]) == 0
    fails(monkeypatch, error)
    assert invoke(["run", "campaign.json", "--out", "out"]) == code
    assert files() == dict.fromkeys(OWN, b"own")
    assert invoke(["audit", "out"]) == WRONG_INPUT


def test_the_same_campaign_replaces_its_results(here: Path) -> None:
    (here / "out" / "trace-F9.csv").write_text("of an earlier run", encoding="utf-8")
    before = files()
    assert invoke(["run", "campaign.json", "--out", "out"]) == INCONCLUSIVE
    assert set(files()) == set(before) - {"trace-F9.csv"}
    assert invoke(["audit", "out"]) == 0


@pytest.mark.parametrize("document", [None, "other.json"])
def test_the_results_of_another_campaign_are_refused(
    here: Path, document: str | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also if the campaign.json among them was replaced by the campaign that is to be run."""
    if document is not None:
        shutil.copy(document, "out/campaign.json")
    before = files()
    fails(monkeypatch, AssertionError("it was simulated"))
    assert refused(capsys, "run", "other.json", "--out", "out") == RefusalCode.OTHER_CAMPAIGN
    assert files() == before


@pytest.mark.parametrize("content", ["", "{", "[]", "3", "{}", '{"verdict": "passed", "digest": 3}', "\ud800"])
def test_a_result_that_no_run_wrote_is_refused(
    here: Path, content: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "of-others").mkdir()
    (here / "of-others" / "result.json").write_bytes(content.encode("utf-8", "surrogatepass"))
    (here / "of-others" / "evaluations.csv").write_text("own", encoding="utf-8")
    before = files("of-others")
    fails(monkeypatch, AssertionError("it was simulated"))
    assert refused(capsys, "run", "campaign.json", "--out", "of-others") == RefusalCode.EXISTS
    assert files("of-others") == before


@pytest.mark.parametrize("arguments", [["missing.json"], ["campaign.json", "--evaluator", "dask://nowhere:1"]])
def test_wrong_input_removes_nothing(here: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str]) -> None:
    monkeypatch.setenv("CLEARANCE_EVALUATOR", "")  # which the option sets for the process
    before = files()
    assert invoke(["run", *arguments, "--out", "out"]) == WRONG_INPUT
    assert files() == before


def test_the_campaign_among_the_results_may_be_run(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = files()["campaign.json"]
    assert invoke(["run", "out/campaign.json", "--out", "out"]) == INCONCLUSIVE
    fails(monkeypatch, RuntimeError("a bug"))
    assert invoke(["run", "out/campaign.json", "--out", "out"]) == INTERNAL
    assert files() == {"campaign.json": campaign, **dict.fromkeys(OWN, b"own")}


@pytest.mark.nightly
def test_the_campaign_that_a_failed_run_left_may_be_run_again(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its text is that which is written; with a baseline it is another one."""
    with monkeypatch.context() as broken:
        fails(broken, RuntimeError("a bug"))
        assert invoke(["run", "out/campaign.json", "--out", "out"]) == INTERNAL
    campaign = files()["campaign.json"]
    invoke(["run", "campaign.json", "--out", "before"])
    assert refused(capsys, "run", "out/campaign.json", "--baseline", "before", "--out", "out") == RefusalCode.EXISTS
    assert files() == {"campaign.json": campaign, **dict.fromkeys(OWN, b"own")}
    assert invoke(["run", "out/campaign.json", "--out", "out"]) == INCONCLUSIVE
    assert files()["campaign.json"] == campaign


REPLACED = ("evaluations.csv", "evaluations.npz", "evidence.json", "campaign.json", "trace-F1.csv", "trace-nominal.csv")


@pytest.mark.by_day(5)
@pytest.mark.parametrize("name", [*REPLACED, "capsule-F12.zip"])
@pytest.mark.parametrize("kind", ["file", "folder", "link"])
def test_files_that_no_run_wrote_are_refused(
    here: Path, name: str, kind: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of a run and of an extension, before anything is simulated."""
    own = Path("own", name)
    own.parent.mkdir()
    {"file": lambda: own.write_bytes(b"own"), "folder": own.mkdir, "link": lambda: own.symlink_to("nowhere")}[kind]()
    extension = ("--continue", "out", "--budget", "+20")
    fails(monkeypatch, AssertionError("it was simulated"))
    for arguments in (("campaign.json",), extension):
        assert refused(capsys, "run", *arguments, "--out", "own") == RefusalCode.EXISTS
    assert [path.name for path in Path("own").iterdir()] == [name]
    assert kind != "file" or own.read_bytes() == b"own"


@pytest.mark.parametrize("link", ["symlink_to", "hardlink_to"])
def test_a_campaign_is_not_replaced_by_its_own_results(
    here: Path, link: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """By whatever name it is given."""
    getattr(Path("mine.json"), link)("campaign.json")
    before = Path("campaign.json").read_bytes()
    for name in ("campaign.json", "mine.json"):
        assert refused(capsys, "run", name, "--out", ".") == RefusalCode.EXISTS
    assert Path("campaign.json").read_bytes() == before


def test_a_run_deletes_only_what_runs_write(here: Path) -> None:
    """Neither the first one in a folder nor a later one."""
    own = ("trace-mine.csv", "trace-F1-mine.csv", "capsule-Flight.zip", "trace-F.csv", "simulator.yaml")
    Path("own").mkdir()
    for name in own:
        Path("own", name).write_bytes(b"own")
    for _ in range(2):
        assert invoke(["run", "campaign.json", "--out", "own"]) == INCONCLUSIVE
        assert {name: files("own")[name] for name in own} == dict.fromkeys(own, b"own")


def test_what_was_saved_from_a_service_is_replaced_until_it_is_changed(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def download(folder: Path) -> None:
        folder.mkdir()
        (folder / "evaluations.csv").write_bytes(b"of a service")

    for folder in (Path("saved"), Path("changed")):
        folder.mkdir()
        _exports.save(folder, download)
    Path("changed", "evaluations.csv").write_bytes(b"own")
    assert refused(capsys, "run", "campaign.json", "--out", "changed") == RefusalCode.EXISTS
    assert files("changed")["evaluations.csv"] == b"own"
    assert invoke(["run", "campaign.json", "--out", "saved"]) == INCONCLUSIVE


def _full(monkeypatch: pytest.MonkeyPatch, where: str) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(where, full)


def _deleted(monkeypatch: pytest.MonkeyPatch, folder: str) -> None:
    def deleting(*arguments: Any, **named: Any) -> Any:
        verdict = execute(*arguments, **named)
        shutil.rmtree(folder)
        return verdict

    monkeypatch.setattr("worker.running.runs.runner.execute", deleting)


BROKEN = {
    "full, a table": (_full, "clearance.local.results._write_evaluations"),
    "full, arrays": (_full, "clearance.local.results._write_bits"),
    "full, a capsule": (_full, "clearance.cli._capsule.write_capsules"),
    "deleted": (_deleted, "new"),
}


@pytest.mark.by_day(2)
@pytest.mark.parametrize("as_json", [False, True])
@pytest.mark.parametrize("broken", BROKEN)
def test_a_verdict_whose_results_cannot_be_written_is_printed(
    here: Path, broken: str, as_json: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The files of a job have it; the exit code is not that of a verdict, and no file of the results is left."""
    happens, where = BROKEN[broken]
    happens(monkeypatch, where)
    options = ("--json",) if as_json else ()
    assert invoke(["run", "campaign.json", "--out", "new", "--junit", "junit.xml", *options]) == WRONG_INPUT
    out, err = capsys.readouterr()
    assert "--out new" in err
    assert "Traceback" not in err
    assert "Results in" not in out
    verdict = json.loads(out)["verdict"] if as_json else out
    assert "inconclusive" in verdict.lower()
    assert "clearance replay" not in Path("junit.xml").read_text(), "nothing is stored that could be replayed"
    assert not Path("new").exists() or files("new") == {}


@pytest.mark.nightly
def test_another_baseline_is_no_other_campaign(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "campaign.json", "--baseline", "out", "--out", "new"]) == INCONCLUSIVE
    compared = json.loads(files("new")["result.json"])["digest"]
    assert compared != json.loads(files()["result.json"])["digest"]
    assert invoke(["run", "campaign.json", "--out", "new"]) == INCONCLUSIVE
    assert invoke(["run", "campaign.json", "--baseline", "out", "--out", "new"]) == INCONCLUSIVE
    assert json.loads(files("new")["result.json"])["digest"] == compared
    before = files()
    assert refused(capsys, "run", "campaign.json", "--baseline", "out", "--out", "./out") == RefusalCode.OPTIONS
    assert files() == before, "the baseline would be lost if the run failed"


@pytest.mark.nightly
def test_an_extension_replaces_what_it_extends_at_its_end(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    extension = ["run", "--continue", "out", "--budget", "+20", "--out"]
    before = files()
    with monkeypatch.context() as broken:
        fails(broken, RuntimeError("a bug"))
        assert invoke([*extension, "./out"]) == INTERNAL
    assert files() == before
    assert invoke([*extension, "more"]) == INCONCLUSIVE
    assert invoke([*extension, "more"]) == INCONCLUSIVE, "the same extension again"
    assert refused(capsys, "run", "other.json", "--out", "more") == RefusalCode.OTHER_CAMPAIGN
    with monkeypatch.context() as broken:
        fails(broken, RuntimeError("a bug"))
        assert invoke([*extension, "more"]) == INTERNAL
    assert files("more") == {}
    assert invoke([*extension, "more"]) == INCONCLUSIVE
    assert invoke([*extension, "out"]) == INCONCLUSIVE
    assert json.loads(files()["result.json"])["continues"]["run"] == "out"
    assert refused(capsys, *extension, "more") == RefusalCode.OTHER_CAMPAIGN, "it extends another run now"
