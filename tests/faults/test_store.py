"""The store over the tables: bit-exact numbers, consistent counters, atomic writes, resumable."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa
from alembic import command

from backend.db import workers
from backend.db.digest import current_digest
from backend.db.engine import migration_lock
from backend.db.migrate import config
from backend.db.purge import violates
from backend.db.queue import Claim, Queue, submit
from backend.db.rows import plain
from backend.db.store import RunStore
from backend.db.tables import EvaluationChunk, Finding, Run, SampleShare, Stage, Trace
from campaigns.results import Verdict
from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from campaigns.stored.blocks import Block, Scale, counted
from campaigns.stored.records import Ahead, Columns, StagePlan, StageRecord
from tests import results
from tests.faults.cases import PLAN, campaign, columns, finding, trace
from tests.given.stored_sizes import stored_size
from tests.given.ways_to_store import WAYS
from worker.engine.stages.parts.store import Store


@pytest.fixture
def claim(database: sa.Engine) -> Claim:
    with database.begin() as connection:
        submit(connection, campaign(), name="a run", tags=[], owner="", planned=0)
    claim = Queue(database).claim("w")
    assert claim is not None
    return claim


@pytest.fixture
def store(database: sa.Engine, claim: Claim) -> RunStore:
    store = RunStore(database, claim)
    store.plan(PLAN)
    return store


def rows(store: RunStore, table: Any, *order: Any) -> Any:
    with store.engine.begin() as connection:
        return connection.execute(sa.select(table).order_by(*order)).all()


def same_bits(a: Columns, b: Columns) -> bool:
    arrays = all(x.tobytes() == y.tobytes() and x.shape == y.shape for x, y in zip(a[:4], b[:4], strict=True))
    return arrays and a.reasons == b.reasons


def test_it_is_a_store(store: RunStore) -> None:
    as_store: Store = store
    assert as_store.plan(PLAN) == [StageRecord(stage) for stage in PLAN]


def test_evaluations_come_back_bit_for_bit_with_every_count_in_step(store: RunStore) -> None:
    store.begin(1)
    assert store.evaluations(1) is None
    for first, count in ((0, 5), (5, 1), (6, 94)):
        store.append(1, first, columns(first, count))
    whole = columns(0, 100)
    held = store.evaluations(1)
    assert held is not None
    assert same_bits(held, whole)
    [run] = rows(store, Run)
    stage = rows(store, Stage, Stage.position)[1]
    failed, excluded = int(np.isin(whole.status, (FAILED, TIMEOUT)).sum()), int((whole.status == EXCLUDED).sum())
    assert failed
    assert excluded
    assert (stage.evaluations, stage.failed, stage.excluded, stage.seconds) == (100, failed, excluded, 1.0)
    assert (stage.best, stage.best_index) == (np.nanmin(whole.costs), int(np.nanargmin(whole.costs)))
    assert (run.evaluations, run.failed_evaluations) == (100, failed)
    assert (run.worst_cost, run.worst_method) == (stage.best, "direct")


def test_the_lowest_value_of_a_run_is_that_of_every_stage_that_asks_its_question(store: RunStore) -> None:
    def lowest_of(cost: float, position: int) -> tuple[float | None, str | None]:
        one = columns(0, 1)
        costs = np.full_like(one.costs, cost)
        store.begin(position)
        store.append(position, 0, one._replace(costs=costs, status=np.full_like(one.status, OK)))
        [run] = rows(store, Run)
        return run.worst_cost, run.worst_method

    kinds = [stage.kind for stage in PLAN]
    assert kinds[:2] == ["nominal", "search"]
    assert lowest_of(0.8, 0) == (0.8, None)
    assert lowest_of(0.9, 1) == (0.8, None)
    assert lowest_of(0.7, kinds.index("validate")) == (0.7, None)


@pytest.mark.parametrize("way", WAYS)
def test_the_lowest_value_of_a_run_is_that_of_all_evaluations_however_they_are_stored(
    store: RunStore, way: str
) -> None:
    """Such as one that ended before an earlier one of its stage, when the run is cancelled before that ends."""
    store.begin(1)
    WAYS[way](store, 1, [0.8, 0.3, 0.7])
    [run] = rows(store, Run)
    assert (run.worst_cost, run.worst_method) == (0.3, "direct")
    for threshold in (0.3, 0.29):
        with store.engine.begin() as connection:
            connection.execute(sa.update(Run).values(threshold=threshold))
            assert connection.scalars(sa.select(Run.id).where(violates())).all() == [1] * (threshold >= 0.3)


def behind(whole: Columns, *indices: int) -> Ahead:
    """These evaluations of a stage, completed before an earlier one."""
    rows = list(indices)
    arrays = (whole.points[rows], whole.costs[rows], whole.status[rows], whole.seconds[rows])
    return Ahead(np.array(rows), Columns(*arrays, {i: whole.reasons[i] for i in rows if i in whole.reasons}))


def test_evaluations_completed_ahead_of_an_earlier_one_are_stored_separately(store: RunStore) -> None:
    store.begin(1)
    whole, nothing = columns(0, 100), columns(0, 0)
    failed = np.flatnonzero(whole.status == FAILED)[0]
    store.append(1, 0, columns(0, 5), behind(whole, 7, int(failed)))
    store.append(1, 5, nothing, behind(whole, 50))
    held = store.ahead(1)
    assert held is not None
    assert held.indices.tolist() == sorted([7, int(failed), 50])
    assert same_bits(held.columns, behind(whole, *sorted([7, int(failed), 50])).columns)
    assert len(store.evaluations(1).status) == rows(store, Run)[0].evaluations == 5  # type: ignore[union-attr]
    store.append(1, 5, columns(5, 95), behind(whole))
    assert store.ahead(1) is None
    assert same_bits(store.evaluations(1), whole)  # type: ignore[arg-type]
    assert store.ahead(0) is None


def blocks(samples: int = 5000) -> list[Block]:
    values = np.random.default_rng(1).random((samples, 2))
    status = np.where(np.arange(samples) % 50 == 7, FAILED, 0).astype(np.uint8)
    status[3::40] = EXCLUDED
    scale = Scale.over(np.array([0.0, 1.0]), 0.1)
    return [
        counted(
            at,
            values[at : at + 512],
            values[at : at + 512],
            status[at : at + 512],
            {7: "it broke"},
            scale,
            0.1,
            at / 512,
        )
        for at in range(0, samples, 512)
    ]


def test_a_counted_sample_goes_on_where_it_was_and_leaves_its_lowest(store: RunStore) -> None:
    store.begin(1)
    whole = blocks()
    store.count(1, whole[:4])
    store.count(1, whole[4:])
    store.count(1, whole[2:6])  # again, as after an answer that was lost
    held = store.blocks(1)
    assert [block.first for block in held] == [block.first for block in whole]
    for one, other in zip(held, whole, strict=True):
        for name in ("draws", "failed", "excluded", "violations", "total", "squares", "highest", "digest", "seconds"):
            assert getattr(one, name) == getattr(other, name), name
        assert one.bins.tolist() == other.bins.tolist()
        assert one.exclusions == other.exclusions
        assert one.kept.costs.tobytes() == other.kept.costs.tobytes()
        assert one.kept.points.tobytes() == other.kept.points.tobytes()
        assert one.kept.indices.tolist() == other.kept.indices.tolist()
        assert one.kept.status.tolist() == other.kept.status.tolist()
        assert one.kept.reasons == other.kept.reasons
    failed, excluded = sum(b.failed for b in whole), sum(b.excluded for b in whole)
    stage, [run] = rows(store, Stage, Stage.position)[1], rows(store, Run)
    assert (stage.evaluations, stage.counted, stage.failed, stage.excluded) == (0, 5000, failed, excluded)
    assert (run.evaluations, run.failed_evaluations) == (5000, failed)
    assert stage.best == min(b.kept.costs[b.kept.status == 0, 0].min() for b in whole)
    lowest = columns(0, 100)
    for _ in range(2):  # interrupted before the stage ended
        store.keep(1, lowest)
        assert same_bits(store.evaluations(1), lowest)  # type: ignore[arg-type]
        stage, [run] = rows(store, Stage, Stage.position)[1], rows(store, Run)
        assert (stage.evaluations, stage.counted, run.evaluations) == (100, 4900, 5000)
        assert len(store.blocks(1)) == len(whole)
    store.finish(1, results.searched(), 1.0)
    assert store.blocks(1) == []


def test_a_block_that_is_flown_and_not_stored_yet_is_taken_by_nobody_else(database: sa.Engine, store: RunStore) -> None:
    """However often its worker takes further ones meanwhile, until it is gone."""
    other = RunStore(database, replace(store.claim, worker="other"))
    with database.begin() as connection:
        for name in (store.claim.worker, "other"):
            workers.arrive(connection, name)
    store.begin(1)
    firsts = [block.first for block in blocks()]
    assert store.take(1, firsts, 2, others=False) == firsts[:2]
    assert store.take(1, firsts[2:], 2, others=False) == firsts[2:4]
    assert other.take(1, firsts, 3, others=False) == firsts[4:7]
    store.count(1, blocks()[:2])
    assert store.take(1, firsts[4:], 9, others=False) == firsts[7:]
    left = [first for first in firsts if first not in firsts[4:7]]
    assert other.take(1, left, 9, others=False) == []
    assert other.take(1, left, 1, others=True) == firsts[2:3]
    with database.begin() as connection:
        workers.leave(connection, store.claim.worker)
    assert other.take(1, left, 2, others=False) == firsts[2:4]
    other.take(1, [], 0, others=False)
    with database.begin() as connection:
        held = connection.execute(sa.select(SampleShare.worker, SampleShare.first)).all()
    assert {worker for worker, _ in held} == {store.claim.worker}


def test_the_size_of_a_run_is_that_of_its_rows(database: sa.Engine, store: RunStore, claim: Claim) -> None:
    """Also where a trace is stored again."""
    store.append(1, 0, columns(0, 50), behind(columns(0, 100), 70))
    store.append(1, 50, columns(50, 50), behind(columns(0, 100)))
    for stored in ([trace("nominal")], [trace(), trace("nominal")]):
        store.finish(2, results.validated(), 2.5, [], stored)
    assert any(chunk.reasons for chunk in rows(store, EvaluationChunk))
    with database.connect() as reader:
        size = stored_size(reader, claim.run_id)
        assert reader.scalar(sa.select(Run.size)) == size > 100
    with migration_lock(database) as connection:
        connection.execute(sa.text("alter table runs drop column size"))
        command.stamp(config(connection), "0020")
        command.upgrade(config(connection), "0021")  # counts what is there
        command.stamp(config(connection), "head")
    with database.connect() as reader:
        assert reader.scalar(sa.select(Run.size)) == size


def test_the_first_of_equal_costs_is_the_best(store: RunStore) -> None:
    flat = columns(0, 4)._replace(costs=np.zeros((4, 1)), status=np.zeros(4, dtype=np.uint8), reasons={})
    store.append(1, 0, flat)
    store.append(1, 4, flat)
    assert rows(store, Stage, Stage.position)[1].best_index == 0


def test_a_missing_or_repeated_index_is_refused_and_nothing_is_stored(store: RunStore) -> None:
    store.append(1, 0, columns(0, 5))
    for first in (0, 4, 6):
        with pytest.raises(ValueError, match=f" 5 evaluations, .* index {first}$"):
            store.append(1, first, columns(first, 5))
    assert rows(store, Run)[0].evaluations == 5
    assert len(rows(store, EvaluationChunk)) == 1


def test_finish_stores_result_findings_and_traces_together(store: RunStore) -> None:
    store.begin(0)
    given = results.nominal(0.9435642).model_copy(update={"margin": math.nan, "parameters": {"a": np.float64(0.5)}})
    store.finish(0, given, 0.25, [], [trace("nominal")])
    store.finish(1, results.searched(), 1.5, [finding(), finding("F2")])
    store.finish(2, results.validated(), 2.5, [finding("F1", cost=0.25)], [trace()])
    stages = rows(store, Stage, Stage.position)
    assert [s.state for s in stages] == ["done"] * 3
    assert stages[0].result == given.model_dump() | {"margin": None, "parameters": {"a": 0.5}}, "no NaN, no numpy"
    assert rows(store, Run)[0].nominal_cost == 0.9435642
    first, second = rows(store, Finding, Finding.label)
    assert first.cost == 0.25
    assert (second.parameters, second.point) == (finding().parameters, finding().point)
    assert [f.label for f in store.found()] == ["F1", "F2"]
    assert store.found()[1] == finding("F2")
    flight = next(t for t in rows(store, Trace) if t.name == "F1")
    assert flight.data == trace().data.tobytes()
    assert (flight.rows, flight.columns) == (4, [column.model_dump() for column in trace().columns])
    assert flight.meta == trace().meta.model_dump()


def test_a_finish_that_cannot_be_stored_leaves_nothing(store: RunStore) -> None:
    store.begin(1)
    with pytest.raises(sa.exc.IntegrityError):
        store.finish(1, results.searched(), 1.5, [finding(), finding()])
    assert rows(store, Stage, Stage.position)[1].state == "running"
    assert not rows(store, Finding)


def test_a_resumed_run_finds_what_is_stored(database: sa.Engine, store: RunStore, claim: Claim) -> None:
    store.begin(0)
    store.finish(0, results.nominal(), 0.25)
    store.begin(1)
    store.append(1, 0, columns(0, 7))
    queue = Queue(database)
    queue.give_back(claim)
    fresh = queue.claim("next")
    assert fresh is not None
    resumed = RunStore(database, fresh)
    assert resumed.plan(PLAN) == [
        StageRecord(PLAN[0], "done", 0.25, results.nominal()),
        StageRecord(PLAN[1], "running", 0.07, None),
        StageRecord(PLAN[2]),
    ]
    held = resumed.evaluations(1)
    assert held is not None
    assert same_bits(held, columns(0, 7))
    with pytest.raises(ValueError, match="another version"):
        resumed.plan([StagePlan("nominal", None, 1)])


def test_a_conclusion_ends_the_run(store: RunStore) -> None:
    reason = "It comes too close."
    verdict = results.verdict("violated", reason, 0.9, 0.3, checks=[])
    store.conclude(verdict)
    [run] = rows(store, Run)
    assert (run.state, run.verdict, run.reason) == ("done", "violated", reason)
    assert (run.nominal_cost, run.worst_cost, run.worst_method) == (0.9, 0.3, "direct")
    stored = Verdict.model_validate(run.summary)
    with store.engine.connect() as reader:
        assert stored.provenance.evidence == current_digest(reader, run.id)
    assert stored.model_copy(update={"provenance": verdict.provenance}) == verdict
    assert run.finished >= run.started


def test_plain_values_for_json() -> None:
    given = {"a": np.float64("inf"), 3: (np.int64(2), np.bool_(True)), "c": [float("nan"), -0.0, None, "x"]}
    assert plain(given) == {"a": None, "3": [2, True], "c": [None, -0.0, None, "x"]}
    assert str(plain(-0.0)) == "-0.0"
