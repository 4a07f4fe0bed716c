"""The tables: campaigns, drafts, runs (the queue), stages, evaluations in column chunks, findings, traces, access.

Arrays are little-endian float64 in BLOBs, row-major. Start reading at `Run`; the lease columns are explained in
`backend.db.queue`.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base as Base
from backend.db.tables_access import LoginLink as LoginLink
from backend.db.tables_access import Session as Session
from backend.db.tables_access import Token as Token
from backend.db.tables_installed import CatalogueDocument as CatalogueDocument
from backend.db.tables_installed import CatalogueSnapshot as CatalogueSnapshot
from backend.db.tables_installed import CodeVersion as CodeVersion
from campaigns.documents import JsonObject


class Campaign(Base):
    """A submitted campaign, immutable, by its digest."""

    __tablename__ = "campaigns"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    document: orm.Mapped[JsonObject]
    created: orm.Mapped[float]
    __table_args__ = (sa.Index("ix_campaigns_name", "name", "digest"),)


_LISTED = (
    "pinned", "state", "verdict", "owner", "name", "campaign_digest", "tags", "created", "started", "finished",
    "threshold", "nominal_cost", "worst_cost", "worst_method", "evaluations", "failed_evaluations", "upper_bound",
    "removed",
)  # fmt: skip


class Run(Base):
    """One execution of a campaign, and at once its place in the queue.

    The columns after `error` repeat what the run list shows, so that the list reads one table.
    """

    __tablename__ = "runs"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    campaign_digest: orm.Mapped[str] = orm.mapped_column(sa.ForeignKey("campaigns.digest"), index=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    tags: orm.Mapped[list[Any]] = orm.mapped_column(default=list)
    owner: orm.Mapped[str] = orm.mapped_column(sa.String(64), default="")
    """Who submitted it."""
    state: orm.Mapped[str] = orm.mapped_column(sa.String(12), default="queued")
    """queued, running, cancelling, cancelled, failed, done"""
    created: orm.Mapped[float] = orm.mapped_column(index=True)
    started: orm.Mapped[float | None]
    finished: orm.Mapped[float | None]
    continues: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("runs.id"))
    """The run whose searches this one goes on with, under larger budgets."""
    snapshot: orm.Mapped[str | None] = orm.mapped_column(sa.ForeignKey("catalogue_snapshots.digest"))
    """What its components meant; None of runs that are older than snapshots."""
    flown: orm.Mapped[JsonObject | None]
    """What flew when its first stage began; see `campaigns.flown`. None before that, and of runs that are older."""
    # queue
    priority: orm.Mapped[int] = orm.mapped_column(default=0)
    attempts: orm.Mapped[int] = orm.mapped_column(default=0)
    max_attempts: orm.Mapped[int] = orm.mapped_column(default=3)
    not_before: orm.Mapped[float] = orm.mapped_column(default=0.0)
    lease_until: orm.Mapped[float] = orm.mapped_column(default=0.0)
    worker: orm.Mapped[str | None] = orm.mapped_column(sa.String(80))
    fence: orm.Mapped[int] = orm.mapped_column(default=0)
    cancel: orm.Mapped[bool] = orm.mapped_column(default=False)
    error: orm.Mapped[str | None] = orm.mapped_column(sa.Text)
    """Why it failed, a sentence."""
    # what the list shows
    verdict: orm.Mapped[str | None] = orm.mapped_column(sa.String(12))
    reason: orm.Mapped[str | None] = orm.mapped_column(sa.Text)
    """The verdict's sentence."""
    summary: orm.Mapped[JsonObject] = orm.mapped_column(default=dict)
    """The verdict's parts and provenance; see `worker.stages.verdict`."""
    threshold: orm.Mapped[float | None]
    nominal_cost: orm.Mapped[float | None]
    worst_cost: orm.Mapped[float | None]
    worst_method: orm.Mapped[str | None] = orm.mapped_column(sa.String(60))
    evaluations: orm.Mapped[int] = orm.mapped_column(default=0)
    planned: orm.Mapped[int] = orm.mapped_column(default=0)
    failed_evaluations: orm.Mapped[int] = orm.mapped_column(default=0)
    upper_bound: orm.Mapped[float | None]
    """Of P(violation), from the independent sample."""
    best_so_far: orm.Mapped[list[Any]] = orm.mapped_column(default=list, server_default="[]")
    """[[evaluations, lowest cost within them]], thinned; see `backend.db.course`."""
    # what people write on it
    pinned: orm.Mapped[bool] = orm.mapped_column(default=False, server_default=sa.false())
    notes: orm.Mapped[str] = orm.mapped_column(sa.Text, default="", server_default="")
    """Markdown."""
    # what became of it
    removed: orm.Mapped[float | None]
    """Since when it is in no list; see `backend.runs.removal`."""
    removed_by: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    removed_reason: orm.Mapped[str | None] = orm.mapped_column(sa.Text)
    purged: orm.Mapped[float | None]
    """Since when its results are gone and this row is all that is left; see `backend.db.purge`."""
    purged_by: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    purged_digest: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """Of the results that it had; see `backend.db.digest`."""
    __table_args__ = (
        sa.Index("ix_runs_queue", "state", "owner", "not_before", "lease_until"),
        # All that the run list searches, filters and sorts by, so that SQLite need not read the wide rows. PostgreSQL
        # keeps wide values outside its rows, and cannot index JSON so.
        sa.Index("ix_runs_list", *_LISTED).ddl_if(dialect="sqlite"),
    )


