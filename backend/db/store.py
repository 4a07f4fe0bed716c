"""The tables as a runner's store: the `Store` of `worker.engine.stages` for one claim, every write under its fence.

Each method is one transaction that first touches the run's row under the claim's fence: a worker that has lost its
lease writes nothing.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, Concatenate, ParamSpec

import numpy as np
import sqlalchemy as sa
from pydantic import ValidationError

from backend.db import (
    codes,
    continuation,
    evaluations_ahead,
    questions,
    sample_blocks,
    sample_seeds,
    sizes,
    snapshots,
    sources,
    workers,
)
from backend.db.convergence import extended
from backend.db.digest import current_digest
from backend.db.engine import Result, ask, clock, now, read, write
from backend.db.queue import Claim, LostLease, fenced
from backend.db.rows import (
    chunk_rows,
    failed,
    finding_row,
    lowered,
    lowest,
    made_again,
    plain,
    stored_columns,
    trace_row,
)
from backend.db.tables import EvaluationChunk, Run, Stage
from backend.db.tables import Finding as FindingRow
from backend.db.tables import Trace as TraceRow
from campaigns.asked.spec import Campaign
from campaigns.capsules.sources import Sources
from campaigns.catalogue import Catalogue
from campaigns.checked.check import simulation_problems
from campaigns.checked.snapshot import absent, values_changed
from campaigns.identity.identity import differences, identity_of, simulator_of
from campaigns.results import Finding, StageResult, Verdict
from campaigns.results.base import EXCLUDED, OK
from campaigns.runs import RunState, StageState
from campaigns.sample_seed import SampleSeed
from campaigns.stored.blocks import Block
from campaigns.stored.records import Ahead, Begun, Cited, Columns, StagePlan, StageRecord, Trace
from campaigns.versions import Code, OtherCode, Versions, differing

PATIENCE = 120.0
"""How long a write is retried while the database is unreachable or locked [s]."""


Arguments = ParamSpec("Arguments")

_PROGRESS = {"attempts": 1, "losses": 0}
"""What has gone wrong before a new result no longer counts."""


def _transaction(
    method: Callable[Concatenate[RunStore, sa.Connection, Arguments], Result],
) -> Callable[Concatenate[RunStore, Arguments], Result]:
    """A method of the store as one write transaction, which is repeated while the database cannot be written."""

    @functools.wraps(method)
    def written(self: RunStore, /, *arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        found = write(self.engine, lambda connection: method(self, connection, *arguments, **named), PATIENCE)
        self._written()
        return found

    return written


class RunStore:
    """The results of one claimed run. Writes raise `LostLease` once the run is reassigned or has ended.

    written: is called after every write.
    """

    def __init__(self, engine: sa.Engine, claim: Claim, written: Callable[[], None] = lambda: None) -> None:
        self.engine, self.claim, self._written = engine, claim, written
        self._run = claim.run_id

    @property
    def sample_seed(self) -> SampleSeed | None:
        """The seed of the run's independent sample; None for a run of an earlier version, which has the campaign's."""
        return ask(self.engine, lambda reader: continuation.sample_seed(reader, self._run))

    @_transaction
    def describe(self, connection: sa.Connection, campaign: Campaign, catalogue: Catalogue) -> None:
        """Store the component descriptions of this installation, and what the campaign asks of them; raises `OtherCode`
        if the run used others, or if the campaign can be run with those with which it was submitted, but not with
        these: a newer version described them, or some are missing here.

        The catalogue at submission may have been published by another worker.
        """
        begun = connection.scalar(sa.select(Stage.position).where(Stage.run_id == self._run).limit(1))
        snapshot = self._descriptions(connection, catalogue)
        if begun is None:
            missing = simulation_problems(campaign, catalogue)
            if missing and snapshot is not None and not simulation_problems(campaign, snapshot):
                if gone := absent(snapshot, catalogue):
                    raise OtherCode("; ".join(gone))
                if _newer(snapshot.version, catalogue):
                    raise OtherCode("; ".join(map(str, missing)))
            found = {"snapshot": snapshots.store(connection, campaign, catalogue)}
            fenced(connection, self.claim, **found, **questions.store(connection, campaign, catalogue))
            return
        others = [] if snapshot is None else values_changed(campaign, snapshot, catalogue)
        if others:
            raise OtherCode("; ".join(others))

    def of_newer_version(self, catalogue: Catalogue) -> bool:
        """Whether the run was submitted for a newer version than the one that has these components."""
        return ask(self.engine, lambda reader: _newer(snapshots.version(reader, self._run), catalogue))

    def _descriptions(self, connection: sa.Connection, catalogue: Catalogue) -> Catalogue | None:
        """Those stored with the run; raises `OtherCode` if a newer version stored them in a form of its own."""
        try:
            return snapshots.of_run(connection, self._run)
        except ValidationError:
            if not _newer(snapshots.version(connection, self._run), catalogue):
                raise
            raise OtherCode("this version cannot read the descriptions of its components") from None

    def begun(self) -> Begun | None:
        """What began the run; None if nothing has been evaluated."""
        with read(self.engine) as connection:
            return self._begun(connection) if self._has_begun(connection) else None

    def cited(self) -> Cited | None:
        """The run whose evaluations this one begins with; None if it begins without any, or has begun."""
        with read(self.engine) as connection:
            row = connection.execute(sa.select(Run.carries, Run.continues).where(Run.id == self._run)).one()
            if not row.carries or row.continues is None or self._has_begun(connection):
                return None
            old: int = row.continues
            found, ahead = continuation.evaluations(connection, old), evaluations_ahead.of_run(connection, old)
            return Cited(self._begun(connection, old), continuation.stages(connection, old), found, ahead)

    @_transaction
    def plan(self, connection: sa.Connection, stages: Sequence[StagePlan]) -> list[StageRecord]:
        """Store the plan of a new run; returns every stage in its current state."""
        fenced(connection, self.claim, fence=self.claim.fence)
        rows = connection.execute(sa.select(Stage).where(Stage.run_id == self._run).order_by(Stage.position)).all()
        if not rows:
            plans = [{"run_id": self._run, "position": i, **stage._asdict()} for i, stage in enumerate(stages)]
            connection.execute(sa.insert(Stage), plans)
            return [StageRecord(stage) for stage in stages]
        if [(row.kind, row.method) for row in rows] != [(stage.kind, stage.method) for stage in stages]:
            raise OtherCode("its stages were planned by another version")
        return continuation.stages(connection, self._run)

    @_transaction
    def record_versions(self, connection: sa.Connection, versions: Versions, code: Code) -> None:
        """Store the code version when the first stage starts; raises `OtherCode` if the run was started by other code.

        Runs that are older than this column have nothing to compare.
        """
        if not self._has_begun(connection):
            codes.store(connection, code)
            fenced(connection, self.claim, flown=versions.model_dump(mode="json"))
            if seed := sample_seeds.settle(connection, self._run, versions):
                fenced(connection, self.claim, sample_seed=seed.value, sample_seed_stated=seed.stated)
            simulator: Any = self.claim.document.get("simulator")
            if simulator and versions.simulator and not versions.command:
                workers.correct(connection, simulator["name"], versions.simulator)
            return
        begun = self._begun(connection)
        simulator = simulator_of(self.claim.document)
        then, here = identity_of(begun.versions, simulator), identity_of(versions, simulator)
        others = differences(then, here, differing(begun.modules, code.modules) if begun.modules else [])
        if others:
            raise OtherCode("; ".join(others))

    @_transaction
    def record_sources(self, connection: sa.Connection, files: Sources, texts: Mapping[str, bytes]) -> None:
        fenced(connection, self.claim, state=Run.state)
        sources.store(connection, self._run, files, texts)

    @_transaction
    def begin(self, connection: sa.Connection, position: int) -> None:
        fenced(connection, self.claim, state=Run.state)
        started = sa.func.coalesce(Stage.started, now(connection))
        connection.execute(self._stage(position).values(state=StageState.RUNNING, started=started))

    def evaluations(self, position: int) -> Columns | None:
        """All stored evaluations of a stage, in order; None if there are none."""
        return ask(self.engine, lambda reader: stored_columns(reader, self._run, position))

    def ahead(self, position: int) -> Ahead | None:
        """The stored evaluations of a stage that an earlier one is missing for, by index; None if there are none."""
        return ask(self.engine, lambda reader: evaluations_ahead.read(reader, self._run, position))

    def append(self, position: int, first: int, columns: Columns, ahead: Ahead | None = None) -> None:
        """Store evaluations from index `first` on, and update the counts and the best value of stage and run.

        ahead: further ones, completed before an earlier one of the stage; None for stages that have none. Raises
        `ValueError` unless `first` is the number of evaluations already stored for the stage.
        """
        if len(columns.status) or ahead is not None:
            self._append(position, first, columns, ahead)

    def blocks(self, position: int, known: Collection[int] = ()) -> list[Block]:
        """The counted blocks of a stage that is under way and of which only a part is stored, in their order, without
        the known ones."""
        return ask(self.engine, lambda reader: sample_blocks.read(reader, self._run, position, known))

    @_transaction
    def take(
        self, connection: sa.Connection, position: int, firsts: Sequence[int], most: int, others: bool
    ) -> list[int]:
        """Take at most `most` blocks with these first draws that are neither stored nor taken, and return their first
        draws; others: if there are none, those that other workers have taken and may have lost."""
        self._under_way(connection, position)
        return sample_blocks.take(connection, self._run, position, self.claim.worker, firsts, most, others)

    def count(self, position: int, blocks: Sequence[Block]) -> None:
        """Store counted blocks, and update the counts and best of the stage and the run."""
        if blocks:
            self._count(position, blocks)

    def beat(self) -> None:
        """Say that something was computed that is not stored yet."""
        self._written()

    def _under_way(self, connection: sa.Connection, position: int) -> None:
        """Lock the run; raises `LostLease` if the stage has ended, of which another worker may have flown the rest."""
        fenced(connection, self.claim, state=Run.state)
        of = (Stage.run_id == self._run, Stage.position == position)
        if connection.execute(sa.select(Stage.state).where(*of)).scalar_one() != StageState.RUNNING:
            raise LostLease(f"stage {position} of run {self._run} has ended; nothing was written")

    @_transaction
    def _count(self, connection: sa.Connection, position: int, blocks: Sequence[Block]) -> None:
        self._under_way(connection, position)
        new = sample_blocks.fresh(connection, self._run, position, blocks)
        draws, lost = sum(block.draws for block in new), sum(block.failed for block in new)
        totals = {"evaluations": Run.evaluations + draws, "failed_evaluations": Run.failed_evaluations + lost}
        fenced(connection, self.claim, **totals, **_PROGRESS, advanced=clock(connection))
        if new:
            sample_blocks.add(connection, self._run, position, new)

    @_transaction
    def keep(self, connection: sa.Connection, position: int, columns: Columns) -> None:
        """Store the lowest evaluations of a counted stage, which are counted already; again, if it was interrupted."""
        fenced(connection, self.claim, state=Run.state)
        more = sample_blocks.keep(connection, self._run, position, columns)
        if more is not None:
            sizes.grow(connection, self._run, more)

    @_transaction
    def finish(
        self,
        connection: sa.Connection,
        position: int,
        result: StageResult,
        seconds: float,
        findings: Sequence[Finding] = (),
        traces: Sequence[Trace] = (),
    ) -> None:
        """Store a stage's result and findings and mark it done, in one transaction."""
        values: dict[str, object] = {**_PROGRESS, "error": None, "advanced": clock(connection)}
        if result.at_nominal is not None:
            values["nominal_cost"] = plain(result.at_nominal.cost)
        fenced(connection, self.claim, **values)
        ended = {"state": StageState.DONE, "finished": now(connection), "seconds": seconds, "result": plain(result)}
        connection.execute(self._stage(position).values(**ended))
        made_again(connection, self._run, result, findings)
        sample_blocks.drop(connection, self._run, position)
        self._replace(connection, FindingRow, FindingRow.label, [finding_row(f) for f in findings])
        flights = [trace_row(t) for t in traces]
        if flights:
            sizes.replace_traces(connection, self._run, [f["name"] for f in flights], [f["data"] for f in flights])
        self._replace(connection, TraceRow, TraceRow.name, flights)

    def found(self) -> list[Finding]:
        """The findings stored so far, the worst first."""
        return ask(self.engine, lambda reader: continuation.findings(reader, self._run))

    @_transaction
    def conclude(self, connection: sa.Connection, verdict: Verdict) -> None:
        values = {
            "state": RunState.DONE,
            "verdict": verdict.verdict,
            "reason": verdict.reason,
            "nominal_cost": None if verdict.nominal is None else plain(verdict.nominal.cost),
            "worst_cost": None if verdict.worst is None else plain(verdict.worst.cost),
            "worst_method": None if verdict.worst is None else verdict.worst.method,
            "summary": plain(verdict),
            "upper_bound": None if verdict.statistics is None else plain(verdict.statistics.upper_bound),
            "lease_until": 0.0,
            "error": None,
        }
        fenced(connection, self.claim, finished=now(connection), **values)
        stated = verdict.provenance.model_copy(update={"evidence": current_digest(connection, self._run)})
        summary = plain(verdict.model_copy(update={"provenance": stated}))
        connection.execute(sa.update(Run).where(Run.id == self._run).values(summary=summary))

    def _has_begun(self, connection: sa.Connection) -> bool:
        begun = (Stage.run_id == self._run, sa.or_(Stage.state != StageState.WAITING, Stage.evaluations > 0))
        return connection.scalar(sa.select(Stage.position).where(*begun).limit(1)) is not None

    def _begun(self, connection: sa.Connection, run_id: int | None = None) -> Begun:
        of = sa.select(Run.flown).where(Run.id == (self._run if run_id is None else run_id))
        versions = Versions.of(connection.scalar(of))
        return Begun(versions, codes.modules(connection, versions.code))

    @_transaction
    def _append(
        self, connection: sa.Connection, position: int, first: int, columns: Columns, ahead: Ahead | None
    ) -> None:
        count = len(columns.status)
        lost = failed(columns)
        chunks = chunk_rows(self._run, position, first, columns)
        totals = {"evaluations": Run.evaluations + count, "failed_evaluations": Run.failed_evaluations + lost}
        totals["size"] = Run.size + sum(map(sizes.of_chunk, chunks))
        fenced(connection, self.claim, **totals, **_PROGRESS, advanced=clock(connection))
        of = (Stage.run_id == self._run, Stage.position == position)
        stage = connection.execute(sa.select(Stage.evaluations, Stage.best, Stage.kind, Stage.method).where(*of)).one()
        if stage.evaluations != first:
            raise ValueError(
                f"stage {position} has {stage.evaluations} evaluations, but new ones start at index {first}"
            )
        if ahead is not None:
            evaluations_ahead.store(connection, self._run, position, first + count, ahead)
            early, index = lowest(ahead.columns)  # they count for the run, which may end before their turn comes
            if index is not None:
                lowered(connection, self._run, stage.kind, stage.method, early)
        if not count:
            return
        for chunk in chunks:
            connection.execute(sa.insert(EvaluationChunk).values(**chunk))
        values: dict[str, object] = {
            "evaluations": first + count,
            "failed": Stage.failed + lost,
            "excluded": Stage.excluded + int((columns.status == EXCLUDED).sum()),
            "seconds": float(columns.seconds.max()),
        }
        best, index = lowest(columns)
        if index is not None and (stage.best is None or best < stage.best):
            values |= {"best": best, "best_index": first + index}
            lowered(connection, self._run, stage.kind, stage.method, best)
            if stage.method is not None:
                self._history(connection, count, columns)
        connection.execute(self._stage(position).values(**values))

    def _history(self, connection: sa.Connection, count: int, columns: Columns) -> None:
        """Update the convergence history; the run's count already includes these evaluations."""
        mine = Run.id == self._run
        history, done = connection.execute(sa.select(Run.best_so_far, Run.evaluations).where(mine)).one()
        costs = np.where(columns.status == OK, columns.costs[:, 0], np.nan)
        longer = extended(history, done - count, costs)
        if longer is not None:
            connection.execute(sa.update(Run).where(mine).values(best_so_far=longer))

    def _stage(self, position: int) -> sa.Update:
        return sa.update(Stage).where(Stage.run_id == self._run, Stage.position == position)

    def _replace(self, connection: sa.Connection, table: Any, key: Any, rows: Sequence[Mapping[str, object]]) -> None:
        if rows:
            names = [row[key.key] for row in rows]
            connection.execute(sa.delete(table).where(table.run_id == self._run, key.in_(names)))
            connection.execute(sa.insert(table), [{"run_id": self._run, **row} for row in rows])


def _newer(version: str, catalogue: Catalogue) -> bool:
    """Whether it is newer than the version that has these components; false if it is empty."""
    return _release(version) > _release(catalogue.version)


def _release(version: str) -> list[int]:
    return [int(part) for part in re.findall(r"\d+", version)]
