"""`clearance audit` and `clearance replay` of a run that a service has: they read its rows, which are an export."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import httpx
import pytest
import sqlalchemy as sa

from backend.db import labels, revision
from backend.db.digest import results_digest
from backend.db.engine import connect, default_url, read
from backend.db.tables import Base, CampaignRow, EvaluationChunk, Run
from backend.exports import endpoints
from backend.exports.formats import record_sqlite3
from backend.exports.formats.record_sqlite3 import PRIVATE, TABLES
from backend.settings import Settings
from campaigns.refusals import RefusalCode
from clearance.cli import CODES, INTERNAL, VIOLATED, WRONG_INPUT, invoke
from tests.given.at_night import nightly_but
from tests.given.corrupted_records import stored
from tests.given.databases import KINDS
from tests.given.finished_runs import finish
from tests.given.refused_commands import refusal, refused
from tests.given.service import Service
from tests.given.submissions import submit
from worker.engine.stages.parts import offered
from worker.evidence.audit import judge

RUN = "R-0001"


@pytest.fixture
def served(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Service]:
    """A service with a cleared run, and a command line elsewhere that has only its token."""
    monkeypatch.setattr(judge.audit, "__defaults__", (judge.NOTHING, 3, 2))
    data = shutil.copytree(folder, tmp_path / "copied")
    service = Service(Settings(data=data, database=default_url(data), pages=tmp_path / "dist"))
    service.start()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CLEARANCE_TOKEN", service.token())
    yield service
    service.stop()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Of the database; with fewer simulations by the reference integrator."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(offered, "SPOT_CHECKS", 2)
        patch.setattr(offered, "AT_MOST", 3)
        folder = tmp_path_factory.mktemp("recorded") / "written"
        folder.mkdir()
        stored(folder, "cleared").dispose()
        yield folder


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    capsys.readouterr()
    code = invoke([*arguments])
    return code, capsys.readouterr().out


@pytest.mark.nightly
def test_an_audit_from_the_service_is_that_of_its_database(
    served: Service, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    there = printed(capsys, "audit", RUN, "--data", str(served.settings.data), "--json")
    here = printed(capsys, "audit", RUN, "--service", served.url, "--json")
    assert here == there
    assert (here[0], json.loads(here[1])["follows"]) == (0, True)
    monkeypatch.setenv("CLEARANCE_SERVICE", served.url)
    assert printed(capsys, "audit", "1", "--json") == (0, here[1].replace(f'"{RUN}"', '"1"', 1))
    assert not list(Path().glob("*.sqlite3*")), "nothing is left"


def test_replays_from_the_service_have_the_same_bits(
    served: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    token = tmp_path / "token"
    token.write_text(served.token("another"), encoding="utf-8")
    where = ("--service", served.url, "--token-file", str(token))
    code, text = printed(capsys, "replay", RUN, "F1", "direct:7", *where, "--json")
    assert (code, [case["agreement"] for case in json.loads(text)["cases"]]) == (0, ["same bits"] * 2)
    code, text = printed(capsys, "audit", RUN, *where, "--replay", "3", "--json")
    assert (code, json.loads(text)["replay"]["agrees"]) == (0, True)


def test_a_service_with_a_forged_cost_is_found_out(served: Service, capsys: pytest.CaptureFixture[str]) -> None:
    with served.engine.begin() as writer:
        of = (EvaluationChunk.position == 2, EvaluationChunk.first == 0)
        costs = writer.scalars(sa.select(EvaluationChunk.costs).where(*of)).one()
        writer.execute(sa.update(EvaluationChunk).where(*of).values(costs=costs[8:16] + costs[8:]))
    assert printed(capsys, "audit", RUN, "--service", served.url)[0] == VIOLATED
    code, text = printed(capsys, "replay", RUN, "direct:0", "--service", served.url)
    assert (code, "differs" in text) == (VIOLATED, True)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("command", ["audit", "replay"])
def test_a_stated_place_is_preferred_to_the_environment(
    command: str, served: Service, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CLEARANCE_SERVICE", "http://127.0.0.1:9")
    data = str(served.settings.data)
    assert printed(capsys, command, RUN, "--data", data)[0] == 0
    with monkeypatch.context() as there:
        there.setenv("CLEARANCE_DATA", data)
        assert printed(capsys, command, RUN)[0] == 0
        assert printed(capsys, command, RUN, "--service", served.url)[0] == 0
    with monkeypatch.context() as there:
        file = Path("address")
        file.write_text(served.settings.database_url)
        there.setenv("CLEARANCE_DATABASE_FILE", str(file))
        assert printed(capsys, command, RUN)[0] == 0
    Path(RUN).mkdir()
    assert printed(capsys, command, f"./{RUN}")[0] == WRONG_INPUT, "a folder of this name"
    assert printed(capsys, command, RUN, "--service", served.url)[0] == 0


def export(served: Service, *arguments: str) -> int:
    return invoke(["export", RUN, "--service", served.url, *arguments])


@pytest.mark.nightly
@pytest.mark.parametrize("exported", [pytest.param(False, marks=pytest.mark.nightly), True], ids=["empty", "exported"])
def test_a_folder_without_a_run_is_not_taken_for_the_run_of_its_name(
    exported: bool, served: Service, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By any command that reads a folder or a stored run."""
    data, campaign = ("--data", str(served.settings.data)), "asked/campaign.yaml"
    assert export(served, "--out", "asked", "--file", "campaign.yaml") == 0
    if exported:
        assert export(served) == 0
    else:
        Path(RUN).mkdir()
    content = {path.name: path.read_bytes() for path in Path(RUN).iterdir()}
    assert refused(capsys, "audit", RUN) == RefusalCode.NO_DATABASE
    for where in (data, ("--service", served.url)):
        assert printed(capsys, "audit", RUN, *where)[0] == 0
        assert printed(capsys, "audit", RUN, "--replay", "1", *where)[0] == 0
        assert printed(capsys, "replay", RUN, "direct:7", *where)[0] == 0
    with monkeypatch.context() as there:
        there.setenv("CLEARANCE_SERVICE", served.url)
        for run in (RUN, "1"):
            assert printed(capsys, "audit", run)[0] == 0
            assert printed(capsys, "replay", run, "direct:7")[0] == 0
        for command in ("audit", "replay"):
            assert printed(capsys, command, f"./{RUN}")[0] == WRONG_INPUT, "the folder"
    code, text = printed(capsys, "run", campaign, "--baseline", RUN, "--json", *data)
    assert (code in CODES.values(), json.loads(text)["regression"]["run"]) == (True, RUN)
    assert printed(capsys, "run", campaign, "--baseline", f"./{RUN}", *data)[0] == WRONG_INPUT
    code, text = printed(capsys, "run", "--continue", RUN, "--budget", "+10", "--json", *data)
    assert (code in CODES.values(), json.loads(text)["continues"]["as"]) == (True, "R-0002")
    assert printed(capsys, "run", "--continue", f"./{RUN}", "--budget", "+10", *data)[0] == WRONG_INPUT
    assert {path.name: path.read_bytes() for path in Path(RUN).iterdir()} == content
    options = ("--budget", "+10", "--out", RUN, "--json")
    assert json.loads(printed(capsys, "run", "--continue", RUN, *options, *data)[1])["continues"]["as"] == "R-0003"


