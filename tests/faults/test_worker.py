"""A worker whose child crashes, hangs, refuses or is killed: real processes, faults in place of the physics."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db import queue as queues
from backend.db import revision
from backend.db.engine import connect, read
from backend.db.queue import Claim, Queue, request_cancel, submit
from backend.db.store import RunStore
from backend.db.tables import CatalogueDocument, Run, Stage
from backend.db.tables import Worker as WorkerRow
from campaigns.asked.load import load_document
from campaigns.asked.problem import CampaignError, Problem
from campaigns.stored.records import StagePlan
from clearance.cli import INTERNAL, WRONG_INPUT, invoke
from clearance.cli.worker import DRAINED
from tests.faults.cases import campaign, columns
from tests.faults.diagnosed import diagnosed
from tests.faults.jobs import SEARCH, WINGS
from tests.faults.processes import REPOSITORY, Started, alive, descendants, kill, until, worker
from tests.faults.stored import Stored
from tests.given import case_campaigns
from tests.migrated import migrated
from worker.engine.stages.parts.context import ReplayMismatch
from worker.engine.systems.base import CampaignUnusable
from worker.running.catalogue.installed import catalogue
from worker.running.processes import child, memory
from worker.running.processes.supervisor import UNSTORED, Ending, Supervisor
from worker.running.runs import identity
from worker.running.runs.file_check import FilesChanged
from worker.running.runs.provenance import machine

OPTIONS = ("--runner", "tests.faults.jobs:execute", "--lease", "2")


def at_night(*values: object) -> Any:
    """A parameter for `make nightly`: every loss of a child costs the start of another, 3 s of processor time."""
    return pytest.param(*values, marks=pytest.mark.nightly)


class Bench(Stored):
    """A database and a worker on it."""

    def __init__(self, url: str, folder: Path) -> None:
        self.url, self.folder, self.engine = url, folder, connect(url)
        self.worker: Started

    def submit(self, accident: str, once: Path | None = None) -> int:
        asked = campaign(name=f"{accident} {once or ''}"[:120], summary=str(once or ""))
        with self.engine.begin() as connection:
            return submit(connection, asked, name=accident, tags=[], owner="", planned=0)

    def half_flown(self, run_id: int) -> None:
        until(lambda: self.run(run_id).evaluations > SEARCH // 2, f"run {run_id} is half flown")

    def whole(self, run_id: int) -> None:
        """Every evaluation of the search is there, once, in order and to the bit."""
        claim = Claim(run_id, 0, 0, 0, "", {})
        held, expected = RunStore(self.engine, claim).evaluations(1), columns(0, SEARCH)
        assert held is not None
        assert [a.tobytes() for a in held[:4]] == [a.tobytes() for a in expected[:4]]
        assert held.reasons == expected.reasons
        assert self.run(run_id).evaluations == SEARCH + 1


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    """A worker shared by all tests of this file: it must survive all of them."""
    folder = tmp_path_factory.mktemp("worker")
    url = migrated(folder)
    bench = Bench(url, folder)
    with worker(url, folder, "shared", *OPTIONS) as bench.worker:
        yield bench
        print(bench.worker.text())
    bench.engine.dispose()


@pytest.fixture
def bench(home: Bench) -> Iterator[Bench]:
    """The shared worker, which must be alive before and after; a run left over is cancelled."""
    assert home.worker.process.poll() is None, home.worker.text()
    yield home
    assert home.worker.process.poll() is None, home.worker.text()
    with home.engine.begin() as connection:
        for run_id in connection.scalars(sa.select(Run.id).where(Run.finished.is_(None))).all():
            request_cancel(connection, run_id)


def test_a_worker_registers_and_publishes_its_catalogue(bench: Bench) -> None:
    assert bench.ended(bench.submit("none")).state == "done"
    with read(bench.engine) as connection:
        row = connection.execute(sa.select(WorkerRow)).one()
        document = connection.execute(sa.select(CatalogueDocument)).one().document
    assert (row.name, row.pid) == ("shared", bench.worker.pid)
    assert "direct" in [method["name"] for method in document["methods"]]


def test_the_doctor_finds_nothing_wrong_with_a_service_that_works(
    bench: Bench, capsys: pytest.CaptureFixture[str]
) -> None:
    until(lambda: diagnosed(bench.folder, capsys)[1]["workers"]["state"] == "ok", "the worker is alive")
    found = diagnosed(bench.folder, capsys)[1]
    for name in ("data folder", "database", "schema", "workers", "clock", "pages"):
        assert found[name]["state"] == "ok", found[name]
    assert revision.newest() in found["schema"]["found"]


# By day a signal; an error of the runner: tests/faults/test_outages.py.
@pytest.mark.parametrize(
    "accident", ["segfault", at_night("kill"), at_night("exit"), at_night("leave"), at_night("fail")]
)
def test_after_one_crash_the_run_resumes_where_it_was(bench: Bench, tmp_path: Path, accident: str) -> None:
    run_id = bench.submit(accident, tmp_path / "once")
    ended = bench.ended(run_id)
    if accident == "segfault":
        assert "signal 11 (SIGSEGV)" in bench.worker.text()
    assert (ended.state, ended.verdict, ended.attempts, ended.error) == ("done", "inconclusive", 1, None)
    assert ended.fence == 2
    bench.whole(run_id)
    with read(bench.engine) as connection:
        stages = connection.execute(sa.select(Stage).where(Stage.run_id == run_id).order_by(Stage.position)).all()
    assert [s.evaluations for s in stages] == [1, SEARCH]
    assert stages[0].finished < stages[1].started


@pytest.mark.parametrize(
    ("accident", "how"),
    [
        at_night("segfault", "the worker process ended with signal 11 (SIGSEGV)"),
        at_night("exit", "the worker process ended with exit code 7"),
        at_night("fail", "the runner raised BrokenPipeError: [Errno 32] no pipe"),
    ],
)  # by day attempts are counted below, of files that change, and in tests/faults/test_queue.py
def test_a_run_that_kills_workers_fails_after_three_attempts(bench: Bench, accident: str, how: str) -> None:
    ended = bench.ended(bench.submit(accident))
    assert ended.state == "failed"
    assert " 3 attempts " in ended.error
    assert ended.error.endswith(f" stage (direct); last attempt: {how}.")
    assert (ended.fence, ended.attempts, ended.verdict) == (3, 3, None)


def test_a_campaign_that_cannot_be_run_fails_at_once(bench: Bench) -> None:
    ended = bench.ended(bench.submit("refuse"))
    assert (ended.state, ended.attempts) == ("failed", 1)
    assert ended.error.endswith(f" scenario.vehicle: {WINGS} (given: unicycle)")


def test_a_reason_that_no_database_can_store_ends_the_run_alone(bench: Bench) -> None:
    ended = bench.ended(bench.submit("unstorable"))
    assert (ended.state, ended.attempts) == ("failed", 1)
    assert "\N{REPLACEMENT CHARACTER}" * 2 in ended.error


def test_an_end_that_cannot_be_stored_fails_the_run_with_that_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unstored(*_: object) -> None:
        raise ValueError("no such column")

    url = migrated(tmp_path)
    bench, supervisor = Bench(url, tmp_path), Supervisor(url, "w1", runner="none:none")
    run_id, claim = bench.submit("none"), supervisor.queue.claim("w1")
    assert claim is not None
    with monkeypatch.context() as patched:
        patched.setattr(supervisor.queue, "retry", unstored)
        supervisor._settle(claim, Ending("failed", "the runner raised ValueError"))
    assert (bench.run(run_id).state, bench.run(run_id).error) == ("failed", UNSTORED)
    with monkeypatch.context() as patched:  # nor the sentence: its lease expires
        patched.setattr(supervisor.queue, "fail", unstored)
        supervisor._settle(claim, Ending("unusable", "it has no wings"))
    bench.engine.dispose()
    supervisor.engine.dispose()


def test_every_heartbeat_queues_the_runs_of_lost_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also of a worker that takes no run at that time."""
    monkeypatch.setattr(queues, "LEASE", 0.0)
    url = migrated(tmp_path)
    bench, supervisor = Bench(url, tmp_path), Supervisor(url, "w1", runner="none:none", lease=0.0)
    run_id = bench.submit("none")
    assert Queue(bench.engine, 0.0).claim("gone") is not None
    with bench.engine.begin() as writer:
        writer.execute(sa.update(Run).values(lease_until=1.0))
    supervisor._beat(None)
    assert bench.run(run_id).state == "queued"
    bench.engine.dispose()
    supervisor.engine.dispose()


