"""Checks responses that are problem documents."""

from __future__ import annotations

import httpx


def problem(response: httpx.Response, status: int) -> dict[str, object]:
    """The problem document that the answer must be."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["status"] == status
    assert document["type"].startswith("urn:clearance:problem:")
    assert document["title"]
    assert document["detail"]
    assert document["instance"] == response.request.url.path
    return dict(document)
