"""The tables: campaigns, drafts, runs (the queue), stages, evaluations in column chunks, findings, traces, access.

Arrays are little-endian float64 in BLOBs, row-major. The lease columns are explained in `backend.db.queue`.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base as Base
from backend.db.tables_access import Audit as Audit
from backend.db.tables_access import AuditHead as AuditHead
from backend.db.tables_access import Draft as Draft
from backend.db.tables_access import Invitation as Invitation
from backend.db.tables_access import LoginLink as LoginLink
from backend.db.tables_access import RequestKey as RequestKey
from backend.db.tables_access import ServiceSetting as ServiceSetting
from backend.db.tables_access import Session as Session
from backend.db.tables_access import Signoff as Signoff
from backend.db.tables_access import Token as Token
from backend.db.tables_access import User as User
from backend.db.tables_installed import CatalogueDocument as CatalogueDocument
from backend.db.tables_installed import CatalogueSnapshot as CatalogueSnapshot
from backend.db.tables_installed import CodeVersion as CodeVersion
from backend.db.tables_installed import SimulatorMeasurement as SimulatorMeasurement
from backend.db.tables_installed import WebhookDelivery as WebhookDelivery
from backend.db.tables_installed import WebhookTarget as WebhookTarget
from backend.db.tables_launched import Requirement as Requirement
from backend.db.tables_launched import RequirementFile as RequirementFile
from backend.db.tables_launched import RunBaseline as RunBaseline
from backend.db.tables_launched import RunLabel as RunLabel
from backend.db.tables_launched import RunRefusal as RunRefusal
from backend.db.tables_launched import RunRequirement as RunRequirement
from backend.db.tables_launched import RunSources as RunSources
from backend.db.tables_launched import SourceText as SourceText
from backend.db.tables_launched import Sweep as Sweep
from backend.db.tables_launched import SweepRun as SweepRun
from campaigns.documents import JsonObject
from campaigns.runs import RunState, StageState

COUNT = sa.BigInteger().with_variant(sa.Integer, "sqlite")
"""Of evaluations that need not be stored; SQLite's integers have 64 bits."""


class CampaignRow(Base):
    """A submitted campaign, immutable, by its digest."""

    __tablename__ = "campaigns"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    document: orm.Mapped[JsonObject]
    created: orm.Mapped[float]
    seedless: orm.Mapped[str | None] = orm.mapped_column(sa.String(64), index=True)
    """Digest of the document without its seed, see `campaigns.asked.spec.seedless`."""
    __table_args__ = (sa.Index("ix_campaigns_name", "name", "digest"),)


_LISTED = (
    "pinned", "id", "state", "verdict", "owner", "token", "name", "tags", "campaign_digest", "created", "started",
    "finished", "threshold", "nominal_cost", "worst_cost", "worst_method", "evaluations", "failed_evaluations",
    "upper_bound",
)  # fmt: skip


