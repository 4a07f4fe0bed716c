"""A shipped campaign as a run whose components are known. Start reading at `shipped`."""

from __future__ import annotations

import httpx

from tests.api.catalogue import published_by_workers
from tests.api.server import Service


def shipped(service: Service, client: httpx.Client, campaign: str) -> str:
    """A run of a campaign of the library, with the components as workers publish them."""
    service.publish(published_by_workers())
    document = client.get(f"/api/v1/campaigns/{campaign}").json()["document"]
    return str(client.post("/api/v1/runs", json={"campaign": document}).json()["id"])
