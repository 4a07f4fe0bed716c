"""The tables of webhooks: where messages go, and the outbox of messages. Import them from `backend.db.tables`."""

from __future__ import annotations

from enum import StrEnum

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


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
