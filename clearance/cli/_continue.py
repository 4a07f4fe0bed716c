"""Extends a run for `clearance run --continue RUN --budget +N`: a folder of results, or a stored run.

A folder's run is extended in memory; a stored run is extended as a new run of the same database, held under a lease by
this process, so that a worker finishes it if this process dies.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db import codes, evaluations_ahead, labels, snapshots
from backend.db import continuation as stored
from backend.db.engine import connected, migrate, read, write
from backend.db.queue import LEASE, Claim, LostLease, Queue
from backend.db.store import PATIENCE, RunStore
from campaigns import Campaign, CampaignError
from campaigns.asked.load import load_document
from campaigns.refusals import RefusalCode
from campaigns.results import Verdict
from campaigns.runs import ENDED, run_name
from campaigns.stages.plan import plan
from campaigns.stored.records import Columns
from clearance.cli import WrongInputError
from clearance.cli._where import existing_url_of, stored_run
from clearance.local.citation import Cited, Earlier
from clearance.local.interrupt import explained
from clearance.local.results import read_folder, refuse_other_campaign, refuse_other_components, versions_of, violated
from worker.engine.stages.parts.store import Store
from worker.running.catalogue.installed import catalogue
from worker.running.runs.continuation import Budget, CannotContinue, carried, continued, preloaded, refuse_other_code
from worker.running.runs.runner import CampaignUnusable, Cancelled, ReplayMismatch
from worker.running.runs.store import MemoryStore

Execute = Callable[[Campaign, Store, Callable[[], bool]], Verdict]


class Continued(NamedTuple):
    """The new run: its campaign, its stored data, its verdict, the run that it extends, its labels if it is stored."""

    campaign: Campaign
    store: MemoryStore
    verdict: Verdict
    cites: Cited
    labels: dict[str, str]


@dataclass(frozen=True)
class _Earlier(Earlier):
    modules: dict[str, str] = field(default_factory=dict)

    def onward(self, budget: Budget) -> tuple[Campaign, dict[int, Columns]]:
        campaign = continued(self.campaign, budget)
        refuse_other_code(campaign, self.versions, self.modules)
        return campaign, carried(self.campaign, campaign, self.store, violated=self.violated)


def execute_continued(
    run: str, budget: str, data: Path, database: str, execute: Execute, accept: Callable[[Campaign], None]
) -> Continued:
    """Extend a run with `execute(campaign, store, cancelled)`; raises `WrongInputError` if that is impossible.

    accept: raises for an extended campaign whose results have no place, before anything is stored.
    """
    try:
        wanted = Budget.read(budget)
        run_id = stored_run(run)
        if run_id is not None:
            return _of_database(run_id, wanted, existing_url_of(data, database), execute, accept)
        return _of_folder(Path(run), wanted, execute, accept)
    except (CannotContinue, ReplayMismatch) as error:
        code = error.code if isinstance(error, CannotContinue) else RefusalCode.OTHER_POINTS
        raise WrongInputError(f"{run} cannot be extended: {error}", code) from None
    except CampaignUnusable as error:
        why = "; ".join(map(str, error.problems))
        raise WrongInputError(f"{run} cannot be extended: {why}", RefusalCode.NOT_EVALUABLE) from None


def _of_folder(folder: Path, budget: Budget, execute: Execute, accept: Callable[[Campaign], None]) -> Continued:
    campaign, store = read_folder(folder)
    earlier = _Earlier(str(folder), campaign, store, versions_of(folder), violated(folder))
    onward, columns = earlier.onward(budget)
    refuse_other_campaign(folder, campaign)
    accept(onward)
    memory = preloaded(onward, columns, store.sample_seed)
    with explained(memory, onward):
        return Continued(onward, memory, execute(onward, memory, lambda: False), earlier.cited, {})


def _of_database(
    run_id: int, budget: Budget, url: str, execute: Execute, accept: Callable[[Campaign], None]
) -> Continued:
    migrate(url)
    with connected(url) as engine:
        earlier = _earlier(engine, run_id)
        onward, columns = earlier.onward(budget)
        accept(onward)
        planned = plan(onward)
        known = catalogue()
        versions = earlier.versions if earlier.versions.code else None

        def begin(connection: sa.Connection) -> Claim:
            return stored.begin(
                connection, run_id, onward, planned, columns,
                worker="clearance run", lease=LEASE, catalogue=known, versions=versions,
            )  # fmt: skip

        claim = write(engine, begin, PATIENCE)
        verdict = _under_lease(engine, claim, onward, execute)
        with read(engine) as connection:
            memory = _snapshot(connection, claim.run_id)
            labelled = labels.of_runs(connection, [claim.run_id]).get(claim.run_id, {})
        return Continued(onward, memory, verdict, earlier.cited | {"as": run_name(claim.run_id)}, labelled)


def _earlier(engine: sa.Engine, run_id: int) -> _Earlier:
    with read(engine) as connection:
        found = stored.state(connection, run_id)
        if found is None:
            raise CannotContinue(
                "there is no such run in this database; check --data, the data folder of the service",
                RefusalCode.NO_RUN,
            )
        state, document = found
        if stored.is_purged(connection, run_id):
            raise CannotContinue("it was purged: its evaluations were deleted; run the campaign again")
        if stored.is_removed(connection, run_id):
            raise CannotContinue("it was removed; restore it on its page first")
        if state not in ENDED:
            raise CannotContinue(f"it is {state}; wait for it to end, or cancel it first")
        try:
            campaign = load_document(document, run_name(run_id))
        except CampaignError as error:
            raise CannotContinue(f"its campaign was written for another version of Clearance: {error}") from None
        try:
            descriptions = snapshots.of_run(connection, run_id)
        except ValidationError:
            what = "the description of its components was written for another version of Clearance"
            raise CannotContinue(what, RefusalCode.OTHER_COMPONENTS) from None
        refuse_other_components(campaign, descriptions)
        versions = stored.versions(connection, run_id)
        modules, store = codes.modules(connection, versions.code), _snapshot(connection, run_id)
        return _Earlier(run_name(run_id), campaign, store, versions, modules=modules)


def _under_lease(engine: sa.Engine, claim: Claim, campaign: Campaign, execute: Execute) -> Verdict:
    """Run under the lease; an interrupt returns the run to the queue, an error fails this attempt."""
    queue = Queue(engine)
    with _beating(queue, claim) as cancelled:
        try:
            return execute(campaign, RunStore(engine, claim), cancelled)
        except Cancelled:
            queue.cancelled(claim)
            raise WrongInputError(f"{run_name(claim.run_id)} was cancelled") from None
        except LostLease:
            raise
        except KeyboardInterrupt:
            queue.give_back(claim)
            raise KeyboardInterrupt(
                f"{run_name(claim.run_id)} and its completed evaluations are stored; unless it was cancelled, a worker "
                "of this database resumes it (`clearance serve` starts one)"
            ) from None
        except Exception as error:
            queue.retry(claim, f"the runner raised {type(error).__name__}: {error}")
            raise


@contextmanager
def _beating(queue: Queue, claim: Claim) -> Iterator[Callable[[], bool]]:
    """Prolong the lease from a thread; yields whether the run is to stop."""
    over, stop = threading.Event(), threading.Event()

    def beat() -> None:
        while not over.wait(queue.lease / 4):
            try:
                if queue.beat(claim):
                    stop.set()
            except LostLease:
                stop.set()
                return
            except sa.exc.OperationalError:
                continue  # a busy database is retried before the lease expires

    thread = threading.Thread(target=beat, name="lease", daemon=True)
    thread.start()
    try:
        yield stop.is_set
    finally:
        over.set()
        thread.join()


def _snapshot(connection: sa.Connection, run_id: int) -> MemoryStore:
    return MemoryStore(
        stages=stored.stages(connection, run_id),
        waiting={at: [ahead] for at, ahead in evaluations_ahead.of_run(connection, run_id).items()},
        chunks={at: [columns] for at, columns in stored.evaluations(connection, run_id).items()},
        findings=stored.findings(connection, run_id),
        traces={t.name: t for t in stored.traces(connection, run_id)},
        sample_seed=stored.sample_seed(connection, run_id),
    )