def test_a_simulator_that_changes_in_every_attempt_ends_the_run(tmp_path: Path) -> None:
    """After the first one the next process has another installation where simulators are, so it may refuse the run."""

    def changes(*_: object) -> None:
        raise FilesChanged([Problem("simulator.name", "drop", "drop.py has changed")])

    url = migrated(tmp_path)
    bench, supervisor = Bench(url, tmp_path), Supervisor(url, "w1", runner="none:none")
    run_id = bench.submit("none")
    for attempt in range(1, 4):
        assert bench.run(run_id).state == "queued"
        with bench.engine.begin() as writer:
            writer.execute(sa.update(Run).values(not_before=0.0))
        claim = supervisor.queue.claim("w1")
        assert claim is not None
        answer = child.perform(changes, bench.engine, catalogue(), claim)
        assert answer["outcome"] == "edited"
        supervisor._settle(claim, Ending(answer["outcome"], answer["text"]))
        assert bench.run(run_id).attempts == attempt
        assert "drop.py has changed" in (bench.run(run_id).error or "")
    assert bench.run(run_id).state == "failed"
    known = [catalogue().model_copy(update={"digests": {"drop": text}}) for text in ("one", "other")]
    assert len({child.installation(each) for each in (catalogue(), *known)}) == 3
    bench.engine.dispose()
    supervisor.engine.dispose()


