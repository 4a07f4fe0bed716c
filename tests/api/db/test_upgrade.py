"""Runs stored by an earlier version: after the migration all their results are readable everywhere.

`stored/revision-0009.sqlite3.gz` was written by the code of that revision: case 1 with a step of 0.01 s, two searches,
certify, Morris and Sobol; R-0001 is violated, R-0002 inconclusive.
"""

from __future__ import annotations

import gzip
import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.db.engine import connect, default_url, migrate, read
from backend.db.rows import as_finding, as_result
from backend.db.tables import Audit, CampaignRow, Finding, Run, Signoff, Stage
from backend.settings import Settings
from campaigns.asked.spec import seedless
from campaigns.results import ValidateResult, Verdict
from campaigns.versions import UNDIGESTED
from clearance.cli import invoke
from tests.audited import audited
from tests.given.service import Service
from tests.given.stored_sizes import stored_size
from worker.evidence.audit.judge import Item
from worker.evidence.audit.record import SEAL, of_database
from worker.running.runs import audited as audits

STORED = Path(__file__).parents[1] / "stored" / "revision-0009.sqlite3.gz"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("earlier")
    (folder / "clearance.sqlite3").write_bytes(gzip.decompress(STORED.read_bytes()))
    return folder


@pytest.fixture(scope="module")
def before(folder: Path) -> dict[str, Any]:
    """What the rows hold before the migration."""
    with sqlite3.connect(folder / "clearance.sqlite3") as connection:
        of = "select result from stages where run_id = 1 and kind = 'validate'"
        validate = json.loads(connection.execute(of).fetchone()[0])
        rows = connection.execute("select label, validation from findings where run_id = 1").fetchall()
    return {"validate": validate, "findings": {label: json.loads(validation) for label, validation in rows}}


@pytest.fixture(scope="module")
def signed(folder: Path) -> str:
    """The digest of the first run's results before the migration, under which it was signed off, and another one."""
    engine = connect(default_url(folder))
    with engine.begin() as writer:
        digest = results_digest(writer, 1, evidence=False)
        told = {"run_id": 1, "role": "Reviewer", "comment": "", "user": "local", "created": 1.0}
        writer.execute(sa.insert(Signoff).values(name="Ada", digest=digest, **told))
        writer.execute(sa.insert(Signoff).values(name="Bob", digest="0" * 64, **told))
    engine.dispose()
    return digest


@pytest.fixture(scope="module")
def engine(folder: Path, before: dict[str, Any], signed: str) -> Iterator[sa.Engine]:
    migrate(default_url(folder))
    engine = connect(default_url(folder))
    yield engine
    engine.dispose()


def test_every_result_has_the_type_of_its_stage(engine: sa.Engine) -> None:
    with read(engine) as reader:
        rows = reader.execute(sa.select(Stage.kind, Stage.result)).all()
        verdicts = [Verdict.model_validate(summary) for summary in reader.scalars(sa.select(Run.summary))]
    assert {row.kind for row in rows} == {"nominal", "sensitivity", "search", "certify", "validate"}
    for row in rows:
        result = as_result(row.result)
        assert result is not None
        assert result.stage == row.kind
    assert [verdict.verdict for verdict in verdicts] == ["violated", "inconclusive"]
    assert all(verdict.provenance.code and verdict.provenance.cpu for verdict in verdicts)


def test_findings_hold_their_evidence(engine: sa.Engine, before: dict[str, Any]) -> None:
    with read(engine) as reader:
        rows = reader.execute(sa.select(Finding.__table__).where(Finding.run_id == 1)).mappings().all()
        stored = reader.scalar(sa.select(Stage.result).where(Stage.run_id == 1, Stage.kind == "validate"))
    found, validated = [as_finding(row) for row in rows], as_result(stored)
    assert isinstance(validated, ValidateResult)
    assert {f.label for f in found} == set(before["findings"])
    cases = {case["name"]: case for case in before["validate"]["cases"]}
    closest = {c["name"]: c for c in before["validate"]["encounter"]["closest"]}
    for finding in found:
        after = before["validate"]["after"][finding.label]
        assert finding.validation is not None
        assert finding.validation.model_dump() == before["findings"][finding.label]
        assert finding.slices is not None
        assert finding.slices.model_dump() == after["slices"]
        boundary = None if finding.boundary is None else finding.boundary.model_dump(exclude={"statement"})
        assert boundary == after["boundary"]
        assert finding.closest is not None
        assert {"name": finding.label, **finding.closest.model_dump()} == closest[finding.label]
    assert any(finding.boundary for finding in found)
    assert validated.nominal is not None
    assert validated.nominal.model_dump() == cases["nominal"]
    assert validated.encounter is not None
    assert {"name": "nominal", **validated.encounter.closest.model_dump()} == closest["nominal"]
    new = {"stop": {"statement", "code", "values"}}
    assert [row.model_dump(exclude=new) for row in validated.comparison] == before["validate"]["comparison"]


