"""A release while runs are in flight: what may change a number keeps a run waiting, nothing else stops one."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import sqlalchemy as sa

from backend.db import refusals, waiting
from backend.db.engine import connect, read
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from backend.db.tables import CatalogueSnapshot, EvaluationChunk
from backend.runs import waiting as reasons
from campaigns import Campaign
from campaigns.runs import RunState
from campaigns.versions import OtherCode, Versions
from tests.faults.cases import campaign
from tests.faults.processes import kill, until
from tests.faults.releases import Release, begin
from tests.faults.stored import Stored
from tests.given.at_night import nightly_but
from tests.given.edited_code import digest_with
from tests.given.newer_forms import FORMS, NEWER, in_form
from tests.migrated import migrated
from worker.running.catalogue.installed import catalogue
from worker.running.processes import child
from worker.running.processes.supervisor import Ending, Supervisor
from worker.running.runs import identity, sources
from worker.running.runs.meaning import meaning

CIRCLE = {"component": "circle", "parameters": {"position": {"x": 4.0, "y": 4.0}}}
SCENARIO = {**campaign().document()["scenario"], "obstacles": [CIRCLE]}
QUICK = campaign(scenario={**SCENARIO, "horizon": 1.0, "step": 0.01})
MATHS = "worker.engine.kernels.maths"
SHIFTED = ("worker/engine/components/vehicles/unicycle.py", "return 1.0 / p.m,", "return 1.001 / p.m,")
OTHER_METHOD = ("worker/engine/search/methods/direct.py", "DEEPEST = 30", "DEEPEST = 29")


class Service(Stored):
    """A database, and what the service says of a run."""

    def __init__(self, folder: Path) -> None:
        self.url = migrated(folder)
        self.engine = connect(self.url)

    def submitted(self, asked: Campaign) -> int:
        with self.engine.begin() as connection:
            return submit(connection, asked, name="another", tags=[], owner="", planned=0, catalogue=catalogue())

    def refused(self, run_id: int) -> str:
        """What differs, by the latest refusal; empty while there is none."""
        with read(self.engine) as reader:
            return next(iter(refusals.of(reader, [run_id]).get(run_id, {}).values()), "")

    def waits(self, run_id: int) -> reasons.Waits | None:
        with read(self.engine) as reader:
            return reasons.reasons(reader, [run_id]).get(run_id)

    def evaluated(self, run_id: int, position: int) -> list[bytes]:
        """The costs that a stage has stored."""
        of = sa.select(EvaluationChunk.costs).where(
            EvaluationChunk.run_id == run_id, EvaluationChunk.position == position
        )
        with read(self.engine) as reader:
            return list(reader.scalars(of.order_by(EvaluationChunk.first)))


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    made = Service(tmp_path)
    yield made
    made.engine.dispose()


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where every edited version is, one after another: each elsewhere would compile all loops again."""
    return tmp_path_factory.mktemp("release")


class Edit(NamedTuple):
    file: str
    old: str
    new: str
    differs: str = ""
    """The module that is named; empty if the run simply continues."""


EDITS = {
    "the words of a verdict": Edit("worker/evidence/verdicts/sentence.py", "Nothing may be claimed: ", "No claim: "),
    "a sentence of a stage": Edit("campaigns/claims/stages/ends.py", "evaluated the nominal case", "simulated it"),
    "a limit of the audit": Edit("worker/evidence/audit/limits.py", "SAME_COST = 0.01", "SAME_COST = 0.02"),
    "a component that it does not use": Edit("worker/engine/components/avoiders/orca.py", "= 1.5", "= 1.6"),
    "a component that it uses": Edit(*SHIFTED, "worker.engine.components.vehicles.unicycle"),
    "the kernel": Edit("worker/engine/kernels/maths.py", "1.58962301576546568060e-10", "1.6e-10", MATHS),
}


AT_NIGHT = ("a sentence of a stage", "a limit of the audit", "a component that it does not use", "the kernel")
"""By day one that continues and one that waits; of what kind each is, the test below tells."""