class Run(Base):
    """One execution of a campaign, and its entry in the queue.

    The columns after `error` duplicate what the run list shows, so that the list reads only this table.
    """

    __tablename__ = "runs"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    campaign_digest: orm.Mapped[str] = orm.mapped_column(sa.ForeignKey("campaigns.digest"), index=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    tags: orm.Mapped[list[Any]] = orm.mapped_column(default=list)
    owner: orm.Mapped[str] = orm.mapped_column(sa.String(64), default="")
    """The user who submitted it, also by a token."""
    token: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """The name of the API token that submitted it; None: its owner did so without one."""
    state: orm.Mapped[RunState] = orm.mapped_column(default=RunState.QUEUED)
    created: orm.Mapped[float] = orm.mapped_column(index=True)
    started: orm.Mapped[float | None]
    finished: orm.Mapped[float | None]
    continues: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("runs.id"))
    """The run whose searches this one extends with larger budgets."""
    carries: orm.Mapped[bool] = orm.mapped_column(default=False, server_default=sa.false())
    """Whether it begins with those evaluations of the run that it continues which its worker may use."""
    sample_seed: orm.Mapped[int | None] = orm.mapped_column(sa.BigInteger)
    """From which the points of its independent sample follow; None for runs older than this column: the campaign's."""
    sample_seed_stated: orm.Mapped[bool] = orm.mapped_column(default=False, server_default=sa.false())
    """Whether the launch stated it; otherwise it was drawn."""
    snapshot: orm.Mapped[str | None] = orm.mapped_column(sa.ForeignKey("catalogue_snapshots.digest"))
    """Digest of the snapshot of its components; None for runs older than snapshots."""
    question: orm.Mapped[str | None] = orm.mapped_column(sa.String(64), index=True)
    """Digest of system, bounds and criterion, see `campaigns.checked.question`. Of the run, as its components decide
    which values its campaign means."""
    bounds: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """Digest of its row of `questions`; None if a worker of an earlier version stored the question."""
    flown: orm.Mapped[JsonObject | None]
    """The installation when its first stage started, see `campaigns.versions`; None before that and for older runs."""
    # queue
    priority: orm.Mapped[int] = orm.mapped_column(default=0)
    attempts: orm.Mapped[int] = orm.mapped_column(default=0)
    """Those since the last stored evaluation that ended by a fault of its own, and the present one."""
    max_attempts: orm.Mapped[int] = orm.mapped_column(default=3)
    losses: orm.Mapped[int] = orm.mapped_column(default=0, server_default="0")
    """Workers since the last stored evaluation that were killed or fell silent; see `backend.db.queue`."""
    advanced: orm.Mapped[float | None]
    """When it last stored an evaluation or ended a stage, or was claimed without a failure since; None: not stored by
    earlier versions."""
    not_before: orm.Mapped[float] = orm.mapped_column(default=0.0)
    lease_until: orm.Mapped[float] = orm.mapped_column(default=0.0)
    worker: orm.Mapped[str | None] = orm.mapped_column(sa.String(80))
    needs: orm.Mapped[str | None] = orm.mapped_column(sa.String(160))
    """The simulator that its worker must have, see `SimulatorEntry.version`; None: any worker can execute it."""
    fence: orm.Mapped[int] = orm.mapped_column(default=0)
    error: orm.Mapped[str | None] = orm.mapped_column(sa.Text)
    """The reason why it failed, a sentence."""
    # shown in the run list
    verdict: orm.Mapped[str | None] = orm.mapped_column(sa.String(12))
    reason: orm.Mapped[str | None] = orm.mapped_column(sa.Text)
    """The verdict's sentence."""
    summary: orm.Mapped[JsonObject] = orm.mapped_column(default=dict)
    """The verdict's parts and provenance; see `campaigns.results.verdict`."""
    threshold: orm.Mapped[float | None]
    nominal_cost: orm.Mapped[float | None]
    worst_cost: orm.Mapped[float | None]
    worst_method: orm.Mapped[str | None] = orm.mapped_column(sa.String(60))
    made_again: orm.Mapped[float | None]
    """The lowest value that validation saw where it made evaluations again to confirm them: no stage stores it."""
    later: orm.Mapped[float | None]
    """The lowest value that validation saw beyond the horizon, below all evaluations of the run; -inf if it could not
    tell how low it is, None if nothing comes closer there."""
    evaluations: orm.Mapped[int] = orm.mapped_column(COUNT, default=0)
    planned: orm.Mapped[int] = orm.mapped_column(COUNT, default=0)
    failed_evaluations: orm.Mapped[int] = orm.mapped_column(COUNT, default=0)
    size: orm.Mapped[int] = orm.mapped_column(sa.BigInteger, default=0, server_default="0")
    """Of its campaign, its evaluations with their reasons, its traces and its original text [bytes]; see
    `backend.db.sizes`."""
    upper_bound: orm.Mapped[float | None]
    """On P(violation), from the sample of the certify stage; without such a stage, from a random search."""
    best_so_far: orm.Mapped[list[Any]] = orm.mapped_column(default=list, server_default="[]")
    """[[evaluations, lowest cost that a search had evaluated by then]], thinned; see `backend.db.convergence`."""
    # annotations by users
    pinned: orm.Mapped[bool] = orm.mapped_column(default=False, server_default=sa.false())
    notes: orm.Mapped[str] = orm.mapped_column(sa.Text, default="", server_default="")
    """Markdown."""
    # removal
    removed: orm.Mapped[float | None]
    """Time of removal from all lists; see `backend.runs.removal`."""
    removed_by: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    removed_reason: orm.Mapped[str | None] = orm.mapped_column(sa.Text)
    purged: orm.Mapped[float | None]
    """Time at which its results were deleted; only this row is left. See `backend.db.purge`."""
    purged_by: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    purged_digest: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """Digest of the deleted results; see `backend.db.digest`."""
    __table_args__ = (
        sa.Index("ix_runs_queue", "state", "owner", "not_before", "lease_until"),
        # Has all columns by which the run list searches, filters and sorts, in the order of the list, so that SQLite
        # does not read the wide rows. PostgreSQL stores wide values outside its rows, and cannot index JSON this way.
        sa.Index("ix_runs_list", *_LISTED, sqlite_where=sa.text("removed IS NULL")).ddl_if(dialect="sqlite"),
        # The counts of the whole list, in their order: a fifth of the time of the wider index. Only a query that states
        # the second condition, which every run fulfils, uses it: others would read the wide rows.
        sa.Index(
            "ix_runs_counts", "state", "verdict", sqlite_where=sa.text("removed IS NULL AND state IS NOT NULL")
        ).ddl_if(dialect="sqlite"),
        sa.Index("ix_runs_removed", "purged", "removed", sqlite_where=sa.text("removed IS NOT NULL")).ddl_if(
            dialect="sqlite"
        ),
    )


