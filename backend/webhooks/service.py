"""The state of the webhooks: targets, and the newest messages."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db import audit
from backend.db.access import Visitor
from backend.db.engine import insert, now
from backend.db.tables import WebhookDelivery as Row
from backend.db.tables import WebhookTarget as TargetRow
from backend.db.tables_installed import DeliveryState
from backend.http.errors import RefusedError
from backend.webhooks import outbox
from backend.webhooks.configuration import Configured, Target
from backend.webhooks.schemas import WebhookDelivery, Webhooks, WebhookTarget
from campaigns.runs import run_name


def state(reader: sa.Connection, configured: Configured) -> Webhooks:
    return Webhooks(targets=[_target(reader, target, configured) for target in configured.targets])


def deliveries(reader: sa.Connection, configured: Configured, limit: int) -> list[WebhookDelivery]:
    rows = reader.execute(sa.select(Row.__table__).order_by(Row.created.desc(), Row.id).limit(limit)).mappings()
    return [_delivery(row, configured) for row in rows]


def test(writer: sa.Connection, configured: Configured, visitor: Visitor) -> list[WebhookDelivery]:
    """Queue a test message to every target; 409 if there is no target."""
    if not configured.targets:
        detail = (
            "no webhook is configured: set CLEARANCE_WEBHOOKS and CLEARANCE_WEBHOOK_SECRET, then restart the service"
        )
        raise RefusedError("no-webhook", detail)
    made = []
    for target in configured.targets:
        row = insert(writer, TargetRow).values(id=target.id, since=now(writer))
        writer.execute(row.on_conflict_do_nothing())
        made.append(outbox.test(writer, target.id))
    audit.note(writer, visitor, "webhooks.tested", "webhooks", {"messages": made})
    rows = writer.execute(sa.select(Row.__table__).where(Row.id.in_(made)).order_by(Row.id)).mappings()
    return [_delivery(row, configured) for row in rows]


def _target(reader: sa.Connection, target: Target, configured: Configured) -> WebhookTarget:
    mine = Row.target == target.id
    numbers = dict(reader.execute(sa.select(Row.state, sa.func.count()).where(mine).group_by(Row.state)).all())
    tried = sa.select(Row.__table__).where(mine, Row.attempted.is_not(None))
    last = reader.execute(tried.order_by(Row.attempted.desc()).limit(1)).mappings().first()
    return WebhookTarget(
        id=target.id,
        origin=target.origin,
        since=reader.scalar(sa.select(TargetRow.since).where(TargetRow.id == target.id)),
        **{name: numbers.get(name, 0) for name in DeliveryState},
        last=None if last is None else _delivery(last, configured),
    )


def _delivery(row: Any, configured: Configured) -> WebhookDelivery:
    known = row["target"] in [target.id for target in configured.targets]
    same = ("id", "target", "type", "state", "attempts", "created", "attempted", "status", "error", "delivered")
    return WebhookDelivery(
        **{name: row[name] for name in same},
        run=None if row["run_id"] is None else run_name(row["run_id"]),
        configured=known,
        next_attempt=row["not_before"] if known and row["state"] == DeliveryState.PENDING else None,
    )
