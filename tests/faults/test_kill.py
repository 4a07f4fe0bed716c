"""kill -9 in the middle of a search: another worker finishes the run with identical numbers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db.engine import read
from backend.db.queue import Claim, submit
from backend.db.rows import as_result
from backend.db.store import RunStore
from backend.db.tables import Finding, Run, Stage, Trace
from campaigns.results.verdict import Verdict
from campaigns.sample_seed import SampleSeed
from campaigns.stages.plan import most
from tests.audited import audited
from tests.faults import postgres
from tests.faults.long import ONCE, TWICE, case
from tests.faults.processes import alive, kill, until, worker
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

SEARCH = 3
"""The position of the random search."""
SEED = SampleSeed.drawn()
"""Of the sample of all runs here, so that the undisturbed run that they are compared with is the same."""


@pytest.mark.nightly  # by day a child that is killed, and nothing is lost: tests/faults/test_worker.py
@pytest.mark.parametrize("further", [0, 1])
def test_a_search_that_was_killed_ends_as_if_it_never_had_been(
    database: sa.Engine, tmp_path: Path, request: pytest.FixtureRequest, further: int
) -> None:
    """In a file it is killed; on a database server the server is down for a while. Killed once more by night."""
    samples = TWICE if further else ONCE
    campaign = case(samples)
    with database.begin() as connection:
        run_id = submit(connection, campaign, name="killed", tags=[], owner="", planned=most(campaign), seed=SEED)
    url = database.url.render_as_string(hide_password=False)

    def run() -> Any:
        with read(database) as connection:
            return connection.execute(sa.select(Run).where(Run.id == run_id)).one()

    def stages() -> Any:
        with read(database) as connection:
            return connection.execute(sa.select(Stage).where(Stage.run_id == run_id).order_by(Stage.position)).all()

    before: list[Any] = []
    deaths = (("first", samples // 6), ("second", samples // 2))[: (database.dialect.name == "sqlite") + further]
    for name, flown in deaths:
        with worker(url, tmp_path, name, "--lease", "2") as doomed:
            until(lambda flown=flown: run().evaluations > flown, f"more than {flown} evaluations")
            family = doomed.family()
            assert len(family) == 3, "worker, guard, child"
            kill(*family)
            until(lambda family=family: not any(map(alive, family)), "all killed")
        assert run().state == "running"
        before = before or stages()[:SEARCH]
        assert [stage.state for stage in stages()] == ["done"] * SEARCH + ["running", "waiting", "waiting"]
    with worker(url, tmp_path, "last", "--lease", "2") as last:
        until(lambda: run().worker == "last", "the last worker takes it")
        if database.dialect.name == "postgresql":
            known = max(run().evaluations, samples // 6)
            until(lambda: run().evaluations > known, "under way, its child too")
            assert run().state == "running"
            before = before or stages()[:SEARCH]
            database.dispose()
            with down(request.getfixturevalue("server")):
                until(lambda: "heartbeat failed" in last.text(), "the worker notices")
            assert last.process.poll() is None
        until(lambda: run().state != "running", "the run ends", 120)
        assert run().state == "done", last.text()
    assert (run().worker, run().fence) == ("last", len(deaths) + 1)
    assert stages()[:SEARCH] == before, "a finished stage was done again"
    _same_as_undisturbed(database, run_id, run(), stages(), samples)


@contextmanager
def down(server: postgres.Server) -> Iterator[None]:
    """The server does not run meanwhile."""
    server.stop()
    try:
        yield
    finally:
        server.start()


@cache
def _undisturbed(samples: int) -> tuple[MemoryStore, Verdict]:
    store = MemoryStore(sample_seed=SEED)
    return store, execute(case(samples), store)


def _same_as_undisturbed(engine: sa.Engine, run_id: int, run: Any, stages: Any, samples: int) -> None:
    store = RunStore(engine, Claim(run_id, 0, 0, 0, "", {}))
    assert store.sample_seed == SEED
    undisturbed, verdict = _undisturbed(samples)
    assert (run.verdict, run.reason) == (verdict.verdict, verdict.reason)
    if engine.dialect.name == "sqlite":  # what is held below is the same on a server
        audited(engine, run_id=run_id)
    assert run.nominal_cost == (verdict.nominal and verdict.nominal.cost)
    assert run.worst_cost == (verdict.worst and verdict.worst.cost)
    total = 0
    for position, stage in enumerate(stages):
        held, expected = store.evaluations(position), undisturbed.evaluations(position)
        assert held is not None
        assert expected is not None
        assert len(held.status) == stage.evaluations
        for column in ("points", "costs", "status"):
            assert getattr(held, column).tobytes() == getattr(expected, column).tobytes(), (stage.kind, column)
        assert held.reasons == expected.reasons
        total += stage.evaluations
    assert stages[SEARCH].evaluations == samples
    assert run.evaluations == total
    assert as_result(stages[SEARCH].result).best == undisturbed.stages[SEARCH].result.best
    assert store.found() == undisturbed.found()
    with read(engine) as connection:
        assert connection.scalar(sa.select(sa.func.count()).select_from(Finding)) == len(undisturbed.findings)
        flights = {row.name: row.data for row in connection.execute(sa.select(Trace.name, Trace.data))}
    assert flights == {t.name: t.data.tobytes() for t in undisturbed.traces.values()}