@pytest.mark.parametrize(
    "raised",
    [CampaignUnusable([Problem("simulator.name", "drop", "cannot be used")]), CampaignError("x", []), MemoryError()],
)
def test_what_cannot_be_used_while_files_change_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, raised: Exception
) -> None:
    def cannot(*_: object) -> None:
        raise raised

    (folder := tmp_path / "drop").mkdir()
    bench = Bench(migrated(tmp_path), tmp_path)
    bench.submit("none")
    claim = Queue(bench.engine).claim("w1")
    assert claim is not None
    assert child.perform(cannot, bench.engine, catalogue(), claim)["outcome"] in ("unusable", "spent")
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(folder.parent))
    (folder / "simulator.yaml").write_text("name: drop", encoding="utf-8")
    assert child.perform(cannot, bench.engine, catalogue(), claim)["outcome"] == "edited"
    bench.engine.dispose()


@pytest.mark.parametrize("elsewhere", [True, False])
def test_a_run_that_requests_other_points_here_waits_if_another_kind_of_machine_began_it(
    tmp_path: Path, elsewhere: bool
) -> None:
    def mismatches(*_: object) -> None:
        raise ReplayMismatch(1, 142)

    bench = Bench(migrated(tmp_path), tmp_path)
    with bench.engine.begin() as connection:
        submit(connection, case_campaigns.campaign(), name="a", tags=[], owner="", planned=1)
    claim = Queue(bench.engine).claim("w1")
    assert claim is not None
    code, here = identity.code(load_document(claim.document)), machine()
    there = here.model_copy(update={"system": "Plan9 mips"}) if elsewhere else here
    store = RunStore(bench.engine, claim)
    store.plan([StagePlan("nominal", None, 1)])
    store.record_versions(there.model_copy(update={"code": code.digest}), code)
    store.begin(0)
    answer = child.perform(mismatches, bench.engine, catalogue(), claim)
    assert answer["outcome"] == ("refused" if elsewhere else "unusable"), answer["text"]
    assert ("Plan9" in answer["text"]) == elsewhere
    bench.engine.dispose()


