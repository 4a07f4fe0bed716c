"""A run that is executed again repeats the first one, whatever time either took."""

from __future__ import annotations

import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from pydantic import BaseModel

from backend.db.engine import connect, read
from backend.db.queue import Queue, submit
from backend.db.repeats import NOT_REPEATED
from backend.db.store import RunStore
from backend.db.tables import CampaignRow, Run, Stage
from backend.signoffs.repeats import COLUMNS, OTHER_RESULTS, Repeats
from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results import Verdict
from campaigns.results.validate import ValidateResult
from campaigns.sample_seed import SampleSeed
from campaigns.stages.found import declared
from campaigns.stages.plan import most
from tests.given.case_campaigns import campaign
from tests.migrated import migrated
from tests.simulators import noisy
from tests.simulators.adversaries import adversary
from worker.running.runs.runner import execute

STAGES = {
    "sensitivity": {"points": 2},
    "search": [{"method": name, "evaluations": 30} for name in ("direct", "cma_es")],
    "certify": {"samples": 30},
    "findings": {"at_most": 1, "evaluations": 100},
    "validate": {"neighbours": 5, "evaluations": 5_000},
}


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[sa.Engine]:
    engine = connect(migrated(tmp_path / "data"))
    yield engine
    engine.dispose()


def ran(engine: sa.Engine, asked: Campaign) -> int:
    """The run of a campaign, evaluated and stored."""
    with engine.begin() as writer:
        seed = SampleSeed(7, stated=True)
        run_id = submit(writer, asked, name="one", tags=[], owner="", planned=most(asked), seed=seed)
    claim = Queue(engine).claim("w")
    assert claim is not None
    execute(asked, RunStore(engine, claim), threads=1)
    return run_id


def difference(engine: sa.Engine, one: int, other: int) -> str | None:
    with read(engine) as reader:
        of = sa.select(*COLUMNS).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        rows = {row.id: row for row in reader.execute(of.where(Run.id.in_([one, other])))}
        return Repeats(reader).difference(rows[one], rows[other])


@pytest.mark.parametrize("system", [pytest.param("closed loop", marks=pytest.mark.nightly), "simulator"])
def test_a_run_that_is_executed_again_repeats_the_first_one(engine: sa.Engine, system: str) -> None:
    with adversary("none"):
        asked = load_document(
            (campaign() if system == "closed loop" else noisy.campaign()).document() | {"stages": STAGES}
        )
        one, other = ran(engine, asked), ran(engine, asked)
    with engine.begin() as reader:
        results = [
            reader.execute(sa.select(Stage.result).where(Stage.run_id == run).order_by(Stage.position)).scalars().all()
            for run in (one, other)
        ]
    assert results[0] != results[1], "their times differ"
    assert difference(engine, one, other) is None
    with engine.begin() as writer:
        validated = dict(results[1][-1] or {}) | {"tolerance": 0.5}
        writer.execute(sa.update(Stage).where(Stage.run_id == other, Stage.kind == "validate").values(result=validated))
    assert difference(engine, one, other) == OTHER_RESULTS


def fields(kind: Any, known: set[Any]) -> Iterator[str]:
    """The names of all fields of a type of result, at any depth."""
    for inner in typing.get_args(kind):
        yield from fields(inner, known)
    if isinstance(kind, type) and issubclass(kind, BaseModel) and kind not in known:
        known.add(kind)
        for name, field in kind.model_fields.items():
            yield name
            yield from fields(field.annotation, known)


def test_every_working_time_of_a_result_is_left_out() -> None:
    known: set[Any] = set()
    names = {
        name for kind in (Verdict, *(stage.result for stage in declared().values())) for name in fields(kind, known)
    }
    assert ValidateResult in known
    assert {name for name in names if "seconds" in name} <= NOT_REPEATED <= names
