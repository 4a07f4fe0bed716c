"""The API schemas of webhooks."""

from __future__ import annotations

from backend.db.tables_installed import DeliveryState
from backend.http.schema import Instant, Schema


class WebhookDelivery(Schema):
    """A message and what became of it. Times are seconds since 1970."""

    id: str
    """Sent as `webhook-id`, the same in every attempt."""
    target: str
    """The target by its id."""
    run: str | None
    """The run that it reports, R-0001; None for a test message."""
    type: str
    """`run.ended` or `test`."""
    configured: bool
    """Whether the settings still name its target; if not, a pending message waits until they do."""
    state: DeliveryState
    attempts: int
    created: Instant
    attempted: Instant | None
    """Start of the last attempt."""
    next_attempt: Instant | None
    """None unless it is pending and configured."""
    status: int | None
    """HTTP status of the last response; None without one."""
    error: str | None
    """Why the last attempt failed."""
    delivered: Instant | None


class WebhookTarget(Schema):
    """An address of the settings to which messages are sent."""

    id: str
    origin: str
    """Scheme, host and port; the rest of the address may be secret."""
    since: Instant | None
    """Runs that end from then on are reported; None until the service has stored it."""
    pending: int
    delivered: int
    failed: int
    last: WebhookDelivery | None
    """The message that was attempted last."""


class Webhooks(Schema):
    """The configured targets."""

    targets: list[WebhookTarget]
