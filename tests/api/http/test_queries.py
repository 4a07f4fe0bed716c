"""Names of a query that an operation does not take: refused before anything is done, with what it takes."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from tests.given.openapi_document import DOCUMENT, OPERATIONS, filled
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign

FREE = {
    f"/api/v1/health{check}": "monitors and load balancers may append names of their own"
    for check in ("", "/live", "/ready")
}
"""Operations that take any query, and why."""
NAMED = [
    (path, method, [p["name"] for p in operation.get("parameters", ()) if p["in"] == "query"])
    for path, method, operation in OPERATIONS
]


@pytest.mark.by_day(24)
@pytest.mark.parametrize(("path", "method", "names"), NAMED, ids=lambda v: v if isinstance(v, str) else "")
def test_an_unknown_name_alone_is_refused(
    still: Service, guest: httpx.Client, path: str, method: str, names: list[str]
) -> None:
    """Those that the document describes are not, whatever their values are."""
    before = still.rows()
    answer = guest.request(method, filled(path), params=[*((name, "~") for name in names), ("zzz", "1")])
    if path in FREE:
        assert answer.status_code != 422
        return
    refused: dict[str, Any] = problem(answer, 422)
    assert refused["type"] == "urn:clearance:problem:invalid-request"
    (error,) = refused["errors"]
    assert (error["field"], error["given"]) == ("zzz", "1")
    assert [name for name in names if name not in error["message"]] == []
    assert still.rows() == before
    assert guest.get("/api/v1/session").status_code == 200


def test_the_exceptions_are_operations_and_the_description_names_the_rule() -> None:
    assert FREE.keys() <= {path for path, _, _ in NAMED}
    assert "`invalid-request`" in DOCUMENT["info"]["description"]


MISTYPED = {
    "a baseline": ("post", "/runs", {"baselin": "R-0001"}, {"baselin": "baseline"}),
    "a label": ("post", "/runs", {"labl": "branch=main", "label": "a=b"}, {"labl": "label"}),
    "a filter": ("get", "/runs", {"verdit": "cleared"}, {"verdit": "verdict"}),
    "two": ("get", "/runs", {"Tag": "x", "limits": "1"}, {"Tag": "tag", "limits": "limit"}),
}


@pytest.mark.parametrize("case", MISTYPED)
def test_a_mistyped_name_is_refused_with_the_likely_one(still: Service, guest: httpx.Client, case: str) -> None:
    method, path, query, likely = MISTYPED[case]
    before = still.rows()
    body: dict[str, Any] = {"json": {"campaign": campaign()}} if method == "post" else {}
    errors: Any = problem(guest.request(method, f"/api/v1{path}", params=query, **body), 422)["errors"]
    assert {error["field"] for error in errors} == likely.keys()
    assert [error for error in errors if f"{likely[error['field']]!r}?" not in error["message"]] == []
    assert still.rows() == before


def test_many_and_long_names_have_a_short_answer(guest: httpx.Client) -> None:
    answer = guest.get("/api/v1/runs", params={f"{'n' * 80}{i}": "v" * 80 for i in range(90)})
    errors = problem(answer, 422)["errors"]
    assert isinstance(errors, list)
    assert len(errors) <= 51
    assert len(answer.content) < 50_000
