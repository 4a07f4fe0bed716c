"""The tables of catalogues, code versions, measurements of simulators, and webhooks.

Import them from `backend.db.tables`.
"""

from __future__ import annotations

from enum import StrEnum

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base
from campaigns.documents import JsonObject


class CatalogueDocument(Base):
    """The catalogue of the newest worker; a single row."""

    __tablename__ = "catalogue"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    document: orm.Mapped[JsonObject]
    published: orm.Mapped[float]
    code: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """Code digest of that worker."""
    departed: orm.Mapped[float | None]
    """When a worker last stopped in an orderly way."""


class CatalogueSnapshot(Base):
    """The component and method descriptions of a campaign when its run was submitted, by digest; shared by runs."""

    __tablename__ = "catalogue_snapshots"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    document: orm.Mapped[JsonObject]
    """A catalogue with only the entries that were used; see `campaigns.checked.snapshot`."""
    created: orm.Mapped[float]


class CodeVersion(Base):
    """The module digests of an installation's code, by their overall digest; shared by runs."""

    __tablename__ = "code_versions"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    modules: orm.Mapped[dict[str, str]]
    """{module: digest}; see `campaigns.versions`."""
    created: orm.Mapped[float]


class SimulatorMeasurement(Base):
    """What `clearance check-simulator` measured of a simulator; the newest of each declaration and files."""

    __tablename__ = "simulator_measurements"
    simulator: orm.Mapped[str] = orm.mapped_column(sa.String(160), primary_key=True)
    """Its name with the digest of its declaration, as a run needs it; see `SimulatorEntry.version`."""
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(128), primary_key=True)
    """Of its files, when it was opened."""
    measured: orm.Mapped[float]
    """When [s since 1970]."""
    host: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    result: orm.Mapped[JsonObject]
    """See `campaigns.results.measured.Measured`."""


class WebhookTarget(Base):
    """An address to which messages are sent; the address itself is a secret of the settings and is not stored."""

    __tablename__ = "webhook_targets"
    id: orm.Mapped[str] = orm.mapped_column(sa.String(16), primary_key=True)
    """The first digits of the SHA-256 of its address."""
    since: orm.Mapped[float]
    """When it was first configured; runs that ended before are not reported to it."""


class DeliveryState(StrEnum):
    """The state of a message; failed: not accepted in any attempt."""

    PENDING = "pending"
    DELIVERED = "delivered"
    FAILED = "failed"


class WebhookDelivery(Base):
    """A message of the outbox. A run is reported once to every target."""

    __tablename__ = "webhook_deliveries"
    id: orm.Mapped[str] = orm.mapped_column(sa.String(40), primary_key=True)
    """Sent as `webhook-id`, the same in every attempt."""
    target: orm.Mapped[str] = orm.mapped_column(sa.ForeignKey("webhook_targets.id"))
    run_id: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("runs.id"))
    """None for a test message."""
    type: orm.Mapped[str] = orm.mapped_column(sa.String(40))
    body: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """JSON, exactly as it is signed and sent."""
    state: orm.Mapped[DeliveryState] = orm.mapped_column(default=DeliveryState.PENDING)
    created: orm.Mapped[float] = orm.mapped_column(index=True)
    attempts: orm.Mapped[int] = orm.mapped_column(default=0)
    not_before: orm.Mapped[float] = orm.mapped_column(default=0.0)
    """Time of the next attempt; while an attempt runs, the time after which it counts as lost."""
    attempted: orm.Mapped[float | None]
    """Start of the last attempt."""
    status: orm.Mapped[int | None]
    """HTTP status of the last response; None without one."""
    error: orm.Mapped[str | None] = orm.mapped_column(sa.Text)
    """Why the last attempt failed, a sentence."""
    delivered: orm.Mapped[float | None]
    __table_args__ = (
        sa.UniqueConstraint("target", "run_id", name="uq_webhook_deliveries_run"),
        sa.Index("ix_webhook_deliveries_due", "target", "state", "not_before"),
    )