class Stage(Base):
    """One stage of a run; its result is written once, when it ends."""

    __tablename__ = "stages"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    position: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    kind: orm.Mapped[str] = orm.mapped_column(sa.String(20))
    """nominal, sensitivity, search, certify, validate"""
    method: orm.Mapped[str | None] = orm.mapped_column(sa.String(60))
    state: orm.Mapped[str] = orm.mapped_column(sa.String(12), default="waiting")
    """waiting, running, done"""
    started: orm.Mapped[float | None]
    finished: orm.Mapped[float | None]
    planned: orm.Mapped[int] = orm.mapped_column(default=0)
    evaluations: orm.Mapped[int] = orm.mapped_column(default=0)
    failed: orm.Mapped[int] = orm.mapped_column(default=0)
    excluded: orm.Mapped[int] = orm.mapped_column(default=0)
    best: orm.Mapped[float | None]
    best_index: orm.Mapped[int | None]
    seconds: orm.Mapped[float] = orm.mapped_column(default=0.0)
    """Working time, attempts added up [s]."""
    result: orm.Mapped[JsonObject | None]


class EvaluationChunk(Base):
    """Consecutive evaluations of one stage as columns: points (m, n), costs (m, k), status (m,), seconds (m,)."""

    __tablename__ = "evaluation_chunks"
    run_id: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    position: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    first: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    count: orm.Mapped[int]
    points: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64 on the unit cube."""
    costs: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64, NaN where the status is not ok."""
    status: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """uint8: 0 ok, 1 failed, 2 timeout, 3 excluded."""
    seconds: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64, working time of the stage when each was known [s]."""
    reasons: orm.Mapped[JsonObject] = orm.mapped_column(default=dict)
    """{index in the stage: why} for every evaluation that is not ok."""
    __table_args__ = (
        sa.ForeignKeyConstraint(["run_id", "position"], ["stages.run_id", "stages.position"], ondelete="CASCADE"),
    )


class Finding(Base):
    """One distinct worst case; parameters at full precision."""

    __tablename__ = "findings"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    label: orm.Mapped[str] = orm.mapped_column(sa.String(8), primary_key=True)
    """F1 is the worst."""
    cost: orm.Mapped[float]
    margin: orm.Mapped[float]
    parameters: orm.Mapped[JsonObject]
    """{path: value} in the parameters' units."""
    point: orm.Mapped[list[Any]]
    """On the unit cube."""
    methods: orm.Mapped[list[Any]]
    """Search methods that came to it by themselves; none where only polishing did."""
    found: orm.Mapped[list[Any]] = orm.mapped_column(default=list, server_default="[]")
    """[{position, method, evaluations}]: stages that came to it, and after how many of their evaluations."""
    at_bounds: orm.Mapped[JsonObject]
    """{path: "low" | "high"}"""
    validation: orm.Mapped[JsonObject]
    slices: orm.Mapped[JsonObject | None]
    """Through the finding; this and what follows as in `campaigns.results.finding`."""
    boundary: orm.Mapped[JsonObject | None]
    closest: orm.Mapped[JsonObject | None]


