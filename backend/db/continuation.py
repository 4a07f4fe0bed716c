"""Extends the searches of a run: a new run that cites the old one and starts with its evaluations.

The transaction that creates the new run also claims it for the caller, so that no worker takes it. When that lease
expires, any worker can resume it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sqlalchemy as sa

from backend.db import labels, sizes
from backend.db.engine import now
from backend.db.queue import Claim, submit
from backend.db.rows import as_array, as_columns, as_finding, as_result, chunk_rows, failed, lowered, lowest
from backend.db.tables import CampaignRow, EvaluationChunk, Run, RunBaseline, RunText, Stage
from backend.db.tables import Finding as FindingRow
from backend.db.tables import Trace as TraceRow
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.results import Finding, TraceHead
from campaigns.results.base import EXCLUDED
from campaigns.results.trace import TraceColumn
from campaigns.runs import RunState
from campaigns.sample_seed import SampleSeed
from campaigns.stages.plan import most
from campaigns.stored.records import Columns, StagePlan, StageRecord, Trace, join
from campaigns.versions import Versions


def state(connection: sa.Connection, run_id: int) -> tuple[RunState, dict[str, object]] | None:
    """A run's state and the document of its campaign; None if there is no such run."""
    of = sa.select(Run.state, CampaignRow.document).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    row = connection.execute(of.where(Run.id == run_id)).first()
    return None if row is None else (row.state, row.document)


def versions(connection: sa.Connection, run_id: int) -> Versions:
    """The installation that ran a run; for a run older than this column, the one stored with its verdict, if any."""
    row = connection.execute(sa.select(Run.flown, Run.summary).where(Run.id == run_id)).one()
    return Versions.of(row.flown or (row.summary or {}).get("provenance"))


def sample_seed(connection: sa.Connection, run_id: int) -> SampleSeed | None:
    """The seed of a run's independent sample; None for a run of an earlier version, which has the campaign's."""
    row = connection.execute(sa.select(Run.sample_seed, Run.sample_seed_stated).where(Run.id == run_id)).one()
    return None if row.sample_seed is None else SampleSeed(row.sample_seed, row.sample_seed_stated)


def is_removed(connection: sa.Connection, run_id: int) -> bool:
    """Whether a run is removed, and may therefore be purged at any time."""
    return connection.scalar(sa.select(Run.removed).where(Run.id == run_id)) is not None


def is_purged(connection: sa.Connection, run_id: int) -> bool:
    """Whether the evaluations and findings of a run were deleted."""
    return connection.scalar(sa.select(Run.purged).where(Run.id == run_id)) is not None


def stages(connection: sa.Connection, run_id: int) -> list[StageRecord]:
    rows = connection.execute(sa.select(Stage).where(Stage.run_id == run_id).order_by(Stage.position))
    return [StageRecord(StagePlan(r.kind, r.method, r.planned), r.state, r.seconds, as_result(r.result)) for r in rows]


def evaluations(connection: sa.Connection, run_id: int) -> dict[int, Columns]:
    of = sa.select(EvaluationChunk).where(EvaluationChunk.run_id == run_id)
    found: dict[int, list[Columns]] = {}
    for row in connection.execute(of.order_by(EvaluationChunk.position, EvaluationChunk.first)):
        found.setdefault(row.position, []).append(as_columns(row))
    return {position: joined for position, chunks in found.items() if (joined := join(chunks)) is not None}


def findings(connection: sa.Connection, run_id: int) -> list[Finding]:
    """The findings of a run, the worst first."""
    of = sa.select(FindingRow.__table__).where(FindingRow.run_id == run_id).order_by(FindingRow.cost)
    return [as_finding(row) for row in connection.execute(of).mappings()]


