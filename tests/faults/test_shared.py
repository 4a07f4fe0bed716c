"""Several workers fly blocks of one sample: whoever is killed, it ends with the bits of one that one worker flew."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db.engine import read
from backend.db.queue import submit
from backend.db.rows import as_result
from backend.db.store import RunStore
from backend.db.tables import Run, SampleBlock, SampleShare, Stage, Worker
from campaigns import Campaign, library, load_file
from campaigns.sample_seed import SampleSeed
from campaigns.stages.certify import CertifyResult
from campaigns.stages.plan import most
from tests.audited import audited
from tests.faults.processes import Started, kill, until, worker
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

SAMPLES = 300_000
"""For several seconds: a worker that looks for a share of it too early rests for five."""
CERTIFY = 2
"""The position of the sample."""
SEED = SampleSeed.drawn()


def case(samples: int = SAMPLES, **certify: Any) -> Campaign:
    document = load_file(library()["unicycle_static"]).document()
    document["stages"]["search"] = [{"method": "direct", "evaluations": 100}]
    document["stages"] |= {"sensitivity": None, "certify": {"samples": samples, "keep": "lowest", **certify}}
    document["stages"] |= {"validate": {"neighbours": 0, "evaluations": 20_000}}
    return Campaign.model_validate(document)


@cache
def undisturbed() -> CertifyResult:
    memory = MemoryStore(sample_seed=SEED)
    execute(case(), memory, threads=1)
    result = memory.stages[CERTIFY].result
    assert isinstance(result, CertifyResult)
    return result


class Runs:
    """One run of the case, as the database has it."""

    def __init__(self, database: sa.Engine, campaign: Campaign | None = None) -> None:
        self.database, campaign = database, campaign or case()
        self.url = database.url.render_as_string(hide_password=False)
        with database.begin() as connection:
            self.number = submit(
                connection, campaign, name="shared", tags=[], owner="", planned=most(campaign), seed=SEED
            )

    def run(self) -> Any:
        return self._one(sa.select(Run).where(Run.id == self.number))

    def stage(self) -> Any:
        return self._one(sa.select(Stage).where(Stage.run_id == self.number, Stage.position == CERTIFY))

    def count(self, table: Any) -> int:
        return int(self._one(sa.select(sa.func.count()).select_from(table))[0])

    def takers(self) -> set[str]:
        """Who flies blocks now."""
        with read(self.database) as connection:
            return set(connection.execute(sa.select(SampleShare.worker)).scalars())

    def shared(self, by: Collection[str]) -> None:
        """Wait until each has taken blocks, not necessarily at the same instant."""
        seen: set[str] = set()

        def each() -> bool:
            seen.update(self.takers())
            return seen == {*by}

        until(each, "it is shared")

    def done(self) -> bool:
        return self.run().state not in ("queued", "running")

    def _one(self, query: Any) -> Any:
        with read(self.database) as connection:
            return connection.execute(query).first()


def same_as_undisturbed(runs: Runs) -> None:
    stage = runs.stage()
    found, whole = as_result(stage.result), undisturbed()
    assert isinstance(found, CertifyResult)
    timeless = {"seconds": 0.0}
    assert found.model_copy(update=timeless) == whole.model_copy(update=timeless)
    assert whole.flights is not None
    assert (stage.evaluations, stage.counted) == (len(whole.flights), SAMPLES - len(whole.flights))
    assert runs.run().evaluations >= SAMPLES
    assert (runs.count(SampleBlock), runs.count(SampleShare)) == (0, 0)
    audited(runs.database)


@contextmanager
def workers(database: sa.Engine, folder: Path) -> Iterator[dict[str, Started]]:
    """Two that are ready."""
    url = database.url.render_as_string(hide_password=False)
    with worker(url, folder, "first", "--lease", "2") as first, worker(url, folder, "second", "--lease", "2") as second:

        def ready() -> bool:
            with read(database) as connection:
                return len(connection.execute(sa.select(Worker.name).where(Worker.installation != "")).all()) == 2

        until(ready, "both are ready")
        yield {"first": first, "second": second}


@pytest.mark.nightly  # by day tests/faults/test_store.py: blocks, who takes them, and who was killed
def test_two_workers_fly_one_sample_and_one_of_them_is_killed(database: sa.Engine, tmp_path: Path) -> None:
    with workers(database, tmp_path) as both:
        runs = Runs(database)
        runs.shared(both)
        holder = runs.run().worker
        (other,) = {*both} - {holder}
        killed = holder if database.dialect.name == "sqlite" else other
        kill(*both[killed].family())
        if killed == holder:
            until(lambda: runs.run().worker == other, "the other takes the run")
        until(runs.done, "the run ends", 120)
        assert runs.run().state == "done", both["first"].text() + both["second"].text()
    assert runs.run().fence == (2 if database.dialect.name == "sqlite" else 1)
    same_as_undisturbed(runs)


@pytest.mark.nightly
def test_who_assists_leaves_for_a_run_that_waits(database: sa.Engine, tmp_path: Path) -> None:
    with workers(database, tmp_path) as both:
        runs = Runs(database, case(2_000_000))
        runs.shared(both)
        holder = runs.run().worker
        (other,) = {*both} - {holder}
        waiting = Runs(database, case(100, keep="all"))
        until(lambda: waiting.run().worker == other, "it begins the other run", 20)
        until(waiting.done, "that ends")
        runs.shared(both)
        assert (runs.run().worker, runs.run().fence, runs.run().attempts) == (holder, 1, 1)


@pytest.mark.parametrize("certify", [{"keep": "all"}, {"until": "target"}])
def test_what_cannot_be_shared_is_not(certify: dict[str, str], tmp_path: Path) -> None:
    from backend.db.engine import connect
    from backend.db.queue import Queue
    from backend.db.tables import CampaignRow
    from campaigns.stored.records import StagePlan
    from tests.migrated import migrated

    url = migrated(tmp_path)
    engine = connect(url)
    document = case().document() | {"target_probability": 0.01}
    document["stages"]["certify"] |= certify
    shared = Campaign.model_validate(document)
    for campaign in (shared, Campaign.model_validate(case().document())):
        with engine.begin() as connection:
            submit(connection, campaign, name="x", tags=[], owner="", planned=1, seed=SEED)
        queue = Queue(engine)
        claim = queue.claim("first")
        assert claim is not None
        RunStore(engine, claim).plan([StagePlan("certify", None, 100)])
        with engine.begin() as connection:
            connection.execute(sa.update(Stage).values(state="running", counted=50))
        found = queue.shared("second")
        assert (found is not None) == (campaign is not shared)
        assert queue.shared("first") is None
        if found is not None:
            assert queue.shared("second", without=[found.run_id]) is None
    with engine.begin() as connection:  # as a newer version writes them
        documents = connection.execute(sa.select(CampaignRow.digest, CampaignRow.document)).all()
        for digest, known in documents:
            newer = {**known, "a field of later": 1}
            connection.execute(sa.update(CampaignRow).where(CampaignRow.digest == digest).values(document=newer))
    assert queue.shared("second") is None
    engine.dispose()
