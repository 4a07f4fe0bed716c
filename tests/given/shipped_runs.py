"""A shipped campaign as a run whose components are known."""

from __future__ import annotations

from typing import Any

import httpx

from tests.given.service import Service
from tests.given.small_catalogue import published_by_workers


def shipped(service: Service, client: httpx.Client, campaign: str, **scenario: Any) -> str:
    """A run of a campaign of the library, parts of its scenario replaced, with the components that workers publish."""
    service.publish(published_by_workers())
    document = client.get(f"/api/v1/campaigns/{campaign}").json()["document"]
    document["scenario"] |= scenario
    return str(client.post("/api/v1/runs", json={"campaign": document}).json()["id"])
