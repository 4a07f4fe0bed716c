"""kill -9 in the middle of an estimate of P(violation): another worker continues it with the same bits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db.engine import connect, read
from backend.db.queue import Claim, submit
from backend.db.rows import as_result
from backend.db.store import RunStore
from backend.db.tables import Run, Stage
from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.stages.plan import most
from tests.audited import audited
from tests.faults.processes import alive, kill, until, worker
from tests.given.case_campaigns import searching
from tests.given.sampled_stages import DRAWN
from tests.migrated import migrated
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

ESTIMATE, BUDGET = 3, 30_000
"""Its position; long enough to be killed in the middle: results are stored every 0.2 s."""


def campaign() -> Campaign:
    document = searching({"method": "direct", "evaluations": 100}, criterion__threshold=0.942).document()
    document["stages"] |= {"certify": None, "estimate": {"evaluations": BUDGET}}
    return load_document(document)


@pytest.mark.nightly
@pytest.mark.parametrize("part", [0.5, 0.1])
def test_an_estimate_that_was_killed_ends_as_if_it_never_had_been(part: float, tmp_path: Path) -> None:
    """During the draws; by night during the search for modes, too."""
    engine, asked = connect(migrated(tmp_path)), campaign()
    with engine.begin() as connection:
        run_id = submit(connection, asked, name="killed", tags=[], owner="", planned=most(asked), seed=DRAWN)
    url = engine.url.render_as_string(hide_password=False)

    def rows() -> list[Any]:
        with read(engine) as connection:
            return list(connection.execute(sa.select(Stage).where(Stage.run_id == run_id).order_by(Stage.position)))

    def state() -> Any:
        with read(engine) as connection:
            return connection.execute(sa.select(Run.state, Run.worker).where(Run.id == run_id)).one()

    with worker(url, tmp_path, "first", "--lease", "2") as doomed:
        until(lambda: len(rows()) > ESTIMATE and rows()[ESTIMATE].evaluations > part * BUDGET, "in the estimate")
        family = doomed.family()
        kill(*family)
        until(lambda: not any(map(alive, family)), "all killed")
    assert rows()[ESTIMATE].state == "running"
    begun = RunStore(engine, Claim(run_id, 0, 0, 0, "", {})).evaluations(ESTIMATE)
    assert begun is not None
    assert part * BUDGET < len(begun.status) < BUDGET
    with worker(url, tmp_path, "second", "--lease", "2") as last:
        until(lambda: state().state != "running", "the run ends", 120)
        assert state() == ("done", "second"), last.text()
    undisturbed = MemoryStore(sample_seed=DRAWN)
    execute(asked, undisturbed)
    store = RunStore(engine, Claim(run_id, 0, 0, 0, "", {}))
    for position, row in enumerate(rows()):
        stored, expected = store.evaluations(position), undisturbed.evaluations(position)
        assert stored is not None
        assert expected is not None
        for column in ("points", "costs", "status"):
            assert getattr(stored, column).tobytes() == getattr(expected, column).tobytes(), (row.kind, column)
    assert as_result(rows()[ESTIMATE].result) == undisturbed.stages[ESTIMATE].result
    audited(engine, run_id=run_id)
    engine.dispose()