def test_what_runs_store_is_counted(engine: sa.Engine) -> None:
    with read(engine) as reader:
        counted = dict(reader.execute(sa.select(Run.id, Run.size)).all())
        assert counted == {run: stored_size(reader, run) for run in counted}
    assert counted[1] > 10_000


def test_campaigns_are_found_apart_from_their_seed(engine: sa.Engine) -> None:
    with read(engine) as reader:
        rows = reader.execute(sa.select(CampaignRow.document, CampaignRow.seedless)).all()
    assert rows
    assert [row.seedless for row in rows] == [seedless(row.document) for row in rows]


def test_the_audit_follows_before_and_after(engine: sa.Engine, tmp_path: Path) -> None:
    audited(engine, run_id=1, lacks={"checks.sample", SEAL, "words"})
    audited(engine, run_id=2, lacks={"checks.sample", SEAL, "words"})
    (tmp_path / "clearance.sqlite3").write_bytes(gzip.decompress(STORED.read_bytes()))
    earlier = sa.create_engine(default_url(tmp_path))
    audited(earlier, run_id=1, lacks={"checks.sample", SEAL, "words"})
    earlier.dispose()


def known(engine: sa.Engine, run_id: int) -> list[Item]:
    with read(engine) as reader:
        return audits.audited(of_database(reader, run_id))


def test_every_page_reads_it(engine: sa.Engine, folder: Path) -> None:
    service = Service(Settings(data=folder, pages=folder / "dist"))
    service.start()
    with service.signed_in() as client:
        for path in ("", "/stages", "/findings", "/traces", "/traces/F1", "/evaluations", "/report.html"):
            for run in ("R-0001", "R-0002"):
                answer = client.get(f"/api/v1/runs/{run}{path}")
                assert answer.status_code == 200, (path, answer.text)
        report = client.get("/api/v1/runs/R-0001/report.html").text
        assert "violation confirmed" in report
    service.stop()


@pytest.mark.nightly
def test_a_run_begun_without_digests_says_so_everywhere(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "clearance.sqlite3").write_bytes(gzip.decompress(STORED.read_bytes()))
    migrate(default_url(tmp_path))
    service = Service(Settings(data=tmp_path, pages=tmp_path / "dist"))
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 2).values(flown=None))
    service.start()
    try:
        with service.signed_in() as client:
            for run, said in (("R-0001", None), ("R-0002", UNDIGESTED)):
                of = f"/api/v1/runs/{run}"
                assert client.get(of).json()["undigested"] == said
                assert client.get(f"{of}/exports/run.json").json()["run"]["undigested"] == said
                assert (UNDIGESTED in client.get(f"{of}/report.html").text) == (said is not None)
                items = known(service.engine, int(run[2:]))
                assert [item.recomputed for item in items if item.name == "begun"] == ([said] if said else [])
                monkeypatch.setenv("CLEARANCE_TOKEN", service.token(run))
                assert invoke(["show", run, "--service", service.url]) == 0
                assert (UNDIGESTED in capsys.readouterr().out) == (said is not None)
    finally:
        service.stop()


def test_a_sign_off_of_the_same_results_stays_valid(engine: sa.Engine, signed: str) -> None:
    with read(engine) as reader:
        now = results_digest(reader, 1)
        held = dict(reader.execute(sa.select(Signoff.name, Signoff.digest)).all())
        notes = reader.scalars(sa.select(Audit.detail).where(Audit.action == "signoff.bound")).all()
    assert now != signed
    assert held == {"Ada": now, "Bob": "0" * 64}
    assert [note["signoff"] for note in notes] == [1, 1]
    assert (notes[0]["before"], notes[-1]["after"]) == (signed, now)


@pytest.mark.parametrize("column", ["slices", "boundary", "closest"])
def test_a_sign_off_covers_all_evidence_of_a_finding(column: str, engine: sa.Engine, signed: str) -> None:
    with engine.connect() as connection:
        before = results_digest(connection, 1)
        connection.execute(sa.update(Finding).where(Finding.run_id == 1).values({column: {"changed": True}}))
        assert results_digest(connection, 1) != before
        connection.rollback()