@pytest.mark.by_day(2)
@pytest.mark.parametrize("name", EDITS)
def test_each_of_these_edits_is_one_of_code_and_other_code_only_where_it_may_change_a_number(name: str) -> None:
    edit = EDITS[name]
    module, old, new = edit.file.removesuffix(".py").replace("/", "."), edit.old.encode(), edit.new.encode()
    content = sources.LOADED.files[module]
    assert meaning(content.replace(old, new, 1)).digest != meaning(content).digest
    assert (digest_with(QUICK, module, old, new) != identity.code(QUICK).digest) == bool(edit.differs)
    assert edit.differs in ("", module)


def never(*_: object) -> None:
    """In place of the physics of a run that is not executed."""
    pytest.fail("it is executed")


def described_by(service: Service, version: str, form: str) -> None:
    """The stored descriptions of all runs are of that version, and of a form that this one cannot read."""
    with service.engine.begin() as writer:
        [document] = writer.scalars(sa.select(CatalogueSnapshot.document))
        writer.execute(sa.update(CatalogueSnapshot).values(document=in_form(document, form, version)))


@pytest.mark.parametrize("readable", [True, False], ids=["a campaign", "a campaign of a newer form"])
@pytest.mark.parametrize("form", FORMS)
def test_a_run_that_a_newer_version_describes_in_another_form_waits_for_it(
    service: Service, form: str, readable: bool
) -> None:
    run_id, supervisor = service.submitted(QUICK), Supervisor(service.url, "w1", runner="none:none")
    described_by(service, NEWER, form)
    claim = supervisor.queue.claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    assert store.of_newer_version(catalogue())
    with pytest.raises(OtherCode):
        store.describe(QUICK, catalogue())
    given = claim if readable else replace(claim, document={**claim.document, "novel": 1})
    answer = child.perform(never, service.engine, catalogue(), given)
    assert answer["outcome"] == "refused", answer["text"]
    supervisor._settle(claim, Ending(answer["outcome"], answer["text"]))
    run = service.run(run_id)
    assert (run.state, run.attempts, run.error) == (RunState.QUEUED, 0, None)
    assert service.refused(run_id) == answer["text"]
    supervisor.engine.dispose()


@pytest.mark.parametrize("form", FORMS)
def test_damaged_descriptions_of_the_same_version_are_not_those_of_a_newer_one(service: Service, form: str) -> None:
    service.submitted(QUICK)
    described_by(service, catalogue().version, form)
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    assert not RunStore(service.engine, claim).of_newer_version(catalogue())
    unreadable = replace(claim, document={**claim.document, "novel": 1})
    outcomes = [child.perform(never, service.engine, catalogue(), one)["outcome"] for one in (claim, unreadable)]
    assert outcomes == ["failed", "unusable"]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", nightly_but(EDITS.keys() - AT_NIGHT, EDITS))
def test_a_run_begun_by_one_version_and_continued_by_another(
    service: Service, place: Path, tmp_path: Path, name: str
) -> None:
    edit = EDITS[name]
    [run_id] = begin(service.engine, QUICK)
    begun = service.run(run_id)
    with Release(place, edit[:3]).worker(service.url, tmp_path, "new") as worker:
        if not edit.differs:
            ended = service.ended(run_id)
            assert (ended.state, ended.error, ended.flown) == (RunState.DONE, None, begun.flown), worker.text()
            return
        until(lambda: service.refused(run_id), "it is refused")
        assert f"(modules: {edit.differs}" in service.refused(run_id)
        until(lambda: (found := service.waits(run_id)) and found.other_code, "the service says so")
        waits = service.waits(run_id)
        assert waits is not None
        assert waits.waits is not None
        assert waits.other_code == service.refused(run_id)
        assert f": {waits.other_code}. " in waits.waits
        meanwhile = service.submitted(QUICK)
        assert service.ended(meanwhile).state == RunState.DONE
        still = service.run(run_id)
        assert (still.state, still.attempts, still.evaluations) == (RunState.QUEUED, begun.attempts, 1)
        assert still.fence == begun.fence + 1, "it is claimed once"