def traces(connection: sa.Connection, run_id: int) -> list[Trace]:
    rows = connection.execute(sa.select(TraceRow).where(TraceRow.run_id == run_id).order_by(TraceRow.name))
    return [
        Trace(
            r.name,
            [TraceColumn.model_validate(column) for column in r.columns],
            as_array(r.data, r.rows),
            TraceHead.model_validate(r.meta),
        )
        for r in rows
    ]


def begin(
    connection: sa.Connection,
    old: int,
    campaign: Campaign,
    planned: Sequence[StagePlan],
    carried: Mapping[int, Columns],
    *,
    worker: str,
    lease: float,
    catalogue: Catalogue | None = None,
    versions: Versions | None = None,
) -> Claim:
    """Create and claim the run that extends run `old` under the campaign, with these evaluations in its stages.

    It has the old run's name, tags, labels, baseline and owner, and stores the catalogue entries of its components.
    `versions` describes the installation that ran these evaluations; None if unknown. Runs in the caller's transaction.
    """
    run_id = succeed(connection, old, campaign, most(campaign), catalogue)
    for position, stage in enumerate(planned):
        columns = carried.get(position)
        row = {"run_id": run_id, "position": position, **stage._asdict()}
        connection.execute(sa.insert(Stage).values(**row, **({} if columns is None else _counts(columns))))
        if columns is not None:
            best, index = lowest(columns)
            if index is not None:
                lowered(connection, run_id, stage.kind, stage.method, best)
            for chunk in chunk_rows(run_id, position, 0, columns):
                connection.execute(sa.insert(EvaluationChunk).values(**chunk))
                sizes.grow(connection, run_id, sizes.of_chunk(chunk))
    at = now(connection)
    claimed = {"worker": worker, "fence": 1, "attempts": 1, "started": at, "lease_until": at + lease}
    carried_over = {
        "evaluations": sum(len(c.status) for c in carried.values()),
        "failed_evaluations": sum(map(failed, carried.values())),
        "best_so_far": connection.scalar(sa.select(Run.best_so_far).where(Run.id == old)),
        "flown": None if versions is None else versions.model_dump(mode="json"),
        "state": RunState.RUNNING,
    }
    connection.execute(sa.update(Run).where(Run.id == run_id).values(**claimed, **carried_over))
    attempts = connection.execute(sa.select(Run.max_attempts).where(Run.id == run_id)).scalar_one()
    return Claim(run_id, 1, 1, attempts, worker, campaign.document())


def succeed(
    writer: sa.Connection, old: int, campaign: Campaign, planned: int, catalogue: Catalogue | None, **values: object
) -> int:
    """Queue a run that continues another one, with its name, tags, labels, baseline, priority and owner."""
    kept = sa.select(Run.name, Run.tags, Run.owner, Run.token, Run.priority).where(Run.id == old)
    own_labels = labels.of_runs(writer, [old]).get(old, {})
    same = writer.execute(kept).one()._asdict()
    seed = sample_seed(writer, old)  # its evaluations are those of this seed
    run_id = submit(writer, campaign, **same, planned=planned, catalogue=catalogue, labelled=own_labels, seed=seed)
    for row in writer.execute(sa.select(RunBaseline.__table__).where(RunBaseline.run_id == old)).mappings().all():
        writer.execute(sa.insert(RunBaseline).values({**row, "run_id": run_id}))
    writer.execute(sa.update(Run).where(Run.id == run_id).values(continues=old, **values))
    return run_id


def store_text(writer: sa.Connection, run_id: int, text: str) -> None:
    """Store the original text of a run's campaign."""
    writer.execute(sa.insert(RunText).values(run_id=run_id, text=text))
    sizes.grow(writer, run_id, len(text.encode("utf-8", "surrogatepass")))


def _counts(columns: Columns) -> dict[str, object]:
    best, index = lowest(columns)
    return {
        "evaluations": len(columns.status),
        "failed": failed(columns),
        "excluded": int((columns.status == EXCLUDED).sum()),
        "seconds": float(columns.seconds.max()),
        "best": None if index is None else best,
        "best_index": index,
    }
