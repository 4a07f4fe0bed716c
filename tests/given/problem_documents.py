"""Checks responses that are problem documents."""

from __future__ import annotations

import httpx


def problem(response: httpx.Response, status: int, kind: str = "") -> dict[str, object]:
    """The problem document that the answer must be; kind: the last part of its type."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["status"] == status
    assert document["type"].startswith(f"urn:clearance:problem:{kind}")
    assert not kind or document["type"].endswith(f":{kind}")
    assert document["title"]
    assert document["detail"]
    assert document["instance"] == response.request.url.path
    return dict(document)