@pytest.mark.parametrize(
    "named",
    [
        "platform.python_version",
        "platform.machine",
        "worker.running.runs.provenance.binding.get_host_cpu_name",
        "worker.running.runs.provenance.processor_features",
    ],
)
def test_processes_that_differ_in_what_runs_are_compared_by_refuse_apart(
    named: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = child.installation(catalogue())
    assert child.installation(catalogue()) == here
    monkeypatch.setattr(named, lambda: "another")
    assert child.installation(catalogue()) != here


@pytest.mark.skipif(sys.platform != "linux", reason="address space is bounded on Linux alone")
def test_a_simulation_cannot_take_the_memory_of_the_machine(bench: Bench) -> None:
    ended = bench.ended(bench.submit("devour"))
    assert (ended.state, ended.attempts) == ("failed", 1)
    assert ended.error == memory.sentence()
    assert bench.ended(bench.submit("none")).state == "done"


def test_an_error_in_the_physics_leaves_the_child_warm(bench: Bench) -> None:
    bench.ended(bench.submit("none"))
    child = bench.worker.child()
    bench.ended(bench.submit("refuse"))
    bench.ended(bench.submit("none"))
    assert bench.worker.child() == child


def test_a_beat_between_the_last_write_and_the_answer_does_not_kill_the_child(bench: Bench) -> None:
    bench.ended(bench.submit("none"))
    child = bench.worker.child()
    assert bench.ended(bench.submit("linger")).state == "done"
    assert bench.ended(bench.submit("none")).state == "done"
    assert bench.worker.child() == child


@pytest.mark.nightly  # by day what cannot be loaded is reported, and a child that crashes
def test_a_child_that_cannot_start_ends_the_worker_with_its_reason(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(REPOSITORY))
    umask = os.umask(0o077)
    try:  # the worker in this process, its children in their own
        url = f"sqlite:///{tmp_path}/clearance.sqlite3"
        assert invoke(["worker", "--database", url, "--runner", "tests.faults.nowhere:execute"]) == INTERNAL
    finally:
        os.umask(umask)
    statement = capfd.readouterr().err
    assert statement.count("No module named 'tests.faults.nowhere'") == 3
    assert "ended with exit code 1 before it was ready, 3 times in a row" in statement


def test_what_the_physics_prints_and_reads_never_reaches_the_supervisor(bench: Bench) -> None:
    run_id = bench.submit("talk")
    assert bench.ended(run_id).state == "done"
    bench.whole(run_id)


@pytest.mark.parametrize("accident", [at_night("hang"), at_night("hold"), "spawn"])
def test_cancel_takes_less_than_a_second_and_leaves_no_process(bench: Bench, accident: str) -> None:
    run_id = bench.submit(accident)
    bench.half_flown(run_id)
    child = bench.worker.child()
    if accident == "spawn":
        until(lambda: descendants(child), "the child has started a process")
    family = [child, *descendants(child)]
    with bench.engine.begin() as connection:
        assert request_cancel(connection, run_id) == "cancelling"
    took = until(lambda: bench.run(run_id).state == "cancelled", "cancelled")
    assert took < 1.0 or accident == "spawn", "measured by night, when the machine does nothing else"
    assert not [pid for pid in family if alive(pid)]
    assert bench.run(run_id).verdict is None
    assert bench.ended(bench.submit("none")).state == "done"


def test_a_child_that_holds_the_interpreter_keeps_its_lease(bench: Bench) -> None:
    run_id = bench.submit("hold")
    bench.half_flown(run_id)
    beats = {bench.run(run_id).lease_until}

    def beaten() -> bool:
        beats.add(bench.run(run_id).lease_until)
        return max(beats) > min(beats) + 2.5  # longer than the lease

    until(beaten, "the lease is prolonged")
    assert (bench.run(run_id).state, bench.run(run_id).fence) == ("running", 1)
    with bench.engine.begin() as connection:
        request_cancel(connection, run_id)
    bench.ended(run_id)


def test_a_locked_database_is_waited_for(bench: Bench, tmp_path: Path) -> None:
    connection = bench.engine.connect()
    run_id = bench.submit("pause", half := tmp_path / "half")
    until(half.exists, "half of it is flown")
    connection.begin()
    frozen = bench.run(run_id)
    half.write_text("go on")
    try:  # longer than the lease, so that the beats fail to arrive too
        until(lambda: bench.run(run_id).lease_until < time.time() - 1.0, "the lease has run out")
        assert bench.run(run_id).evaluations == frozen.evaluations
    finally:
        connection.rollback()
        connection.close()
    ended = bench.ended(run_id)
    assert (ended.state, ended.attempts, ended.fence) == ("done", 1, 1)
    bench.whole(run_id)


@pytest.mark.nightly  # by day tests/faults/test_serve.py: a worker that is stopped with its service gives its run back
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_stopped_worker_gives_its_run_back(bench: Bench, tmp_path: Path, number: signal.Signals) -> None:
    url = migrated(tmp_path)
    own = Bench(url, tmp_path)
    run_id = own.submit("hold")
    with worker(url, tmp_path, "first", *OPTIONS) as first:
        own.half_flown(run_id)
        family = first.family()
        assert len(family) == 3, "worker, guard, child"
        kill(first.pid, number=number)
        until(lambda: not [pid for pid in family if alive(pid)], "all gone")
        assert first.process.wait() == (130 if number == signal.SIGINT else 0)
    run = own.run(run_id)
    assert (run.state, run.attempts, run.error) == ("queued", 0, None)
    with read(own.engine) as connection:
        assert connection.scalar(sa.select(sa.func.count()).select_from(WorkerRow)) == 0
    own.engine.dispose()


@contextmanager
def frozen(bench: Bench, *family: int) -> Iterator[None]:
    """These processes are stopped meanwhile; not in a transaction, whose lock they would hold."""
    with bench.engine.begin():  # nobody else writes
        kill(*family, number=signal.SIGSTOP)
    try:
        yield
    finally:
        kill(*family, number=signal.SIGCONT)


@pytest.mark.nightly  # by day a child that is killed
def test_of_two_workers_one_continues_where_the_other_was_frozen_or_killed(bench: Bench, tmp_path: Path) -> None:
    """Frozen beyond its lease it can write nothing; killed it leaves no child."""

    def half_flown_by_another(once: str) -> int:
        with frozen(bench, *bench.worker.family()):
            run_id = bench.submit("hang", tmp_path / once)
            bench.half_flown(run_id)
        assert bench.run(run_id).worker == "other"
        return run_id

    with worker(bench.url, tmp_path, "other", *OPTIONS) as other:
        run_id = half_flown_by_another("frozen")
        with frozen(bench, *other.family()):
            ended = bench.ended(run_id)
            assert (ended.state, ended.worker, ended.fence) == ("done", "shared", 2)
        until(lambda: "lost" in other.text(), "the frozen worker notices")
        assert bench.run(run_id) == ended
        bench.whole(run_id)
        assert other.process.poll() is None

        run_id = half_flown_by_another("killed")
        child = other.child()
        kill(other.pid)
        until(lambda: not alive(child), "the child is gone")
        ended = bench.ended(run_id)
    assert (ended.state, ended.worker, ended.fence) == ("done", "shared", 2)
    bench.whole(run_id)


@contextmanager
def own(folder: Path, *options: str) -> Iterator[Bench]:
    """A database and a worker of one test."""
    url = migrated(folder)
    bench = Bench(url, folder)
    try:
        with worker(url, folder, "own", *OPTIONS, *options) as bench.worker:
            yield bench
    finally:
        bench.engine.dispose()


@pytest.mark.nightly  # by day a child that is killed
@pytest.mark.parametrize("how", ["stopped", at_night("hang"), at_night("hold")])
def test_a_child_that_stands_still_is_replaced(tmp_path: Path, how: str) -> None:
    with own(tmp_path, "--standstill", "3") as bench:
        run_id = bench.submit("hang" if how == "stopped" else how, tmp_path / "once")
        if how == "stopped":
            bench.half_flown(run_id)
            kill(bench.worker.child(), number=signal.SIGSTOP)
        ended = bench.ended(run_id)
        assert ended.state == "done"
        assert "stood still" in bench.worker.text()
        bench.whole(run_id)


@pytest.mark.nightly  # by day a database that is locked, and a child that cannot start
def test_an_outage_while_the_child_starts(tmp_path: Path) -> None:
    url = migrated(tmp_path)
    locked = connect(url).connect()
    with own(tmp_path) as bench:
        until(lambda: bench.worker.family()[1:], "the child starts")
        locked.begin()
        until(lambda: "the database is busy" in bench.worker.text(), "the worker notices")
        locked.rollback()
        locked.close()
        assert bench.ended(bench.submit("none")).state == "done"
        assert bench.worker.process.poll() is None


def test_a_drained_worker_finishes_its_run_and_takes_no_further_one(
    home: Bench, capsys: pytest.CaptureFixture[str]
) -> None:
    """The shared one, so this is the last test here."""
    first, second = home.submit("linger"), home.submit("linger")
    until(lambda: home.run(first).evaluations > SEARCH // 2, "the first is under way")
    assert invoke(["worker", "drain", "nobody", "--database", home.url]) == WRONG_INPUT
    assert "shared" in capsys.readouterr().err, "it names those that there are"
    assert invoke(["worker", "drain", "shared", "--database", home.url]) == 0
    until(lambda: home.worker.process.poll() is not None, "it ends")
    assert home.worker.process.returncode == DRAINED
    assert (home.run(first).state, home.run(second).state) == ("done", "queued")