class Trace(Base):
    """The flight that shows the nominal case or a finding, as columns of float64."""

    __tablename__ = "traces"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(12), primary_key=True)
    """nominal, F1, F2, ..."""
    columns: orm.Mapped[list[Any]]
    """[{name, symbol, unit, group}] in the order of the columns; `campaigns.trace` says which groups there are."""
    rows: orm.Mapped[int]
    data: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    """float64, (rows, columns)."""
    meta: orm.Mapped[JsonObject]
    """closest: {time, value, position, obstacle}; obstacles: [{position, radius, ...}]; goal; parameters."""


class Worker(Base):
    """A worker's supervisor as it last beat."""

    __tablename__ = "workers"
    name: orm.Mapped[str] = orm.mapped_column(sa.String(80), primary_key=True)
    host: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    pid: orm.Mapped[int]
    started: orm.Mapped[float]
    beat: orm.Mapped[float]
    run_id: orm.Mapped[int | None]


class RunText(Base):
    """The text that a run's campaign was submitted as, with its comments and order; none where a document was given."""

    __tablename__ = "run_texts"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """YAML or JSON; it means the run's campaign."""


class IdempotencyKey(Base):
    """A submit that was already answered: the same key gives the same run, another body under it is refused."""

    __tablename__ = "idempotency_keys"
    key: orm.Mapped[str] = orm.mapped_column(sa.String(128), primary_key=True)
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    body: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"))
    created: orm.Mapped[float]


class Signoff(Base):
    """A reviewer's sign-off of a run's results; never edited, only withdrawn. While it stands, its run stays."""

    __tablename__ = "signoffs"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id"), index=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    role: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    comment: orm.Mapped[str] = orm.mapped_column(sa.Text)
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """Of the results that were signed; see `backend.db.digest`."""
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    created: orm.Mapped[float]
    withdrawn: orm.Mapped[float | None]
    withdrawn_by: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    withdrawn_reason: orm.Mapped[str | None] = orm.mapped_column(sa.Text)


class Draft(Base):
    """A campaign that is being prepared, as it was typed: it may be incomplete or wrong. Anybody may go on with it."""

    __tablename__ = "drafts"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    version: orm.Mapped[int] = orm.mapped_column(default=1)
    """Goes up with every save; a save that names an older one is refused."""
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    tags: orm.Mapped[list[Any]]
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """YAML or JSON."""
    owner: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """Who made it."""
    created: orm.Mapped[float]
    saved: orm.Mapped[float] = orm.mapped_column(index=True)
    saved_by: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    run_id: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="SET NULL"))
    """The run that was last started from it."""
    # A number is never given again: an address that named a deleted draft must not lead to another one.
    __table_args__ = ({"sqlite_autoincrement": True},)


class Audit(Base):
    """Who did what, and when; see `backend.db.audit`."""

    __tablename__ = "audit"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    at: orm.Mapped[float] = orm.mapped_column(index=True)
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    via: orm.Mapped[str] = orm.mapped_column(sa.String(12))
    action: orm.Mapped[str] = orm.mapped_column(sa.String(40))
    subject: orm.Mapped[str] = orm.mapped_column(sa.String(80), index=True)
    detail: orm.Mapped[JsonObject]