class Question(Base):
    """What a run asks, see `campaigns.checked.question`: a row for all runs that ask it of components with the same
    defaults, with the listed parts in the same order."""

    __tablename__ = "questions"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    """Of the other columns."""
    question: orm.Mapped[str] = orm.mapped_column(sa.String(64), index=True)
    kin: orm.Mapped[str] = orm.mapped_column(sa.String(64), index=True)
    """Equal for questions that differ only in bounds."""
    parts: orm.Mapped[Any] = orm.mapped_column(sa.JSON)
    """The bounds, see `campaigns.checked.box`."""


class Stage(Base):
    """One stage of a run; its result is written once, when it ends."""

    __tablename__ = "stages"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    position: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    kind: orm.Mapped[str] = orm.mapped_column(sa.String(20))
    """nominal, baseline, sensitivity, search, certify, validate"""
    method: orm.Mapped[str | None] = orm.mapped_column(sa.String(60))
    state: orm.Mapped[StageState] = orm.mapped_column(default=StageState.WAITING)
    started: orm.Mapped[float | None]
    finished: orm.Mapped[float | None]
    planned: orm.Mapped[int] = orm.mapped_column(COUNT, default=0)
    evaluations: orm.Mapped[int] = orm.mapped_column(default=0)
    """Those that are stored."""
    counted: orm.Mapped[int] = orm.mapped_column(COUNT, default=0, server_default="0")
    """The further ones that are only counted: of a sample of which the lowest are stored."""
    violations: orm.Mapped[int] = orm.mapped_column(COUNT, default=0, server_default="0")
    """Of such a sample, those that failed included."""
    failed: orm.Mapped[int] = orm.mapped_column(COUNT, default=0)
    excluded: orm.Mapped[int] = orm.mapped_column(COUNT, default=0)
    best: orm.Mapped[float | None]
    best_index: orm.Mapped[int | None]
    seconds: orm.Mapped[float] = orm.mapped_column(default=0.0)
    """Working time, summed over all attempts [s]."""
    result: orm.Mapped[JsonObject | None]


class _OfStage:
    """A table of rows of a stage, which are deleted with it."""

    run_id: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    position: orm.Mapped[int] = orm.mapped_column(primary_key=True)

    @orm.declared_attr.directive
    @classmethod
    def __table_args__(cls) -> tuple[sa.ForeignKeyConstraint]:
        stage = ["stages.run_id", "stages.position"]
        return (sa.ForeignKeyConstraint(["run_id", "position"], stage, ondelete="CASCADE"),)


