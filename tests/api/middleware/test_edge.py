"""Any input to a route gets a documented response: a problem document, never an internal error.

The values are those that break readers, drivers and databases: digits that are none of ASCII, numbers beyond 64 bits or
beyond what Python reads, halves of surrogate pairs, null characters, far too many or too long of everything.
"""

from __future__ import annotations

import ast
import base64
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from hypothesis import HealthCheck, given, settings

from backend.access.rules import OPEN, READ, RULES
from backend.db.engine import read
from backend.db.tables import Run
from backend.exports.format import known
from backend.http.errors import KINDS
from backend.http.schema import Given
from backend.middleware.hosts import HEALTH
from tests.api.conftest import Fresh
from tests.given.busy_service import occupied
from tests.given.openapi_document import DOCUMENT, JSON, OPERATIONS, held
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.strange_requests import HEADERS, requests

PREFIX = "urn:clearance:problem:"


@pytest.fixture(scope="module")
def service(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with a finished run, a draft, and a stand-in simulation process."""
    with occupied(fresh_sqlite, tmp_path_factory.mktemp("edge")) as service:
        yield service


@pytest.fixture(scope="module")
def client(service: Service) -> Iterator[httpx.Client]:
    with service.visitor(authorization=f"Bearer {service.token()}") as client:
        yield client


BY_DAY, BY_NIGHT = 5, 60
"""Examples for each operation with parameters or a body; by day all bodies and headers still meet some operation."""


@pytest.mark.by_day(24)
@pytest.mark.parametrize("examples", [BY_DAY, pytest.param(BY_NIGHT, marks=pytest.mark.nightly)])
@pytest.mark.parametrize(("path", "method", "operation"), OPERATIONS, ids=lambda v: v if isinstance(v, str) else "")
def test_whatever_is_sent_is_answered_as_described(
    client: httpx.Client, path: str, method: str, operation: dict[str, Any], examples: int
) -> None:
    @settings(
        max_examples=examples if operation.get("parameters") or "requestBody" in operation else 2,
        suppress_health_check=list(HealthCheck),
    )
    @given(requests(path, method, operation))
    def sent(asked: dict[str, Any]) -> None:
        request = client.build_request(**asked)
        answer = client.send(request, stream=True)
        try:
            if "text/event-stream" not in answer.headers.get("content-type", ""):
                answer.read()
                held(answer, operation, asked["extensions"]["elsewhere"])
        finally:
            answer.close()

    sent()


@pytest.mark.by_day(30)
@pytest.mark.parametrize("method", ["GET", "POST", "DELETE"])
@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in HEADERS.items() for value in values])
def test_no_header_ends_in_an_internal_error(client: httpx.Client, method: str, name: str, value: bytes) -> None:
    """Examples reach each header with some operation, but not with one that looks at it."""
    path = {"GET": "/api/v1/runs/R-0001", "POST": "/api/v1/runs/cancel", "DELETE": "/api/v1/drafts/D-9999"}[method]
    body = '{"runs": ["R-9999"]}' if method == "POST" else None
    answer = client.request(method, path, content=body, headers=[(name.encode(), value)])
    assert answer.status_code < 500, answer.text


def test_an_origin_that_is_no_address_is_foreign(client: httpx.Client) -> None:
    answer = client.post("/api/v1/runs/cancel", json={"runs": ["R-9999"]}, headers={"Origin": "http://["})
    assert (answer.status_code, answer.json()["type"].rpartition(":")[2]) == (403, "foreign-origin")


NAMED = {
    "assets of 300 letters": ("GET", "/assets/" + "a" * 300, None, 404),
    "a page of 300 letters": ("GET", "/" + "a" * 300, None, 404),
    "Arabic digits": ("GET", "/api/v1/runs/R-%d9%a0%d9%a0%d9%a0%d9%a1", None, 404),
    "Arabic digits of a draft": ("GET", "/api/v1/drafts/D-%d9%a0%d9%a0%d9%a0%d9%a1", None, 404),
    "Arabic digits of a view": ("GET", "/view/R-%d9%a0%d9%a0%d9%a0%d9%a1/", None, 404),
    "3,000 equal keys": ("GET", "/api/v1/runs?" + "&".join(["tag=x"] * 3000), None, 414),
    "1,000 equal keys": ("GET", "/api/v1/runs?" + "&".join(["tag=x"] * 1000), None, 400),
    "100 equal keys": ("GET", "/api/v1/runs?" + "&".join(["tag=x"] * 100), None, 422),
    "a long query": ("GET", "/api/v1/runs?q=" + "x" * 40_000, None, 414),
    "null in a query": ("GET", "/api/v1/runs?owner=%00", None, 422),
    "half a pair in a name": ("PATCH", "/api/v1/runs/R-0001", '{"name": "\\ud800"}', 422),
    "half a pair in notes": ("PATCH", "/api/v1/runs/R-0001", '{"notes": "\\udfff"}', 422),
    "half a pair in an unknown key": ("PATCH", "/api/v1/runs/R-0001", '{"\\ud800": 1}', 422),
    "null in a name": ("PATCH", "/api/v1/runs/R-0001", '{"name": "a\\u0000"}', 422),
    "null in notes": ("PATCH", "/api/v1/runs/R-0001", '{"notes": "a\\u0000"}', 422),
    "5,000 digits": ("POST", "/api/v1/runs", '{"campaign": {}, "priority": ' + "9" * 5000 + "}", 422),
    "5,000 digits in a version": ("PUT", "/api/v1/drafts/D-0001", '{"version": ' + "9" * 5000 + "}", 400),
    "a version of 33 bits": (
        "PUT", "/api/v1/drafts/D-0001", '{"name": "", "text": "", "version": 4294967296}', 422,
    ),
    "a version of 65 bits": ("DELETE", f"/api/v1/drafts/D-0001?version={2**64}", None, 422),
    "many unknown keys": ("PATCH", "/api/v1/runs/R-0001", json.dumps({f"k{i}": 1 for i in range(9999)}), 422),
}  # fmt: skip


@pytest.mark.parametrize("name", NAMED)
def test_values_that_break_readers_and_databases(client: httpx.Client, name: str) -> None:
    method, url, body, status = NAMED[name]
    began = time.process_time()
    answer = client.request(method, url, content=body, headers={"content-type": "application/json"} if body else {})
    assert time.process_time() - began < 1.0
    problem(answer, status)
    assert len(answer.content) < 50_000


@pytest.mark.by_day(5)
@pytest.mark.parametrize("value", [2**63, -(2**63) - 1, "\ud800", "\0", True, {}, []])
@pytest.mark.parametrize("sort", ["-created", "name", "worst"])
def test_a_cursor_of_our_form_with_what_no_row_can_have(client: httpx.Client, sort: str, value: Any) -> None:
    for parts in ([sort, False, value, 1], [sort, False, None, value]):
        cursor = base64.urlsafe_b64encode(json.dumps(parts).encode()).decode().rstrip("=")
        problem(client.get("/api/v1/runs", params={"sort": sort, "cursor": cursor}), 422)


def test_every_body_is_checked_against_the_rules_for_all() -> None:
    """A new model of a request cannot forget them."""
    import backend.app  # noqa: F401  has every feature define its models

    named = set()
    for _, _, operation in OPERATIONS:
        for content in operation.get("requestBody", {}).get("content", {}).values():
            named.add(content["schema"].get("$ref", "/").rsplit("/", 1)[-1])
    waiting, known = [Given], set()
    while waiting:
        model = waiting.pop()
        known.add(model.__name__)
        waiting += model.__subclasses__()
    assert named - {"", "CampaignBody"} <= known
    assert {"RunSubmit", "DraftReplace"} <= known


def test_every_refusal_in_the_code_is_of_a_known_type() -> None:
    seen = set()
    for file in (Path(__file__).parents[3] / "backend").rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "RefusedError" in text else ():
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "RefusedError":
                kind = node.args[0]
                if isinstance(kind, ast.Constant):
                    assert kind.value in KINDS, f"{file.name}: {kind.value!r}"
                    seen.add(kind.value)
    assert len(seen) > 25


def test_nothing_strange_was_stored(service: Service) -> None:
    with read(service.engine) as reader:
        for name, notes in reader.execute(Run.__table__.select().with_only_columns(Run.name, Run.notes)):
            assert "\0" not in name + notes
            (name + notes).encode()


def test_the_document_names_the_problems_of_every_operation() -> None:
    for path, method, operation in OPERATIONS:
        for status, response in operation["responses"].items():
            assert response["description"], (path, method, status)
            if status.isdigit() and int(status) >= 400:
                schema = response["content"][JSON]["schema"]
                assert schema == {"$ref": "#/components/schemas/ProblemDocument"}
                kinds = [kind.removeprefix(PREFIX) for kind in response["x-problem-types"]]
                assert kinds
                assert all(KINDS[kind].status == int(status) for kind in kinds)
        for parameter in operation.get("parameters", []):
            assert parameter.get("description"), (path, method, parameter["name"])
        assert {"400", "414", "422", "500"} <= operation["responses"].keys()
        assert ("401" in operation["responses"]) == (path not in {*HEALTH, "/api/v1/campaigns/schema"})
        for_all = method == "get" and RULES["GET", path] in (OPEN, READ)
        assert ("403" in operation["responses"]) == (not for_all)


def test_models_are_described_by_the_text_below_their_fields() -> None:
    schemas = DOCUMENT["components"]["schemas"]
    assert schemas["RunSummary"]["properties"]["upper_bound"]["description"].startswith("Upper bound on P(violation)")
    assert schemas["Scenario"]["properties"]["horizon"]["description"] == "[s]"
    objects = {name: schema for name, schema in schemas.items() if schema.get("type") == "object"}
    assert [name for name, schema in objects.items() if not schema.get("description")] == []
    fields = [field for schema in objects.values() for field in schema.get("properties", {}).values()]
    assert sum("description" in field for field in fields) > 100


EXPORTS = [one.file.replace("{label}", "F1") for one in known() if not one.address]


@pytest.mark.nightly
def test_headers_that_are_given_are_documented(client: httpx.Client) -> None:
    queued = client.post("/api/v1/runs", json={"campaign": campaign(seed=9)})
    assert queued.headers["location"].endswith(queued.json()["id"])
    for path, method, operation in OPERATIONS:
        if "/exports/" not in path:
            continue
        for file in EXPORTS:
            answer = client.request(method, path.replace("{run}", "R-0001").replace("{file}", file))
            assert answer.status_code == 200
            assert answer.headers["etag"]
            held(answer, operation)
            again = client.request(method, answer.request.url, headers={"If-None-Match": answer.headers["etag"]})
            assert again.status_code == 304
            held(again, operation)
    submitted = DOCUMENT["paths"]["/api/v1/runs"]["post"]["responses"]
    assert submitted["201"]["headers"].keys() == {"Location"}
    assert "Retry-After" in submitted["503"]["headers"]
