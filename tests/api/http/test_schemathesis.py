"""Requests that schemathesis derives from the OpenAPI document: no 5xx, no status or form that it does not declare.

As anonymous, viewer, engineer and administrator: as one of them a few requests by day, as all of them many by night.
The requests are valid or violate the schema; path parameters are often those of what the service has.
"""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
import requests
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from schemathesis import Case, GenerationMode, openapi
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from backend.access.rules import RULES
from backend.db import access, users
from backend.db.roles import Role
from tests.api.conftest import Fresh
from tests.given.busy_service import occupied
from tests.given.openapi_document import DOCUMENT, OPERATIONS, held
from tests.given.service import Service

CHECKS = [
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]
PRESENT = {"run": "R-0001", "draft": "D-0001", "signoff": "1", "name": "F1", "flight": "F1", "user": "engineer"}
"""Path parameters of what the service has."""

VISITORS = ("anonymous", "viewer", "engineer", "admin")
BY_DAY, BY_NIGHT = 1, 100
"""Examples for each operation."""


def _strict() -> dict[str, Any]:
    """The document without the response for any other status, which would declare them all."""
    document = copy.deepcopy(DOCUMENT)
    for operations in document["paths"].values():
        for operation in operations.values():
            operation["responses"].pop("default", None)
    return document


SCHEMA = openapi.from_dict(_strict())


@pytest.fixture(scope="module")
def service(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with occupied(fresh_sqlite, tmp_path_factory.mktemp("derived")) as service:
        with service.engine.begin() as writer:
            for role in ("viewer", "engineer", "admin"):
                users.accept(writer, users.invite(writer, role, role, "local"), "hash")
        yield service


def cookie(service: Service, visitor: str) -> dict[str, str]:
    """A browser's headers, of a session of its own."""
    if visitor == "anonymous":
        return {}
    with service.engine.begin() as writer:
        secret = access.open_session(writer, visitor, "password")
    return {"cookie": f"{service.settings.cookie}={secret}"}


def sent(client: httpx.Client, case: Case, path: str, method: str) -> int:
    """Send a request as it was derived, and hold its answer against the document; returns its status."""
    if isinstance(case.query, dict) and "wait" in case.query:
        with contextlib.suppress(TypeError, ValueError):
            if 0 < float(case.query["wait"]) <= 30:
                case.query["wait"] = 0  # it would wait as long as it is told
    wanted = case.as_transport_kwargs(base_url=str(client.base_url))
    wanted.pop("cookies", None)
    request = requests.Request(**{**wanted, "headers": dict(wanted["headers"])}).prepare()
    headers = {k: v for k, v in request.headers.items() if k.lower() not in ("cookie", "authorization")}
    content = request.body.encode() if isinstance(request.body, str) else request.body
    answer = client.send(client.build_request(method, request.url or "", headers=headers, content=content), stream=True)
    try:
        if "text/event-stream" in answer.headers.get("content-type", ""):
            return answer.status_code
        answer.read()
        operation = next(o for p, m, o in OPERATIONS if (p, m) == (path, method))
        held(answer, operation)
        yaml = "yaml" in answer.headers.get("content-type", "")  # described as text, which is what a file is
        case.validate_response(answer, checks=CHECKS[:-1] if yaml else CHECKS)
    finally:
        answer.close()
    return answer.status_code


def derived(service: Service, visitor: str, path: str, method: str, examples: int) -> set[int]:
    """Send so many requests to one operation; returns the statuses of the answers."""
    seen: set[int] = set()
    operation = SCHEMA[path][method.upper()]
    names = [parameter["name"] for parameter in SCHEMA.raw_schema["paths"][path][method].get("parameters", ())]
    present = {name: value for name, value in PRESENT.items() if name in names}
    kinds = [operation.as_strategy(generation_mode=GenerationMode.POSITIVE)]
    if examples > 1:
        kinds.append(operation.as_strategy(generation_mode=GenerationMode.NEGATIVE))
    if present and not path.endswith("report.pdf"):  # a browser would be started
        kinds.append(operation.as_strategy(generation_mode=GenerationMode.POSITIVE, path_parameters=present))
    with service.visitor(**cookie(service, visitor)) as client:

        @settings(
            max_examples=examples,
            suppress_health_check=list(HealthCheck),
        )  # fmt: skip
        @given(st.one_of(kinds) if examples > 1 else kinds[-1])
        def one(case: Case) -> None:
            seen.add(sent(client, case, path, method))

        one()
    return seen


NAMED = [(path, method) for path, method, _ in OPERATIONS]


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.nightly)])
def test_a_request_to_every_fourth_operation(service: Service, every: int) -> None:
    """By day test_edge.py sends several to all of them, and compares their answers with the document."""
    seen = {(path, method): derived(service, "admin", path, method, BY_DAY) for path, method in NAMED[::every]}
    done = [operation for operation, statuses in seen.items() if min(statuses) < 300]
    assert len(done) > 0.5 * len(seen), "requests that are refused do not reach the operations"


@pytest.mark.nightly
@pytest.mark.parametrize("visitor", VISITORS)
@pytest.mark.parametrize(("path", "method"), NAMED, ids=lambda v: v)
def test_many_requests_to_every_operation(service: Service, visitor: Role, path: str, method: str) -> None:
    seen = derived(service, visitor, path, method, BY_NIGHT)
    if RULES[method.upper(), path].role is not None and visitor == "anonymous":  # type: ignore[index]
        assert seen == {401} or seen <= {400, 401, 403, 413, 414, 422}
