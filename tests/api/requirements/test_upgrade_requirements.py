"""Stored requirements of earlier revisions: what their runs state, and which question they ask, after the migration.

`stored/revision-0018.sqlite3.gz` was written by the code of that revision: R-0001 is cleared and signed off, R-0002 is
violated.
"""

from __future__ import annotations

import gzip
import math
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.db.engine import connect, default_url, migrate, read
from backend.db.rows import made_again, plain
from backend.db.tables import CampaignRow, Requirement, Run, RunRequirement, Signoff, Stage
from backend.requirements import matrix
from campaigns.asked.load import load_document
from campaigns.results.validate import Beyond, Later
from tests.given.databases import KINDS, as_of
from tests.given.finished_runs import Work
from tests.given.reported_runs import validated
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.verdict_evidence import encountered

STORED = Path(__file__).parents[1] / "stored" / "revision-0018.sqlite3.gz"


def test_stored_runs_keep_their_digests_and_sign_offs(tmp_path: Path) -> None:
    (tmp_path / "clearance.sqlite3").write_bytes(gzip.decompress(STORED.read_bytes()))
    migrate(default_url(tmp_path))
    engine = connect(default_url(tmp_path))
    with read(engine) as reader:
        for digest, document in reader.execute(sa.select(CampaignRow.digest, CampaignRow.document)).all():
            assert load_document(document, "stored").digest == digest
        assert reader.scalar(sa.select(Signoff.digest)) == results_digest(reader, 1)
        for table in (Requirement, RunRequirement):
            assert reader.scalar(sa.select(sa.func.count()).select_from(table)) == 0
        assert matrix.page(reader, "", None, 10, 1).items == []
        assert reader.scalar(sa.select(sa.func.count()).select_from(Run)) == 2
    engine.dispose()


@pytest.mark.by_day(1)
@pytest.mark.parametrize("database", KINDS, indirect=True)
@pytest.mark.parametrize("revision", ["0031", "0034"])
def test_stored_questions_are_those_of_this_version(service: Service, client: httpx.Client, revision: str) -> None:
    """Also of a run that is older than the descriptions of components, and of one whose campaign cannot be read."""
    masses = {"low": 4.0, "high": 6.0, "unit": "kg", "distribution": {"kind": "triangular", "mode": 4.5}}
    written = {"uncertain": {"vehicle.m": {"plus_minus": "20%"}}}, {"uncertain": {"vehicle.m": masses}}
    for changes in (*written, *written, {"seed": 7}, {"name": "Unreadable"}):
        assert client.post("/api/v1/runs", json={"campaign": campaign(**changes)}).status_code == 201
    asked = sa.select(Run.question).order_by(Run.id)
    with service.engine.begin() as writer:
        before = writer.scalars(asked).all()
        writer.execute(sa.update(Run).where(Run.id.in_((3, 4))).values(snapshot=None))
        unreadable = CampaignRow.name == "Unreadable"
        writer.execute(sa.update(CampaignRow).where(unreadable).values(document={"scenario": {"novel": 1}}))
        as_of(writer, revision)
        writer.execute(sa.text("update campaigns set question = 'of an earlier version'"))
    migrate(service.engine.url.render_as_string(hide_password=False))
    with read(service.engine) as reader:
        now = reader.scalars(asked).all()
    assert now[:5] == before[:5]
    assert len(set(now[:4])) == 1
    assert now[5] not in before


@pytest.mark.parametrize("database", KINDS, indirect=True)
def test_the_lowest_value_of_a_stored_run_without_a_verdict_is_that_of_every_stage(
    service: Service, client: httpx.Client
) -> None:
    for _ in range(3):
        assert client.post("/api/v1/runs", json={"campaign": campaign()}).status_code == 201
        Work(service)
    best = {"nominal": 0.9, "search": 0.8, "sensitivity": 0.7}
    with service.engine.begin() as writer:
        for kind, cost in best.items():
            writer.execute(sa.update(Stage).where(Stage.kind == kind, Stage.run_id < 3).values(best=cost))
        writer.execute(sa.update(Run).values(worst_cost=0.8, worst_method="direct", state="cancelled"))
        writer.execute(sa.update(Run).where(Run.id == 2).values(verdict="cleared", state="done"))
        as_of(writer, "0032")
    migrate(service.engine.url.render_as_string(hide_password=False))
    with read(service.engine) as reader:
        rows = reader.execute(sa.select(Run.worst_cost, Run.worst_method).order_by(Run.id)).all()
    assert [tuple(row) for row in rows] == [(0.7, None), (0.8, "direct"), (0.8, "direct")]


@pytest.mark.parametrize("database", KINDS, indirect=True)
def test_what_was_seen_beyond_the_horizon_is_kept_of_new_runs_and_of_stored_ones(
    service: Service, client: httpx.Client
) -> None:
    near = Later(name="F1", value=0.7, time=8.0, obstacle=0, distance=1.0, closing=1.0, simulated=True)
    seen: list[tuple[dict[str, Any], float | None]] = [({}, None), ({"lowest": near}, None)]
    seen += [({"lowest": near, "closer": 2}, 0.7), ({"unknown": near}, -math.inf)]
    for run_id, (fields, _) in enumerate(seen, 1):
        assert client.post("/api/v1/runs", json={"campaign": campaign()}).status_code == 201
        beyond = Beyond(**{"times": 2.0, "flights": 9, "closer": 0, "lowest": None, **fields})
        result = validated().model_copy(update={"encounter": encountered(beyond=beyond)})
        with service.engine.begin() as writer:
            made_again(writer, run_id, result, [])
            values = {"position": 0, "kind": "validate", "state": "done", "result": plain(result)}
            writer.execute(sa.delete(Stage).where(Stage.run_id == run_id))
            writer.execute(sa.insert(Stage).values(run_id=run_id, **values))
    kept = sa.select(Run.later).order_by(Run.id)
    with service.engine.begin() as writer:
        assert writer.scalars(kept).all() == [value for _, value in seen]
        as_of(writer, "0034")
    migrate(service.engine.url.render_as_string(hide_password=False))
    with read(service.engine) as reader:
        assert reader.scalars(kept).all() == [value for _, value in seen]
