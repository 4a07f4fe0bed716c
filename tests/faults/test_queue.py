"""The guarantees of the queue on SQLite and PostgreSQL: exclusive claims, attempts, fences, cancellation, order."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

from backend.db import queue as queues
from backend.db import refusals, workers
from backend.db import waiting as ways
from backend.db.engine import now
from backend.db.queue import MOST_LOSSES, SILENT, Claim, LostLease, Queue, request_cancel, resume, submit
from backend.db.store import RunStore
from backend.db.tables import CampaignRow, CatalogueDocument, Run, Worker
from backend.runs import waiting
from campaigns import Catalogue
from campaigns.asked.load import load_document
from campaigns.results.base import FAILED, OK
from campaigns.stored.records import Ahead, Columns
from tests import results
from tests.faults.cases import PLAN, campaign, columns
from tests.given.databases import AT_NIGHT
from tests.simulators import package, two_basins

KILLED = "the worker process ended with signal 9 (SIGKILL)"


def put(engine: sa.Engine, **given: Any) -> int:
    values: dict[str, Any] = {"name": "a run", "tags": ["x"], "owner": "ada", "planned": 111} | given
    with engine.begin() as connection:
        return submit(connection, campaign(), **values)


def row(engine: sa.Engine, run_id: int) -> Any:
    with engine.begin() as connection:
        return connection.execute(sa.select(Run).where(Run.id == run_id)).one()


def expire(engine: sa.Engine, run_id: int) -> None:
    """As if the worker had been silent for longer than its lease."""
    with engine.begin() as connection:
        connection.execute(sa.update(Run).where(Run.id == run_id).values(lease_until=now(connection) - 1))


def ready(engine: sa.Engine, run_id: int) -> None:
    """As if the pause before the next attempt were over."""
    with engine.begin() as connection:
        connection.execute(sa.update(Run).where(Run.id == run_id).values(not_before=0.0))


def claimed(queue: Queue, worker: str = "w") -> Claim:
    claim = queue.claim(worker)
    assert claim is not None
    return claim


@pytest.mark.by_day(1)
def test_a_claim_holds_the_run_and_carries_the_campaign(database: sa.Engine) -> None:
    run_id, queue = put(database), Queue(database)
    claim = claimed(queue)
    assert claim == Claim(run_id, 1, 1, 3, "w", campaign().document())
    assert Claim(**claim.as_json()) == claim
    held = row(database, run_id)
    assert (held.state, held.worker, held.threshold, held.planned) == ("running", "w", 0.5, 111)
    assert queue.claim("other") is None
    assert queue.beat(claim) is False


def test_the_same_campaign_twice_is_stored_once(database: sa.Engine) -> None:
    put(database)
    put(database, name="again")
    with database.begin() as connection:
        assert connection.scalar(sa.select(sa.func.count()).select_from(CampaignRow)) == 1
        assert connection.scalar(sa.select(sa.func.count()).select_from(Run)) == 2


def test_order_is_priority_then_fewest_held_by_the_owner_then_age(database: sa.Engine) -> None:
    queue = Queue(database)
    first, second = put(database, owner="ada"), put(database, owner="ada")
    other, urgent = put(database, owner="bob"), put(database, owner="ada", priority=5)
    order = [claimed(queue).run_id for _ in range(4)]
    assert order == [urgent, other, first, second]


def test_a_silent_worker_loses_its_run_and_can_write_nothing(database: sa.Engine) -> None:
    run_id, queue = put(database), Queue(database)
    stale = claimed(queue, "slow")
    RunStore(database, stale).plan(PLAN)
    expire(database, run_id)
    fresh = claimed(queue, "next")
    assert (fresh.fence, fresh.attempt) == (2, 1)
    assert "stopped sending heartbeats" in row(database, run_id).error
    old = RunStore(database, stale)
    for write in (lambda: old.begin(0), lambda: old.plan(PLAN), lambda: old.finish(0, results.nominal(), 0.0)):
        with pytest.raises(LostLease):
            write()
    for call in (queue.beat, queue.give_back, queue.cancelled, lambda c: queue.fail(c, "no")):
        with pytest.raises(LostLease):
            call(stale)
    with pytest.raises(LostLease):
        queue.retry(stale, "no")
    assert queue.cancel_requested(stale)
    assert row(database, run_id).fence == 2
    assert queue.beat(fresh) is False


def test_a_lease_that_ran_out_unnoticed_is_still_good(database: sa.Engine) -> None:
    run_id, queue = put(database), Queue(database)
    claim = claimed(queue)
    expire(database, run_id)
    assert queue.beat(claim) is False
    assert queue.claim("other") is None


@AT_NIGHT
def test_three_attempts_then_failed_with_a_sentence(database: sa.Engine) -> None:
    run_id, queue = put(database), Queue(database)
    for attempt in (1, 2, 3):
        claim = claimed(queue)
        assert claim.attempt == attempt
        store = RunStore(database, claim)
        store.plan(PLAN)
        store.begin(1)
        queue.retry(claim, KILLED, delay=3600)
        if attempt < 3:
            assert queue.claim("early") is None
            assert row(database, run_id).error == f"Attempt {attempt} of 3: {KILLED}."
            ready(database, run_id)
    ended = row(database, run_id)
    assert (ended.state, ended.finished is None) == ("failed", False)
    assert " 3 attempts " in ended.error
    assert ended.error.endswith(f" stage (direct); last attempt: {KILLED}.")
    assert queue.claim("w") is None


def silent(engine: sa.Engine, queue: Queue, run_id: int) -> None:
    """A worker takes the run and is not heard of again."""
    claimed(queue)
    expire(engine, run_id)


def killed(engine: sa.Engine, queue: Queue, run_id: int) -> None:
    """The process of a worker is killed from outside."""
    queue.lost(claimed(queue), KILLED)
    ready(engine, run_id)


@pytest.mark.by_day(2)
@pytest.mark.parametrize(("lose", "how"), [(silent, SILENT), (killed, KILLED)])
def test_lost_workers_are_no_fault_of_the_run_but_have_an_end(database: sa.Engine, lose: Any, how: str) -> None:
    run_id, queue = put(database), Queue(database)
    for lost in range(MOST_LOSSES - 1):
        lose(database, queue, run_id)
        claim = claimed(queue)
        assert (claim.attempt, row(database, run_id).losses) == (1, lost + 1)
        queue.give_back(claim)
    lose(database, queue, run_id)
    assert queue.claim("w") is None
    ended = row(database, run_id)
    assert ended.state == "failed"
    assert ended.error.startswith(f"Failed after {MOST_LOSSES} ")
    assert ended.error.endswith(f": {how}.")


@AT_NIGHT
@pytest.mark.parametrize("result", ["an evaluation", "a stage"])
def test_a_stored_result_ends_the_count_of_what_has_gone_wrong(database: sa.Engine, result: str) -> None:
    run_id, queue = put(database), Queue(database)
    for _ in range(2):
        queue.retry(claimed(queue), KILLED)
        ready(database, run_id)
    silent(database, queue, run_id)
    store = RunStore(database, claimed(queue))
    store.plan(PLAN)
    if result == "a stage":
        store.finish(0, results.nominal(), 0.1)
    else:
        store.append(0, 0, columns(0, 1))
    assert (row(database, run_id).attempts, row(database, run_id).losses) == (1, 0)
    expire(database, run_id)
    for attempt in (1, 2, 3):
        claim = claimed(queue)
        assert claim.attempt == attempt
        queue.retry(claim, KILLED)
        ready(database, run_id)
    assert row(database, run_id).state == "failed"


@AT_NIGHT
def test_a_failed_run_is_queued_again_with_what_is_stored(database: sa.Engine) -> None:
    run_id, queue = put(database), Queue(database)
    claim = claimed(queue)
    store = RunStore(database, claim)
    store.plan(PLAN)
    store.append(0, 0, columns(0, 20))
    with database.begin() as connection:
        assert not resume(connection, run_id), "it has not failed"
    queue.fail(claim, "The disk is full.")
    with database.begin() as connection:
        assert resume(connection, run_id)
    again = row(database, run_id)
    assert (again.state, again.error, again.finished, again.evaluations) == ("queued", None, None, 20)
    with pytest.raises(LostLease):
        store.append(0, 20, columns(20, 1))
    assert claimed(queue).attempt == 1


def failing(count: int) -> Columns:
    """Evaluations without a value."""
    status = np.full(count, FAILED, dtype=np.uint8)
    reasons = dict.fromkeys(range(count), "it has no licence")
    return columns(0, count)._replace(costs=np.full((count, 1), np.nan), status=status, reasons=reasons)


@AT_NIGHT
def test_a_run_whose_evaluations_have_no_value_makes_them_again(database: sa.Engine) -> None:
    """Judged again as they are stored, they would fail it again, whatever was repaired."""
    run_id, queue = put(database), Queue(database)
    claim = claimed(queue)
    fresh, store = row(database, run_id), RunStore(database, claim)
    store.plan(PLAN)
    store.append(0, 0, failing(15))
    queue.fail(claim, "None has a value.")
    with database.begin() as connection:
        assert resume(connection, run_id)
    again = row(database, run_id)
    assert (again.state, again.evaluations, again.failed_evaluations, again.started) == ("queued", 0, 0, None)
    assert again.size == fresh.size
    with pytest.raises(LostLease):
        store.append(0, 15, failing(1))
    store = RunStore(database, claimed(queue))
    assert [stage.state for stage in store.plan(PLAN)] == ["waiting"] * len(PLAN)
    assert store.evaluations(0) is None


@AT_NIGHT
def test_a_value_that_is_ahead_of_a_missing_one_is_kept(database: sa.Engine) -> None:
    run_id, queue = put(database), Queue(database)
    claim = claimed(queue)
    store = RunStore(database, claim)
    store.plan(PLAN)
    rows = columns(0, 20)
    later = np.array([k for k in range(16, 20) if rows.status[k] == OK])
    known = Columns(rows.points[later], rows.costs[later], rows.status[later], rows.seconds[later], {})
    store.append(0, 0, failing(15), Ahead(later, known))
    queue.fail(claim, "The disk is full.")
    with database.begin() as connection:
        assert resume(connection, run_id)
    assert row(database, run_id).evaluations == 15


@AT_NIGHT
def test_giving_back_does_not_count(database: sa.Engine) -> None:
    run_id, queue = put(database), Queue(database)
    for _ in range(5):
        queue.give_back(claimed(queue))
        assert (row(database, run_id).state, row(database, run_id).attempts) == ("queued", 0)


def cancel(engine: sa.Engine, run_id: int) -> str | None:
    with engine.begin() as connection:
        return request_cancel(connection, run_id)


@AT_NIGHT
def test_what_cancelling_does_depends_on_the_state(database: sa.Engine) -> None:
    queue = Queue(database)
    waiting = put(database)
    assert cancel(database, waiting) == "cancelled"
    assert queue.claim("w") is None
    held = put(database)
    claim = claimed(queue)
    assert not queue.cancel_requested(claim)
    assert cancel(database, held) == "cancelling"
    assert queue.cancel_requested(claim)
    assert queue.beat(claim) is True
    queue.cancelled(claim)
    assert cancel(database, held) == "cancelled"
    assert row(database, held).finished is not None
    assert cancel(database, 999) is None


def test_cancel_does_not_wait_for_a_dead_worker(database: sa.Engine) -> None:
    queue = Queue(database)
    first = put(database)
    claimed(queue)
    expire(database, first)
    assert cancel(database, first) == "cancelled"
    second = put(database)
    claimed(queue)
    cancel(database, second)
    expire(database, second)
    assert queue.claim("w") is None
    assert row(database, second).state == "cancelled"


@AT_NIGHT
@pytest.mark.parametrize("end", ["retry", "give_back"])
def test_a_run_being_cancelled_is_not_queued_again(database: sa.Engine, end: str) -> None:
    run_id, queue = put(database), Queue(database)
    claim = claimed(queue)
    cancel(database, run_id)
    if end == "retry":
        queue.retry(claim, "it died")
    else:
        queue.give_back(claim)
    assert row(database, run_id).state == "cancelled"


def test_many_workers_at_once_never_hold_the_same_run(database: sa.Engine) -> None:
    runs = {put(database, owner=f"user{i % 3}") for i in range(40)}
    held: list[int] = []
    errors: list[BaseException] = []

    def work(name: str) -> None:
        try:
            queue = Queue(database)
            while (claim := queue.claim(name)) is not None or len(held) < len(runs):
                if claim is not None:
                    held.append(claim.run_id)
        except BaseException as error:
            errors.append(error)
            raise

    threads = [threading.Thread(target=work, args=(f"w{i}",), daemon=True) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors
    assert sorted(held) == sorted(runs)


ENTRY = two_basins.ENTRY
HAS = Catalogue(version="1", components=[], methods=[], simulators=[ENTRY])


def test_a_run_is_claimed_only_by_a_worker_with_its_simulator(database: sa.Engine) -> None:
    asked, queue = load_document(package.campaign()), Queue(database)
    with database.begin() as connection:
        run_id = submit(connection, asked, name="a", tags=[], owner="ada", planned=1, catalogue=HAS)
    changed = ENTRY.model_copy(update={"results": ENTRY.results[:1]})
    assert queue.claim("without") is None
    assert queue.claim("other version", [changed.version, "another@0"]) is None
    other = put(database)
    assert claimed(queue, "without").run_id == other
    claim = queue.claim("with", ["another@0", ENTRY.version])
    assert claim is not None
    assert claim.run_id == run_id
    with database.begin() as connection:
        assert request_cancel(connection, run_id) == "cancelling"
    expire(database, run_id)
    assert queue.claim("without") is None
    assert row(database, run_id).state == "cancelled"


def test_the_catalogue_keeps_the_simulators_of_other_live_workers(database: sa.Engine) -> None:
    with database.begin() as connection:
        workers.arrive(connection, "with")
        workers.beat(connection, "with", None, [ENTRY.version])
        workers.publish(connection, HAS)
        workers.publish(connection, HAS.model_copy(update={"simulators": []}))
        assert [entry.name for entry in workers.simulators(connection)] == [ENTRY.name]
        other = {"simulators": [{"name": "of another version"}, ENTRY.model_dump(mode="json")]}
        connection.execute(sa.update(CatalogueDocument).values(document=other))
        assert [entry.name for entry in workers.simulators(connection)] == [ENTRY.name]
        workers.leave(connection, "with")
        workers.publish(connection, HAS.model_copy(update={"simulators": []}))
        assert workers.simulators(connection) == []


@AT_NIGHT
def test_a_queued_run_reports_what_it_waits_for(database: sa.Engine) -> None:
    with database.begin() as connection:
        asked = load_document(package.campaign())
        run_id = submit(connection, asked, name="a", tags=[], owner="ada", planned=1, catalogue=HAS)

        sentences = []

        def look() -> None:
            sentences.append(waiting.reasons(connection, [run_id])[run_id].waits)

        look()
        workers.arrive(connection, "one")
        connection.execute(sa.update(Worker).values(beat=now(connection) - 400))
        look()
        workers.beat(connection, "one", None)
        look()
        workers.arrive(connection, "two")
        look()
        workers.beat(connection, "two", 7, [ENTRY.version])
        look()
        workers.beat(connection, "two", None, [ENTRY.version])
        look()
        connection.execute(sa.update(Run).where(Run.id == run_id).values(not_before=now(connection) + 30))
        look()
        needs = (
            "It needs the simulator two_basins with the parameters and results that it had when the run was submitted. "
        )
        start = "; put its files back as they were, or start a worker on a machine that has it."
        assert sentences == [
            "No worker is running. Start one with `clearance worker`.",
            "No worker is running; the last one was seen 6 min ago. Start one with `clearance worker`.",
            f"{needs}The running worker does not have it{start}",
            f"{needs}None of the 2 running workers has it{start}",
            "The only worker that can execute it is busy with R-0007; position 1 in the queue. It starts automatically "
            "when one is free.",
            "It starts automatically within a few seconds.",
            "It is tried again in 30 s.",
        ]
        connection.execute(sa.update(Run).where(Run.id == run_id).values(state="running"))
        assert waiting.reasons(connection, [run_id]) == {}


LOST: dict[str, dict[str, Any]] = {
    "without its simulator": {"simulators": []},
    "refused": {"refused": True, "run_id": None},
    "refused, busy": {"refused": True, "run_id": 7},
    "draining": {"draining": True},
    "short of space": {"short": True},
    "busy": {"run_id": 7},
    "refused, short of space": {"refused": True, "short": True},
    "refused, draining": {"refused": True, "draining": True, "run_id": 7},
}


@AT_NIGHT
@pytest.mark.parametrize("state", LOST)
def test_a_run_of_a_lost_worker_that_no_other_takes_reports_what_it_waits_for(
    database: sa.Engine, monkeypatch: pytest.MonkeyPatch, state: str
) -> None:
    queue, here = Queue(database), dict(LOST[state])
    with database.begin() as connection:
        asked = load_document(package.campaign())
        run_id = submit(connection, asked, name="a", tags=[], owner="ada", planned=1, catalogue=HAS)
    claim = queue.claim("gone", [ENTRY.version], "old")
    assert claim is not None
    store = RunStore(database, claim)
    store.plan(PLAN)
    with database.begin() as connection:
        if refused := bool(here.pop("refused", False)):
            refusals.store(connection, run_id, "new", "the code differs")
        workers.arrive(connection, "live")
        workers.beat(connection, "live", None, [ENTRY.version], "new")
        connection.execute(sa.update(Worker).where(Worker.name == "live").values(**here))
    expire(database, run_id)
    queue.free()
    assert row(database, run_id).state == "running", "its worker may be about to renew the lease"
    monkeypatch.setattr(queues, "LEASE", 0.0)
    Queue(database, 0.0).free()
    lost = row(database, run_id)
    assert (lost.state, lost.attempts, lost.losses) == ("queued", 0, 1)
    assert lost.error
    with pytest.raises(LostLease):
        store.begin(0)
    with database.begin() as connection:
        found = waiting.reasons(connection, [run_id])[run_id]
        assert found.waits
        assert (found.other_code is not None) is refused
        assert ways.waits(connection, run_id) is refused


def test_freed_runs_end_with_the_limit_of_losses_or_where_they_are_cancelled(
    database: sa.Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(queues, "LEASE", 0.0)
    queue, run_id = Queue(database, 0.0), put(database)
    for lost in range(1, MOST_LOSSES + 1):
        claimed(queue)
        expire(database, run_id)
        queue.free()
        assert row(database, run_id).state == ("queued" if lost < MOST_LOSSES else "failed")
    other = put(database)
    claimed(queue)
    with database.begin() as connection:
        connection.execute(sa.update(Run).where(Run.id == other).values(state="cancelling"))
    expire(database, other)
    queue.free()
    assert row(database, other).state == "cancelled"


@pytest.mark.by_day(3)
@pytest.mark.parametrize("how", ["retry", "lost", "put_off", "refuse", "fail"])
def test_a_reason_of_any_characters_is_stored_so_that_it_can_be_shown(database: sa.Engine, how: str) -> None:
    run_id, queue = put(database), Queue(database)
    claim, why = claimed(queue), "\ud800\0" + "." * 9000
    more: dict[str, tuple[Any, ...]] = {"put_off": (why, 1.0), "refuse": ("another installation", why)}
    getattr(queue, how)(claim, *more.get(how, (why,)))
    with database.begin() as connection:
        refused = refusals.of(connection, [run_id]).get(run_id, {})
    stored = row(database, run_id).error or refused["another installation"]
    assert "\N{REPLACEMENT CHARACTER}" * 2 + "." in stored
    assert len(stored.encode()) < 5000