@pytest.mark.nightly
def test_a_folder_with_a_run_may_have_the_name_of_a_run(served: Service, capsys: pytest.CaptureFixture[str]) -> None:
    assert export(served, "--out", "asked", "--file", "campaign.yaml") == 0
    assert invoke(["run", "asked/campaign.yaml", "--out", RUN]) in CODES.values()
    for folder in (RUN, f"./{RUN}"):
        for command in ("audit", "replay"):
            assert printed(capsys, command, folder)[0] == 0
        options = ("--baseline", folder, "--json")
        assert json.loads(printed(capsys, "run", "asked/campaign.yaml", *options)[1])["regression"]["run"] == folder
    code, text = printed(capsys, "run", "--continue", RUN, "--budget", "+10", "--json")
    assert (code in CODES.values(), json.loads(text)["continues"]["run"]) == (True, RUN)


def test_an_export_that_saves_nothing_makes_no_folder(
    served: Service, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert export(served, "--file", "nope.csv") == WRONG_INPUT
    assert export(served, "--file", "nothing") == WRONG_INPUT
    assert export(served, "--list") == 0
    assert refused(capsys, "export", "R-0042", "--service", served.url) == "not-found"
    monkeypatch.setenv("CLEARANCE_TOKEN", "another")
    assert export(served) == WRONG_INPUT
    assert invoke(["export", RUN, "--service", "http://127.0.0.1:9", "--patience", "0"]) == INTERNAL
    assert not list(Path().glob("R-*"))


@pytest.mark.parametrize("command", ["audit", "replay"])
def test_what_cannot_be_had_is_a_sentence(
    command: str, served: Service, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    there = ("--service", served.url)
    assert refused(capsys, command, RUN, "--data", ".", *there) == RefusalCode.OPTIONS
    assert refused(capsys, command, "R-0042", *there) == "not-found"
    assert invoke([command, "out", *there]) == WRONG_INPUT
    assert "R-0001" in capsys.readouterr().err
    monkeypatch.delenv("CLEARANCE_TOKEN")
    assert invoke([command, RUN, *there]) == WRONG_INPUT
    assert "CLEARANCE_TOKEN" in capsys.readouterr().err


NONE = (b"", b"<html>" * 999, "a column", "an array")
READ = [(command, content) for content in NONE for command in ("audit", "replay")]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("read_as", nightly_but([READ[k] for k in (0, 3, 4, 7)], READ), ids=str)
def test_a_record_that_is_none_is_a_sentence(
    read_as: tuple[str, bytes | str], served: Service, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Whatever a service sends."""
    command, content = read_as
    record = b"".join(record_sqlite3.record(served.engine, 1)) if isinstance(content, str) else content
    if content == "a column":
        record = record.replace(b"campaign_digest", b"campaign_digesX")
    elif content == "an array":
        with served.engine.begin() as writer:
            writer.execute(sa.update(EvaluationChunk).values(points=b"short"))
        record = b"".join(record_sqlite3.record(served.engine, 1))
    made = replace(record_sqlite3.export, streamed=lambda engine, run_id: iter([record]))
    monkeypatch.setattr(endpoints, "named", lambda file: (made, ""))
    assert refused(capsys, command, RUN, "--service", served.url) == RefusalCode.UNREADABLE


@pytest.mark.parametrize("command", ["audit", "replay"])
def test_a_record_of_another_schema_is_refused_with_what_can_be_done_about_its_service(
    command: str, served: Service, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """There is no database here that could be migrated."""
    for version, stated in ((sorted(revision.known())[-2], "update that service"), ("9999", "newer version")):
        monkeypatch.setattr(record_sqlite3, "revision", SimpleNamespace(newest=lambda version=version: version))
        assert invoke([command, RUN, "--service", served.url]) == WRONG_INPUT
        error = capsys.readouterr().err
        assert refusal(error) == RefusalCode.OTHER_SCHEMA
        assert f"{served.url} has schema {version}" in error
        assert (stated in error, "--data" in error) == (True, False)


@pytest.mark.parametrize("database", [KINDS[0], pytest.param(KINDS[1], marks=pytest.mark.nightly)], indirect=True)
def test_the_record_has_all_results_and_nothing_else(service: Service, client: httpx.Client, tmp_path: Path) -> None:
    for name in ("One", "Two"):
        submit(client, name=name)
        finish(service)
    assert client.patch(f"/api/v1/runs/{RUN}", json={"notes": "secret"}).is_success
    answer = client.get(f"/api/v1/runs/{RUN}/exports/record.sqlite3")
    (tmp_path / "record.sqlite3").write_bytes(answer.content)
    assert b"secret" not in answer.content
    engine = connect(f"sqlite:///{tmp_path / 'record.sqlite3'}")
    with read(engine) as here, read(service.engine) as there:
        assert results_digest(here, 1) == results_digest(there, 1)
        assert here.scalars(sa.select(Run.id)).all() == [1]
        assert here.scalar(sa.select(sa.func.count()).select_from(CampaignRow)) == 1
        names = {table.__tablename__ for table in TABLES} | {"alembic_version"}
        assert {*sa.inspect(here).get_table_names()} == names < {*Base.metadata.tables} | names
    engine.dispose()
    assert {c.name for c in Run.__table__.columns} > PRIVATE


@pytest.mark.nightly
def test_the_files_of_a_job_name_the_stored_run_that_extends_another_one(
    served: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the output does, and as `follow` and `show` of the new run do."""
    with served.engine.begin() as writer:
        labels.store(writer, 1, {"branch": "main"})
    monkeypatch.setenv("CLEARANCE_SERVICE", served.url)
    files = {name: tmp_path / name for name in ("junit", "summary", "sarif")}
    wanted = [part for name in files for part in (f"--{name}", str(files[name]))]
    onward = ["run", "--continue", RUN, "--budget", "+10", "--data", str(served.settings.data)]
    places: dict[str, str] = {}
    for command in ([*onward, "--out", "extended"], ["follow", "R-0002"]):
        code, output = printed(capsys, *command, *wanted)
        assert code in CODES.values()
        places |= {f"{command[0]} {name}": file.read_text() for name, file in files.items()} | {command[0]: output}
    places["show"] = printed(capsys, "show", "R-0002")[1]
    for place, text in places.items():
        assert re.search(rf"[Ee]xtends {RUN}\b", text), place
        assert "R-0002" in text, place
        assert "main" in text or place in ("run", "follow"), place
    assert [json.loads(places[f"{one} sarif"])["runs"][0]["properties"]["run"] for one in ("run", "follow")] == [
        "R-0002"
    ] * 2
    for one in ("run", "follow"):
        assert '<property name="run" value="R-0002" />' in places[f"{one} junit"]
        assert '<property name="label.branch" value="main" />' in places[f"{one} junit"]
