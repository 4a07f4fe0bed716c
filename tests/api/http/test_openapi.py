"""The OpenAPI document: complete, up to date in the front end, and consistent with responses."""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from campaigns.version import VERSION
from tests.given.finished_runs import finish
from tests.given.openapi_document import DOCUMENT, OPERATIONS, conforms
from tests.given.service import Service
from tests.given.submissions import submit

ROOT = Path(__file__).parents[3]


def test_the_version_is_that_of_the_package() -> None:
    assert f'version = "{VERSION}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert DOCUMENT["info"]["version"] == VERSION


@pytest.mark.parametrize(("path", "method", "operation"), OPERATIONS, ids=lambda v: v if isinstance(v, str) else "")
def test_every_operation_is_described(path: str, method: str, operation: dict[str, Any]) -> None:
    assert path.startswith("/api/v1/")
    assert operation["tags"]
    assert operation["summary"]
    assert operation["description"]
    assert "application/problem+json" in operation["responses"]["default"]["content"]
    takes_body = ("/api/v1/runs", "/api/v1/runs/cancel", "/api/v1/runs/remove", "/api/v1/runs/restore")
    takes_body += ("/api/v1/campaigns/check", "/api/v1/campaigns/preview", "/api/v1/drafts", "/api/v1/sweeps")
    takes_body += ("/api/v1/users", "/api/v1/tokens", "/api/v1/requirements/files")
    takes_body += (
        "/api/v1/runs/{run}/flights",
        "/api/v1/runs/{run}/cases",
        "/api/v1/runs/{run}/reweighted",
        "/api/v1/runs/{run}/signoffs",
        "/api/v1/runs/{run}/signoffs/{signoff}/withdraw",
    )
    assert ("requestBody" in operation) == (method in ("patch", "put") or (path in takes_body and method == "post"))


def test_operation_ids_are_short_and_distinct() -> None:
    ids = [operation["operationId"] for _, _, operation in OPERATIONS]
    assert len(ids) == len(set(ids))
    assert all(len(i) < 20 for i in ids)


def test_every_reference_leads_somewhere() -> None:
    text = json.dumps(DOCUMENT)
    names = {part.split('"')[0] for part in text.split("#/components/schemas/")[1:]}
    assert names <= DOCUMENT["components"]["schemas"].keys()


def descriptions(part: Any) -> Iterator[str]:
    """Every description in the document."""
    for name, inner in part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ():
        if name == "description" and isinstance(inner, str):
            yield inner
        else:
            yield from descriptions(inner)


def exists(name: str) -> bool:
    """Whether it is a module of ours, or something in one."""
    try:
        importlib.import_module(name)
    except ModuleNotFoundError:
        module, _, attribute = name.rpartition(".")
        return "." in name and exists(module) and hasattr(importlib.import_module(module), attribute)
    return True


def test_every_module_that_a_description_names_exists() -> None:
    ours = re.compile(r"`((?:backend|campaigns|clearance|worker)(?:\.\w+)+)`")
    named = {name for text in descriptions(DOCUMENT) for name in ours.findall(text)}
    assert len(named) >= 3
    assert [name for name in sorted(named) if not exists(name)] == []


def test_the_service_answers_with_the_same_document(guest: httpx.Client) -> None:
    assert guest.get("/api/v1/openapi.json").json() == DOCUMENT


@pytest.mark.nightly
def test_answers_are_as_described(service: Service, client: httpx.Client) -> None:
    submit(client)
    finish(service)
    submit(client, seed=2)
    client.post("/api/v1/drafts", json={"name": "", "text": "name:"})
    seen = 0
    for path, method, operation in OPERATIONS:
        if method != "get" or path.endswith("/events"):
            continue
        # Of an open view and of simulators: tested in test_view_channel, test_proposals and test_cases.
        if "{key}" in path or "/simulators/" in path or path.endswith("/cases"):
            continue
        # Tested in test_sweeps, test_trends and test_health.
        if "{sweep}" in path or path.endswith(("/trends", "/ready")):
            continue
        content = operation["responses"]["200"]["content"]
        if "application/json" not in content:  # files are tested in test_exports and test_reports
            continue
        address = path.replace("{run}", "R-0001").replace("{draft}", "D-0001").replace("{user}", "local")
        address = address.replace("{name}", "F1" if "traces" in path else "unicycle_static")
        address = address.replace("{file}", "run.json")
        # The code of a run is compared with that of another one.
        answer = client.get(address, params={"against": "R-0002"} if path.endswith("/code") else None)
        assert answer.status_code == 200, address
        conforms(answer.json(), content["application/json"]["schema"], address)
        seen += 1
    assert seen >= 13
