"""Retention by size: the oldest runs go that nobody keeps, what went is in the history, and a file gets smaller."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import numpy as np
import pytest
import sqlalchemy as sa

from backend.db import purge
from backend.db.engine import is_sqlite, read
from backend.db.queue import Claim, Queue, submit
from backend.db.store import RunStore
from backend.db.tables import EvaluationChunk, Run, RunBaseline, RunRequirement, Signoff
from campaigns.stored.records import Columns, StagePlan
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from tests.faults.cases import campaign
from tests.faults.processes import until
from tests.given.databases import AT_NIGHT, BOTH, POSTGRESQL
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit as submitted

NUMBER = 40_000
EACH = NUMBER * (2 * 8 + 8 + 1 + 8)
"""The evaluations of a run [bytes]."""


def begun(engine: sa.Engine) -> tuple[int, Claim]:
    """A run with evaluations that a worker has."""
    with engine.begin() as writer:
        run_id = submit(writer, campaign(), name="one", tags=[], owner="", planned=1)
    claim = Queue(engine).claim("w")
    assert claim is not None
    assert claim.run_id == run_id
    store = RunStore(engine, claim)
    store.plan([StagePlan("search", "direct", NUMBER)])
    random = np.random.default_rng(run_id).random((NUMBER, 4))
    store.append(0, 0, Columns(random[:, :2], random[:, 2:3], np.zeros(NUMBER, np.uint8), random[:, 3], {}))
    return run_id, claim


def ended(engine: sa.Engine) -> int:
    run_id, claim = begun(engine)
    Queue(engine).fail(claim, "it was stopped")
    return run_id


def left(engine: sa.Engine) -> list[int]:
    """The runs that have evaluations."""
    with read(engine) as reader:
        return list(reader.scalars(sa.select(EvaluationChunk.run_id).distinct().order_by(EvaluationChunk.run_id)))


def stored(engine: sa.Engine) -> int:
    with read(engine) as reader:
        return purge.occupied(reader)


@pytest.fixture
def runs(service: Service, client: httpx.Client) -> list[int]:
    """Runs 1 to 10, each for a reason of its own, the later ones in use."""
    engine = service.engine
    submitted(client)
    finish_fully(service)
    digest = client.get("/api/v1/runs/R-0001/signoffs").json()["digest"]
    signed = client.post("/api/v1/runs/R-0001/signoffs", json={"name": "Ada", "role": "Review", "digest": digest})
    assert signed.status_code == 201
    pinned, baseline, required, old, young, carried, removed = (ended(engine) for _ in range(7))
    running, _ = begun(engine)
    assert client.patch(f"/api/v1/runs/R-{pinned:04}", json={"pinned": True}).status_code == 200
    assert client.delete(f"/api/v1/runs/R-{removed:04}", params={"reason": "A trial."}).status_code == 200
    with engine.begin() as writer:
        writer.execute(sa.insert(RunBaseline).values(run_id=running, asked="R-0003", baseline=baseline))
        writer.execute(sa.insert(RunRequirement).values(requirement="SYS-1", run_id=required, text=""))
        writer.execute(sa.update(Run).where(Run.id == required).values(question="another"))
        waiting = submit(writer, campaign(), name="onward", tags=[], owner="", planned=1)
        writer.execute(sa.update(Run).where(Run.id == waiting).values(continues=carried, carries=True))
    found = [1, pinned, baseline, required, old, young, carried, removed, running, waiting]
    assert found == list(range(1, 11))
    return found


def command(service: Service, size: int | str, *more: str) -> int:
    limit = f"{size}B" if isinstance(size, int) else size
    return invoke(["purge", "--size", limit, "--database", service.settings.database_url, *more])


@AT_NIGHT
def test_the_oldest_that_nobody_keeps_go_first_and_nothing_else_ever(
    service: Service, client: httpx.Client, runs: list[int], capsys: pytest.CaptureFixture[str]
) -> None:
    engine = service.engine
    limit = stored(engine) - EACH - EACH // 2
    assert command(service, limit, "--dry-run") == 0
    assert [line.partition(" ")[0] for line in capsys.readouterr().out.splitlines() if line.startswith("R-")] == [
        "R-0008",
        "R-0005",
    ], "removed ones, then those that ended first"
    assert left(engine) == runs[:9]
    assert command(service, limit, "--yes") == 0
    assert left(engine) == [1, 2, 3, 4, 6, 7, 9]
    assert stored(engine) <= limit
    assert command(service, limit, "--yes") == 0
    assert left(engine) == [1, 2, 3, 4, 6, 7, 9], "enough is enough"
    capsys.readouterr()

    assert command(service, "1kB", "--yes") == VIOLATED
    assert left(engine) == [1, 2, 3, 4, 7, 9]
    [said] = capsys.readouterr().err.splitlines()
    assert "1kB" in said
    told = problem(client.get("/api/v1/runs/R-0005"), 410, "purged")
    assert "retention by size" in str(told["detail"])
    history = client.get("/api/v1/runs/R-0005/history").json()
    assert [(entry["action"], entry["via"]) for entry in history[:2]] == [("run.purged", "cli"), ("run.removed", "cli")]
    assert history[0]["detail"]["evaluations"] == NUMBER
    assert invoke(["trail", "verify", "--database", service.settings.database_url]) == 0


@AT_NIGHT
def test_no_more_goes_than_must(service: Service, runs: list[int], capsys: pytest.CaptureFixture[str]) -> None:
    """A run that goes may free more than its evaluations: what is left is measured again after each."""
    engine, reasons = service.engine, 2 * EACH
    with engine.begin() as writer:
        mine = EvaluationChunk.run_id == 8, EvaluationChunk.first == 0
        writer.execute(sa.update(EvaluationChunk).where(*mine).values(reasons={"1": "x" * reasons}))
        writer.execute(sa.update(Run).where(Run.id == 8).values(size=Run.size + reasons))
    limit = stored(engine) - EACH - EACH // 2
    assert command(service, limit, "--yes") == 0
    assert left(engine) == [1, 2, 3, 4, 5, 6, 7, 9]
    assert stored(engine) <= limit
    assert "R-0005" in capsys.readouterr().out, "it was listed"


@AT_NIGHT
def test_what_a_failed_run_continues_stays_while_it_may_be_tried_again(service: Service, runs: list[int]) -> None:
    engine = service.engine
    for values, goes in (({"state": "failed"}, False), ({"removed": 1.0}, True)):
        with engine.begin() as writer:
            writer.execute(sa.update(Run).where(Run.id == 10).values(**values))
        assert (7 in [run.id for run in purge.beyond(engine, 1).runs]) == goes


@pytest.mark.nightly
@POSTGRESQL
def test_one_that_is_signed_while_it_is_purged_stays(service: Service, runs: list[int]) -> None:
    """The purge waits for the lock of who signs, and then looks again."""
    engine = service.engine
    with ThreadPoolExecutor(1) as pool:
        with engine.begin() as writer:
            writer.execute(sa.select(Run.id).where(Run.id == 5).with_for_update())
            purged = pool.submit(purge.purge, engine, 5, None, "root", "why")
            until(lambda: _waits(engine), "the purge waits")
            signed = dict(writer.execute(sa.select(Signoff.__table__)).mappings().one())
            del signed["id"]
            writer.execute(sa.insert(Signoff).values(**signed | {"run_id": 5}))
        assert not purged.result()
    assert left(engine) == runs[:9]


def _waits(engine: sa.Engine) -> bool:
    with read(engine) as reader:
        waits = "select count(*) from pg_stat_activity where wait_event_type = 'Lock' and datname = current_database()"
        return bool(reader.scalar(sa.text(waits)))


@pytest.mark.by_day(1)
@BOTH
def test_one_that_began_again_in_the_meantime_stays(service: Service, runs: list[int]) -> None:
    """It was listed, and then somebody retried, pinned or signed it."""
    engine, user = service.engine, "root"
    listed = [run.id for run in purge.beyond(engine, 1).runs]
    assert listed == [8, 5, 6]
    with engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 5).values(state="queued"))
        writer.execute(sa.update(Run).where(Run.id == 6).values(pinned=True))
    assert [purge.purge(engine, run, None, user, "why") for run in (5, 6, 8, 8)] == [False, False, True, False]
    assert left(engine) == [1, 2, 3, 4, 5, 6, 7, 9]


@pytest.mark.nightly
def test_a_file_gives_its_space_back(
    service: Service, runs: list[int], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert is_sqlite(service.engine)
    file = Path(str(service.engine.url.database))
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.state == "running").values(state="failed"))
    size = stored(service.engine)
    monkeypatch.setenv("CLEARANCE_RETENTION_SIZE", f"{(size - 3 * EACH // 2) // 1000}kB")
    assert invoke(["purge", "--yes", "--database", service.settings.database_url]) == 0
    assert file.stat().st_size <= size - 3 * EACH // 2
    assert "2 runs purged." in capsys.readouterr().out


@pytest.mark.parametrize("given", ["-1", "1.5GB", "50 XB", "GB", "lots", "50G", "50gb", "50", "0", "٥٠"])
def test_what_is_no_size_is_refused(tmp_path: Path, given: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["purge", f"--size={given}", "--data", str(tmp_path)]) == WRONG_INPUT
    assert "give 50GB" in capsys.readouterr().err