class EvaluationChunk(_OfStage, Base):
    """Consecutive evaluations of one stage as columns: points (m, n), costs (m, k), status (m,), seconds (m,)."""

    __tablename__ = "evaluation_chunks"
    first: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    count: orm.Mapped[int]
    points: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64 on the unit cube."""
    costs: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64, NaN where the status is not ok."""
    status: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """uint8: 0 ok, 1 failed, 2 timeout, 3 excluded."""
    seconds: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64, working time of the stage when each was completed [s]."""
    reasons: orm.Mapped[dict[str, str]] = orm.mapped_column(default=dict)
    """{index in the stage: why} for every evaluation that is not ok."""


class EvaluationAhead(_OfStage, Base):
    """An evaluation that was completed before an earlier one of its stage; it moves to a chunk when that one is."""

    __tablename__ = "evaluations_ahead"
    place: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    """Index in the stage."""
    point: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64 on the unit cube."""
    costs: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64, NaN where the status is not ok."""
    status: orm.Mapped[int]
    seconds: orm.Mapped[float]
    """Working time of the stage when it was completed [s]."""
    reason: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """Why it is not ok; empty otherwise."""


class SampleBlock(_OfStage, Base):
    """A block of a sample of which the lowest evaluations are stored, while its stage is carried out."""

    __tablename__ = "sample_blocks"
    first: orm.Mapped[int] = orm.mapped_column(COUNT, primary_key=True)
    """Index of its first draw."""
    data: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """See `campaigns.stored.blocks`."""


class SampleShare(_OfStage, Base):
    """A block that a worker is flying; others fly other ones."""

    __tablename__ = "sample_shares"
    first: orm.Mapped[int] = orm.mapped_column(COUNT, primary_key=True)
    worker: orm.Mapped[str] = orm.mapped_column(sa.String(80))


class Finding(Base):
    """One distinct worst case; parameters at full precision."""

    __tablename__ = "findings"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    label: orm.Mapped[str] = orm.mapped_column(sa.String(8), primary_key=True)
    """F1 is the worst."""
    cost: orm.Mapped[float]
    margin: orm.Mapped[float]
    parameters: orm.Mapped[dict[str, float]]
    """{path: value} in the parameters' units."""
    point: orm.Mapped[list[Any]]
    """On the unit cube."""
    methods: orm.Mapped[list[Any]]
    """Search methods that found it independently; empty if only local refinement found it."""
    found: orm.Mapped[list[Any]] = orm.mapped_column(default=list, server_default="[]")
    """[{position, method, evaluations}]: stages that found it, and after how many of their evaluations."""
    at_bounds: orm.Mapped[dict[str, str]]
    """{path: "low" | "high"}"""
    validation: orm.Mapped[JsonObject]
    slices: orm.Mapped[JsonObject | None]
    """Slices through the finding; this and the next columns as in `campaigns.results.finding`."""
    boundary: orm.Mapped[JsonObject | None]
    closest: orm.Mapped[JsonObject | None]


class Trace(Base):
    """The flight that shows the nominal case or a finding, as columns of float64."""

    __tablename__ = "traces"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(12), primary_key=True)
    """nominal, F1, F2, ..."""
    columns: orm.Mapped[list[Any]]
    """[{name, symbol, unit, group}] in the order of the columns; the groups are listed in `campaigns.results.trace`."""
    rows: orm.Mapped[int]
    data: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64, (rows, columns)."""
    meta: orm.Mapped[JsonObject]
    """closest: {time, value, position, obstacle}; obstacles: [{position, radius, ...}]; goal; parameters."""


class Worker(Base):
    """The last heartbeat of a worker's supervisor."""

    __tablename__ = "workers"
    name: orm.Mapped[str] = orm.mapped_column(sa.String(80), primary_key=True)
    host: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    pid: orm.Mapped[int]
    started: orm.Mapped[float]
    beat: orm.Mapped[float]
    run_id: orm.Mapped[int | None]
    simulators: orm.Mapped[list[Any]] = orm.mapped_column(default=list, server_default="[]")
    """The simulators that it has, see `SimulatorEntry.version`."""
    installation: orm.Mapped[str] = orm.mapped_column(sa.String(64), default="", server_default="")
    """Digest of the files and packages that its process has loaded; empty until that is ready."""
    doing: orm.Mapped[JsonObject | None]
    """What it does besides the stages of its run, see `backend.db.workers.Doing`."""
    compared: orm.Mapped[float] = orm.mapped_column(default=0.0, server_default="0")
    """When it last began to compare its files with what it has published, and found no difference [s since 1970]."""
    draining: orm.Mapped[bool] = orm.mapped_column(default=False, server_default=sa.false())
    """Whether it was asked to take no further run and to end."""
    short: orm.Mapped[bool] = orm.mapped_column(default=False, server_default=sa.false())
    """Whether it begins no run, because too little space is left where it writes; see `backend.db.space`."""


class RunText(Base):
    """The original text of a run's campaign, with its comments and order; absent if a document was submitted."""

    __tablename__ = "run_texts"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """YAML or JSON that parses to the run's campaign without its baseline."""
