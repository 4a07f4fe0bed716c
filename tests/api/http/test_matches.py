"""If-Match: an edit of what another user has changed since it was read is refused, and nothing is changed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from backend.http.matches import require_match, tag
from tests.api.conftest import Fresh
from tests.given.busy_service import occupied
from tests.given.problem_documents import problem
from tests.given.service import Service


@pytest.fixture(scope="module")
def service(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with occupied(fresh_sqlite, tmp_path_factory.mktemp("matches")) as service:
        yield service


@pytest.fixture(scope="module")
def client(service: Service) -> Iterator[httpx.Client]:
    with service.signed_in() as client:
        client.post("/api/v1/users", json={"name": "ann", "role": "viewer"})
        yield client


DRAFT = {"name": "", "text": "name: x"}
EDITS: dict[str, tuple[str, str, list[dict[str, Any]]]] = {
    "a run": ("/api/v1/runs/R-0002", "PATCH", [{"name": "first"}, {"tags": ["second"]}, {"pinned": True}]),
    "a draft": ("/api/v1/drafts/D-0001", "PUT", [{**DRAFT, "version": v} for v in (1, 2, 3)]),
    "a user": ("/api/v1/users/ann", "PATCH", [{"role": "engineer"}, {"role": "reviewer"}, {"disabled": True}]),
    "settings": ("/api/v1/settings", "PATCH", [{"own_sign_offs": on} for on in (True, False, True)]),
}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", EDITS)
def test_the_second_of_two_who_read_the_same_is_refused(client: httpx.Client, name: str) -> None:
    path, method, (first, second, third) = EDITS[name]
    read = client.get(path).headers["etag"]
    assert client.get(path).headers["etag"] == read
    changed = client.request(method, path, json=first, headers={"If-Match": read})
    assert changed.status_code == 200, changed.text
    assert changed.headers["etag"] not in ("", read)
    before = client.get(path)
    assert before.headers["etag"] == changed.headers["etag"]
    for given in (read, f"W/{before.headers['etag']}", '"x"', "nonsense", '"x", W/"y"'):
        refused = problem(client.request(method, path, json=second, headers={"If-Match": given}), 412)
        assert refused["type"] == "urn:clearance:problem:changed"
        assert "read it again" in str(refused["detail"])
    assert client.get(path).json() == before.json()
    listed = f'"x", {before.headers["etag"]}'
    assert client.request(method, path, json=second, headers={"If-Match": listed}).status_code == 200
    assert client.request(method, path, json=third).status_code == 200, "without the header as in earlier versions"


def test_a_run_or_draft_is_removed_as_it_was_read(client: httpx.Client) -> None:
    made = client.post("/api/v1/drafts", json=DRAFT).json()["id"]
    read = client.get(f"/api/v1/drafts/{made}").headers["etag"]
    client.put(f"/api/v1/drafts/{made}", json={**DRAFT, "version": 1})
    problem(client.delete(f"/api/v1/drafts/{made}", headers={"If-Match": read}), 412)
    assert client.delete(f"/api/v1/drafts/{made}", headers={"If-Match": "*"}).status_code == 204
    read = client.get("/api/v1/runs/R-0001").headers["etag"]
    client.patch("/api/v1/runs/R-0001", json={"notes": "keep this"})
    problem(client.delete("/api/v1/runs/R-0001", params={"reason": "r"}, headers={"If-Match": read}), 412)
    assert client.get("/api/v1/runs/R-0001").json()["removed"] is None
    problem(client.patch("/api/v1/runs/R-0999", json={"name": "x"}, headers={"If-Match": "*"}), 404)


def test_progress_is_no_edit(client: httpx.Client) -> None:
    """The tag of a run is that of what users edit: a running run can be edited."""
    before = client.get("/api/v1/runs/R-0002")
    assert client.post("/api/v1/runs/R-0002/cancel").status_code == 200
    after = client.get("/api/v1/runs/R-0002")
    assert before.json()["state"] != after.json()["state"]
    assert before.headers["etag"] == after.headers["etag"]


def test_equal_values_have_equal_tags() -> None:
    assert tag("a", ["b"], None) == tag("a", ["b"], None)
    assert len({tag("a", "b"), tag("ab"), tag(["a", "b"]), tag("a", None), tag("a")}) == 5
    require_match(None, tag(1), "it")
    require_match(" * ", tag(1), "it")


def test_any_tag_matches_only_what_is_there(client: httpx.Client) -> None:
    """RFC 9110, 13.1.1: so that one that was deleted does not come back."""
    given = {"id": "SYS-77", "text": "Keep away."}
    refused = problem(client.put("/api/v1/requirements", json=given, headers={"If-Match": "*"}), 412)
    assert "is not there" in str(refused["detail"])
    assert client.put("/api/v1/requirements", json=given).status_code == 200
    assert client.put("/api/v1/requirements", json=given, headers={"If-Match": "*"}).status_code == 200