@pytest.mark.nightly  # by day a run that waits, above, and what the service offers then: tests/api/runs/test_onward.py
def test_a_run_of_other_code_has_three_ways_on(service: Service, place: Path, tmp_path: Path) -> None:
    """A worker of the old version; a new beginning; a new run with what is valid, here all but what DIRECT chose."""
    old, anew, carried = begin(service.engine, QUICK, 3)
    with Release(place, OTHER_METHOD).worker(service.url, tmp_path, "new"):
        until(lambda: all(service.refused(run) for run in (old, anew, carried)), "all are refused")
        with service.engine.begin() as writer:
            assert all(waiting.waits(writer, run) for run in (anew, carried))
            waiting.restart(writer, anew)
            further = waiting.carry(writer, carried, QUICK, catalogue())
        assert service.ended(anew).state == RunState.DONE
        assert service.ended(further).state == RunState.DONE
    before, after = Versions.of(service.run(old).flown), Versions.of(service.run(anew).flown)
    assert before.code != after.code
    assert before.model == after.model is not None
    assert (service.run(carried).state, service.run(further).continues) == (RunState.CANCELLED, carried)
    assert service.evaluated(further, 0) == service.evaluated(carried, 0), "the nominal stage is carried over"
    with service.engine.begin() as writer:
        assert not any(waiting.waits(writer, run) for run in (anew, further))
    with Release(place).worker(service.url, tmp_path, "old"):
        ended = service.ended(old)
    assert (ended.state, Versions.of(ended.flown).code) == (RunState.DONE, before.code)


@pytest.mark.nightly  # by day one run, begun by one version and continued by another
def test_a_rolling_upgrade_with_runs_in_flight(service: Service, place: Path, tmp_path: Path) -> None:
    """Under load all workers are replaced, one by kill -9; later one of the old version returns. No run fails, and none
    mixes versions."""
    scenario = {**SCENARIO, "horizon": 30.0, "step": 0.002}
    asked = campaign(scenario=scenario, stages={"search": [{"method": "direct", "evaluations": 4_000}]})
    runs = [service.submitted(asked) for _ in range(4)]
    old, new = Release(place), Release(place, SHIFTED)
    with ExitStack() as replaced:
        first, second = (
            replaced.enter_context(old.worker(service.url, tmp_path, f"old-{i}", "--lease", "5")) for i in (1, 2)
        )
        until(in_flight(service, runs), "both search")
        kill(*first.family())  # as a machine that is turned off
        kill(second.pid, number=signal.SIGTERM)
        second.process.wait()
        with new.worker(service.url, tmp_path, "new-1", "--lease", "5") as third:
            until(lambda: sum(bool(service.refused(run)) for run in runs) == 2, "two runs wait for the old version")
            until(lambda: sum(service.run(run).state == RunState.DONE for run in runs) == 2, "the others end", 120.0)
            with old.worker(service.url, tmp_path, "old-3", "--lease", "5"):
                until(lambda: all(service.run(run).state == RunState.DONE for run in runs), "all end", 120.0)
            assert third.process.poll() is None
    bits: dict[str | None, list[bytes]] = {}
    for run in map(service.run, runs):
        assert run.error is None
        bits.setdefault(Versions.of(run.flown).code, []).append(b"".join(service.evaluated(run.id, 1)))
    assert [len(same) for same in bits.values()] == [2, 2], "each version ran two"
    assert all(one == other for one, other in bits.values()), "and both have its bits"
    assert len({same[0] for same in bits.values()}) == 2, "which differ between the versions"


def in_flight(service: Service, runs: list[int]) -> Callable[[], bool]:
    """Whether two of them are being searched."""

    def found() -> bool:
        rows: list[Any] = [service.run(run) for run in runs]
        return sum(row.state == RunState.RUNNING and row.evaluations > 100 for row in rows) >= 2

    return found
