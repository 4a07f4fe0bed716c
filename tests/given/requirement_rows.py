"""Runs whose campaigns state requirements, and the rows of the matrix that are made of them."""

from __future__ import annotations

from typing import Any

import httpx

from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit

AT = "/api/v1/requirements"


def stating(*requirements: Any, threshold: float = 0.5) -> dict[str, Any]:
    return {"threshold": threshold, "requirements": list(requirements)}


def row(client: httpx.Client, key: str) -> dict[str, Any]:
    (found,) = [one for one in client.get(AT).json()["items"] if one["id"] == key]
    return dict(found)


def ran(service: Service, client: httpx.Client, *requirements: Any, verdict: str = "cleared", **changes: Any) -> str:
    run = submit(client, **{"criterion": stating(*requirements), **changes})
    finish_fully(service, verdict)
    return run


def sign(client: httpx.Client, run: str) -> None:
    digest = client.get(f"/api/v1/runs/{run}/signoffs").json()["digest"]
    body = {"name": "Grace Hopper", "role": "Independent review", "comment": "", "digest": digest}
    assert client.post(f"/api/v1/runs/{run}/signoffs", json=body).status_code == 201
