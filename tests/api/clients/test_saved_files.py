"""Files that a command saves from a service: they replace what such a command saved, and nothing else."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from campaigns.refusals import RefusalCode
from clearance.cli import _exports, invoke
from clearance.cli._following import FILES, PICTURE
from clearance.cli._sweep import TABLE
from tests.given.refused_commands import refused
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

OWN = b"precious"
RUN = "R-0001"
AWAY = ("--service", "http://127.0.0.1:9", "--patience", "0")
"""A service that cannot be reached: what is refused then was refused before anything was sent."""


@pytest.fixture
def here(service: Service, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a campaign, in which commands find the service; it has a run that is done."""
    monkeypatch.setenv("CLEARANCE_SERVICE", service.url)
    monkeypatch.setenv("CLEARANCE_TOKEN", service.token())
    monkeypatch.chdir(tmp_path)
    Path("campaign.yaml").write_text(f"# precious comment\n{yaml.safe_dump(campaign())}", encoding="utf-8")
    with service.signed_in() as client:
        submit(client)
        finish_fully(service)
    return tmp_path


def content(folder: str) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in Path(folder).iterdir() if path.is_file()}


COMMANDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "export": (("export", RUN), FILES),
    "export --file": (("export", RUN, "--file", "traces.csv"), ("traces.csv",)),
    "follow": (("follow", RUN), FILES),
    "submit": (("submit", "campaign.yaml"), FILES),
    "submit --reuse": (("submit", "campaign.yaml", "--reuse"), FILES),
    "submit --sweep": (("submit", "campaign.yaml", "--sweep", "avoider.d_0=1,2"), (TABLE,)),
}


@pytest.mark.by_day(2)
@pytest.mark.parametrize("command", COMMANDS)
def test_no_file_of_the_user_is_replaced(command: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Whichever it is; nothing is sent before."""
    arguments, names = COMMANDS[command]
    for name in names:
        folder = here / f"with-{name}"
        folder.mkdir()
        (folder / name).write_bytes(OWN)
        assert refused(capsys, *arguments, *AWAY, "--out", folder) == RefusalCode.EXISTS
        assert content(str(folder)) == {name: OWN}


@pytest.mark.by_day(2)
@pytest.mark.parametrize("command", COMMANDS)
def test_no_results_of_a_local_run_are_mixed_with_those_of_a_service(
    command: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("out").mkdir()
    Path("out", "result.json").write_bytes(OWN)
    assert refused(capsys, *COMMANDS[command][0], *AWAY, "--out", "out") == RefusalCode.EXISTS
    assert content("out") == {"result.json": OWN}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("link", [False, True])
def test_a_campaign_is_not_replaced_by_its_own_submission(
    link: bool, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also if the service had sent it, and by its other names."""
    before = Path("campaign.yaml").read_bytes()
    Path("link.yaml").symlink_to("campaign.yaml")
    source = "link.yaml" if link else "campaign.yaml"
    for options in ((), ("--reuse",)):
        assert refused(capsys, "submit", source, *options, *AWAY, "--out", ".") == RefusalCode.EXISTS
    assert Path("campaign.yaml").read_bytes() == before
    assert invoke(["export", RUN, "--out", "e"]) == 0
    assert refused(capsys, "submit", "e/campaign.yaml", *AWAY, "--out", "e") == RefusalCode.EXISTS


def test_what_was_saved_is_replaced_until_the_user_changes_it(
    here: Path, service: Service, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also by the files of a later run."""
    Path("out").mkdir()
    Path("out", "notes.txt").write_bytes(OWN)
    assert invoke(["follow", RUN, "--out", "out"]) == 0
    assert invoke(["export", RUN, "--out", "out"]) == 0
    with service.signed_in() as client:
        submit(client, name="Second")
        finish_fully(service)
    assert invoke(["follow", "R-0002", "--out", "out"]) == 0
    assert json.loads(Path("out", "run.json").read_text())["run"]["id"] == "R-0002"
    assert set(content("out")) == {*FILES, "notes.txt", _exports.LIST}
    for change in (_edited, _directory, _dangling):
        change(Path("out", "report.html"))
        before = content("out")
        for command in ("export", "follow"):
            assert refused(capsys, command, RUN, "--out", "out") == RefusalCode.EXISTS
        assert content("out") == before
    Path("out", "report.html").unlink()
    assert invoke(["export", RUN, "--out", "out"]) == 0
    assert Path("out", "notes.txt").read_bytes() == OWN


def _edited(file: Path) -> None:
    file.write_bytes(file.read_bytes() + b"\n")


def _directory(file: Path) -> None:
    file.unlink()
    file.mkdir()


def _dangling(file: Path) -> None:
    file.rmdir()
    file.symlink_to("nowhere")


@pytest.mark.nightly
def test_the_picture_of_a_step_of_github_replaces_no_file(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(here / "summary"))
    command = ("follow", RUN, "--summary", "summary", "--out")
    Path("out").mkdir()
    Path("out", PICTURE).write_bytes(OWN)
    assert refused(capsys, *command, "out") == RefusalCode.EXISTS
    assert content("out") == {PICTURE: OWN}
    for _ in range(2):
        assert invoke([*command, "other"]) == 0
        assert content("other")[PICTURE].startswith(b"<svg")


def test_a_name_that_leaves_the_folder_is_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """And the file of that name is not touched."""
    Path("own.txt").write_bytes(OWN)
    Path("out").mkdir()
    for name in ("../own.txt", str(here / "own.txt")):
        assert invoke(["export", RUN, "--out", "out", "--file", name]) == 3
        assert repr(name) in capsys.readouterr().err
    assert (content("out"), Path("own.txt").read_bytes()) == ({}, OWN)


def test_what_was_saved_before_a_failure_is_listed(tmp_path: Path) -> None:
    """Then the next command may replace it; what was incomplete is gone."""

    def download(folder: Path) -> None:
        folder.mkdir()
        (folder / "run.json").write_bytes(b"{}")
        raise OSError(28, "No space left on device")

    with pytest.raises(Exception, match="No space left"):
        _exports.save(tmp_path, download)
    assert set(content(str(tmp_path))) == {_exports.LIST, "run.json"}
    assert _exports.others_files(tmp_path, ["run.json"]) == []
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]
