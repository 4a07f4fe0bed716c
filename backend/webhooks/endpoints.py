"""GET /webhooks, their deliveries, and a test message."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.http.deps import Reader
from backend.http.errors import problems
from backend.webhooks import service
from backend.webhooks.configuration import Configured as Settings
from backend.webhooks.dispatcher import Dispatcher
from backend.webhooks.schemas import WebhookDelivery, Webhooks

router = APIRouter(tags=["webhooks"])


async def configured(request: Request) -> Settings:
    dispatcher = request.app.state.webhooks
    assert isinstance(dispatcher, Dispatcher)
    return dispatcher.configured


Configured = Annotated[Settings, Depends(configured)]


@router.get("/webhooks")
def get_webhooks(reader: Reader, configured: Configured) -> Webhooks:
    """The addresses of the settings that receive a message when a run ends, with the state of their messages."""
    return service.state(reader, configured)


@router.get("/webhooks/deliveries")
def list_deliveries(
    reader: Reader,
    configured: Configured,
    limit: Annotated[int, Query(ge=1, le=500, description="Maximum number of messages.")] = 100,
) -> list[WebhookDelivery]:
    """The newest messages to all targets, newest first."""
    return service.deliveries(reader, configured, limit)


@router.post(
    "/webhooks/test",
    status_code=status.HTTP_202_ACCEPTED,
    responses=problems("no-webhook", *ONCE),
)
def test_webhooks(once: OnceOnly, configured: Configured, visitor: CurrentVisitor) -> list[WebhookDelivery]:
    """Send a message of type `test` to every target; while one still waits, it is that one.

    `GET /webhooks/deliveries` shows the outcome.
    """
    return once.do(
        list[WebhookDelivery],
        lambda writer: service.test(writer, configured, visitor),
        lambda sent: ", ".join(one.id for one in sent),
    )
