"""Whatever is sent to a route of the API is answered, and as its document says: no fault of ours, a problem document.

The values are those that break readers, drivers and databases: digits that are none of ASCII, numbers beyond 64 bits or
beyond what Python reads, halves of surrogate pairs, null characters, far too many or too long of everything.
"""

from __future__ import annotations

import ast
import base64
import json
import sys
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from backend.db.engine import read
from backend.db.tables import Run
from backend.errors import KINDS
from backend.previews.service import Previews
from backend.scenes.control.live import Live
from backend.schema import Given
from tests.api.catalogue import campaign
from tests.api.conftest import Fresh, running
from tests.api.finished import finish
from tests.api.server import Service
from tests.api.test_access import problem
from tests.api.test_openapi import DOCUMENT, OPERATIONS
from tests.api.test_previews import STAND_IN
from tests.api.test_runs import submit

PREFIX = "urn:clearance:problem:"
JSON = "application/problem+json"
DIGITS = "@digits@"
"""Stands for a number of 5,000 digits, which Python's own writer refuses."""

TEXTS = [
    *("", " ", "0", "-1", "1", "2", "nan", "inf", "1e400", "true", "null", "F1", "R-0001", "D-0001"),
    *("R-٣٣٣٣", "R-٠٠٠١", "D-٠٠٠١", "F٣", "²", "１", "\0", "a\0b", "R-0001\0", "é", "%", "..", "a/b", "\n"),
    *("9" * n for n in (10, 15, 19, 20, 400, 5000)),
    *("R-" + "9" * n for n in (9, 15, 16, 5000)),
    *("D-" + "9" * n for n in (9, 10)),
    *(str(2**n + k) for n in (31, 32, 53, 62, 63, 64) for k in (-1, 0)),
    *("x" * 300, "x" * 17_000, "v" * 64),
    "00000000-0000-4000-8000-000000000000",
]  # fmt: skip
VALUES: list[Any] = [
    *(None, True, 0, -1, 1, 2**31 - 1, 2**31, 2**32, 2**53, 2**63 - 1, 2**63, 2**64, -(2**63) - 1, 10**300, DIGITS),
    *(1e308, float("inf"), float("nan"), "", "\0", "a\0", "\ud800", "x\udfff", "٣", "x" * 300, "x" * 50_000, "R-٠٠٠١"),
    *([], {}, [None] * 600, ["\ud800"] * 60, {"\ud800": 1}, {"\0": "\0"}, {str(i): i for i in range(300)}, [[[[[]]]]]),
    *([2**64], {"x": 2**64}, {"x": ["a\0"]}, [DIGITS]),
]  # fmt: skip
SORTS = ("-created", "created", "name", "-worst", "tags", "duration")
HEADERS: dict[str, list[bytes]] = {
    "Idempotency-Key": [b"\xff\xfe", b"k" * 128, b"k" * 129, b"", b"\xc2\xb2"],
    "Last-Event-ID": [b"9" * 400, b"nan", b"inf", b"-1", b"\xb2", b"x" * 2000, b"1e400"],
    "If-None-Match": [b"\xff", b"*", b'W/"x"' * 500],
    "Accept-Encoding": [b"\xff", b"br;q=\xb2"],
    "Content-Type": [b"\xff", b"application/json; charset=\xff", b"application/yaml", b"text/csv", b""],
    "Authorization": [b"Bearer \xff", b"Bearer " + b"x" * 5000, b"\xff", b"Basic x"],
    "Origin": [b"http://[", b"null", b"\xff", b"http://x:99999999"],
}
SIGNED = "0" * 64
BODIES: dict[tuple[str, str], dict[str, Any]] = {
    ("post", "/runs"): {"campaign": campaign(), "name": "n", "tags": ["t"], "text": "x: 1", "priority": 0},
    ("post", "/campaigns/check"): {"campaign": campaign()},
    ("post", "/campaigns/preview"): {"campaign": campaign()},
    ("post", "/drafts"): {"name": "n", "tags": ["t"], "text": "x"},
    ("put", "/drafts/{draft}"): {"name": "n", "tags": [], "text": "x", "version": 1, "run": "R-0001"},
    ("post", "/runs/cancel"): {"runs": ["R-0001"]},
    ("post", "/runs/remove"): {"runs": ["R-0003"], "reason": "r"},
    ("post", "/runs/restore"): {"runs": ["R-0001"]},
    ("patch", "/runs/{run}"): {"name": "n", "tags": ["t"], "notes": "n", "pinned": False, "notes_before": ""},
    ("post", "/runs/{run}/signoffs"): {"name": "n", "role": "r", "comment": "c", "digest": SIGNED},
    ("post", "/runs/{run}/signoffs/{signoff}/withdraw"): {"reason": "r"},
    ("patch", "/runs/{run}/views/{key}"): {
        "flight": "F1", "time": 1.0, "eye": {"position": [0, 0, 0], "target": [0, 0, 0]}, "speed": 1.0,
        "layers": {"trail": "whole", "axes": ["value", "none", "none"]}, "what_if": {"vehicle.m": 5.0},
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def service(fresh: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """One with a finished run, a draft, and a simulation process that only stands in."""
    folder = tmp_path_factory.mktemp("edge")
    (folder / "dist" / "assets").mkdir(parents=True)  # a folder that is not there has no names that are too long
    with running(fresh, folder) as service:
        service.publish()
        live = Live((sys.executable, "-c", STAND_IN), limit=10, first_limit=10)
        service.app.state.previews = Previews(live)
        with service.signed_in() as client:
            submit(client)
            finish(service)
            submit(client, seed=2)
            client.post("/api/v1/drafts", json={"name": "", "text": "name:"})
        yield service


@pytest.fixture(scope="module")
def client(service: Service) -> Iterator[httpx.Client]:
    with service.visitor(authorization=f"Bearer {service.token()}") as client:
        yield client


def cursors() -> st.SearchStrategy[str]:
    """Cursors of the right form with values of the wrong kind."""

    def made(parts: tuple[Any, ...]) -> str:
        text = json.dumps(parts).replace(f'"{DIGITS}"', "9" * 400)
        return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")

    return st.tuples(st.sampled_from(SORTS), st.booleans(), st.sampled_from(VALUES), st.sampled_from(VALUES)).map(made)


@cache
def places(document: str) -> list[tuple[Any, ...]]:
    """Every place in a body, as keys from the top."""
    found: list[tuple[Any, ...]] = []

    def walk(value: Any, at: tuple[Any, ...]) -> None:
        found.append(at)
        pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        for key, inner in pairs:
            walk(inner, (*at, key))

    walk(json.loads(document), ())
    return found


def replaced(document: Any, at: tuple[Any, ...], value: Any) -> Any:
    if not at:
        return value
    made = dict(document) if isinstance(document, dict) else list(document)
    made[at[0]] = replaced(made[at[0]], at[1:], value)
    return made


@st.composite
def bodies(draw: st.DrawFn, whole: dict[str, Any]) -> bytes:
    """A body with something strange at one place of it, or none at all."""
    text = json.dumps(whole)
    if draw(st.integers(0, 9)) == 0:
        return draw(
            st.sampled_from([b"", b"{", b"\xff", b"[" * 50_000, b"9" * 5000, text.encode("utf-16"), b'"\\ud800"'])
        )
    made = replaced(whole, draw(st.sampled_from(places(text))), draw(st.sampled_from(VALUES)))
    return json.dumps(made).replace(f'"{DIGITS}"', "9" * 5000).encode()


@st.composite
def requests(draw: st.DrawFn, path: str, method: str, operation: dict[str, Any]) -> dict[str, Any]:
    """A request to the operation, strange in its path, query, headers and body."""
    query: list[tuple[str, str]] = []
    elsewhere = False
    for parameter in operation.get("parameters", []):
        name, kind = parameter["name"], parameter["in"]
        wild = st.sampled_from(TEXTS)
        if kind == "path":
            known = {
                "run": ["R-0001", "R-0002"],
                "draft": ["D-0001"],
                "signoff": ["1"],
                "name": ["F1"],
                "flight": ["F1"],
            }
            value = draw(st.sampled_from(known.get(name, ["x"])) | wild)
            if path.endswith("report.pdf") and value.startswith("R-000"):
                value = "R-9999"  # a browser would be started
            elsewhere |= value in ("", "..") or "/" in value
            path = path.replace(f"{{{name}}}", quoted(value))
        elif kind == "query":
            values = draw(st.lists(cursors() | wild if name == "cursor" else wild, max_size=2))
            if name == "wait" or (name == "run" and path.endswith("/events")):
                values = [value for value in values if not value.isdigit() or int(value) > 30]
            query += [(name, value) for value in values]
            if draw(st.integers(0, 14)) == 0:
                query += [(name, "x")] * draw(st.sampled_from([60, 199, 3000]))
    headers = {}
    if draw(st.booleans()):
        name = draw(st.sampled_from(list(HEADERS)))
        headers[name] = draw(st.sampled_from(HEADERS[name]))
    whole = BODIES.get((method, path_of(operation)))
    content = None if whole is None else draw(bodies(whole))
    if content is not None:
        headers.setdefault("Content-Type", b"application/json")
    target = f"{path}?{'&'.join(f'{k}={quoted(v)}' for k, v in query)}"[:60_000]  # as long as an address can be sent
    asked = {"method": method.upper(), "url": target, "headers": headers, "content": content}
    return asked | {"extensions": {"elsewhere": elsewhere}}


def quoted(value: str) -> str:
    return "".join(f"%{byte:02x}" if not chr(byte).isalnum() or byte > 127 else chr(byte) for byte in value.encode())


def path_of(operation: dict[str, Any]) -> str:
    return next(p for p, _, o in OPERATIONS if o is operation).removeprefix("/api/v1")


def held(answer: httpx.Response, operation: dict[str, Any], elsewhere: bool = False) -> None:
    """The answer is one of those that the operation declares, its problem's type and its headers included.

    elsewhere: what was put into its path made it the address of something else, or of nothing.
    """
    status = str(answer.status_code)
    assert answer.status_code < 500 or status == "503", answer.text[:400]
    if answer.status_code >= 400:
        assert answer.headers["content-type"] == JSON
        assert answer.json()["status"] == answer.status_code
        assert len(answer.content) < 100_000
        answer.content.decode()
    if elsewhere:
        return
    assert status in operation["responses"], (status, answer.text[:300])
    declared = operation["responses"][status]
    if answer.status_code >= 400:
        assert answer.json()["type"] in declared["x-problem-types"]
    for header in ("Location", "ETag", "Retry-After"):
        assert header not in answer.headers or header in declared["headers"]


@pytest.mark.parametrize(("path", "method", "operation"), OPERATIONS, ids=lambda v: v if isinstance(v, str) else "")
def test_whatever_is_sent_is_answered_as_described(
    client: httpx.Client, path: str, method: str, operation: dict[str, Any]
) -> None:
    @settings(
        max_examples=12 if operation.get("parameters") or "requestBody" in operation else 3,
        deadline=None,
        derandomize=True,
        database=None,
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


@pytest.mark.parametrize("value", [2**63, -(2**63) - 1, "\ud800", "\0", True, {}, []])
@pytest.mark.parametrize("sort", ["-created", "name", "worst"])
def test_a_cursor_of_our_form_with_what_no_row_can_have(client: httpx.Client, sort: str, value: Any) -> None:
    for parts in ([sort, False, value, 1], [sort, False, None, value]):
        cursor = base64.urlsafe_b64encode(json.dumps(parts).encode()).decode().rstrip("=")
        problem(client.get("/api/v1/runs", params={"sort": sort, "cursor": cursor}), 422)


def test_every_body_is_held_against_the_rules_for_all() -> None:
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


def test_every_refusal_in_the_code_is_of_a_known_type_and_its_status() -> None:
    seen = set()
    for file in (Path(__file__).parents[2] / "backend").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "RefusedError":
                status, kind = node.args[:2]
                if isinstance(status, ast.Constant) and isinstance(kind, ast.Constant):
                    assert KINDS[str(kind.value)].status == status.value, f"{file.name}: {kind.value}"
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
        assert ("401" in operation["responses"]) == (path != "/api/v1/health")
        assert ("403" in operation["responses"]) == (method != "get")


def test_models_are_described_by_what_stands_below_their_fields() -> None:
    schemas = DOCUMENT["components"]["schemas"]
    assert schemas["RunSummary"]["properties"]["upper_bound"]["description"].startswith("Of P(violation)")
    assert schemas["Scenario"]["properties"]["horizon"]["description"] == "[s]"
    objects = {name: schema for name, schema in schemas.items() if schema.get("type") == "object"}
    assert [name for name, schema in objects.items() if not schema.get("description")] == []
    fields = [field for schema in objects.values() for field in schema.get("properties", {}).values()]
    assert sum("description" in field for field in fields) > 100


def test_headers_that_are_given_are_documented(client: httpx.Client) -> None:
    queued = client.post("/api/v1/runs", json={"campaign": campaign(seed=9)})
    assert queued.headers["location"].endswith(queued.json()["id"])
    for path, method, operation in OPERATIONS:
        if "/exports/" in path:
            answer = client.request(method, path.replace("{run}", "R-0001").replace("{flight}", "F1"))
            assert answer.status_code == 200
            assert answer.headers["etag"]
            held(answer, operation)
            again = client.request(method, answer.request.url, headers={"If-None-Match": answer.headers["etag"]})
            assert again.status_code == 304
            held(again, operation)
    submitted = DOCUMENT["paths"]["/api/v1/runs"]["post"]["responses"]
    assert submitted["201"]["headers"].keys() == {"Location"}
    assert "Retry-After" in submitted["503"]["headers"]
