"""Drafts: original text, no lost updates, deletion recorded in the audit trail."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Audit
from backend.drafts import service as drafts
from tests.given.databases import AT_NIGHT, BOTH
from tests.given.joined_users import joined
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit

DRAFTS = "/api/v1/drafts"
TEXT = "name: Half a campaign\nscenario:\n  vehicle: {component: # to be decided\n"


def given(**changes: Any) -> dict[str, Any]:
    return {"name": "Release 2.4", "tags": ["baseline"], "text": TEXT} | changes


def kept(client: httpx.Client, **changes: Any) -> dict[str, Any]:
    answer = client.post(DRAFTS, json=given(**changes))
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


def test_a_draft_stores_its_original_text_even_if_it_is_not_a_campaign(client: httpx.Client) -> None:
    draft = kept(client)
    assert (draft["id"], draft["version"], draft["run"]) == ("D-0001", 1, None)
    assert (draft["name"], draft["tags"], draft["text"]) == ("Release 2.4", ["baseline"], TEXT)
    assert draft["owner"] == draft["saved_by"] != ""
    assert draft["created"] == draft["saved"]
    assert client.get(f"{DRAFTS}/D-0001").json() == draft
    untitled = kept(client, name="", text="")
    del draft["text"], untitled["text"]
    assert client.get(DRAFTS).json() == [untitled, draft]


@BOTH
def test_saving_requires_the_current_version(service: Service, client: httpx.Client) -> None:
    draft = kept(client)
    saved = client.put(f"{DRAFTS}/D-0001", json=given(text="name: Better", version=draft["version"])).json()
    assert (saved["version"], saved["text"], saved["created"]) == (2, "name: Better", draft["created"])
    repeated = client.put(f"{DRAFTS}/D-0001", json=given(text="name: Better", version=draft["version"]))
    assert repeated.json() == saved, "as when its answer was lost"
    with service.visitor(Authorization=f"Bearer {service.token('colleague')}") as other:
        theirs = other.put(f"{DRAFTS}/D-0001", json=given(text="name: Theirs", version=2)).json()
    assert (theirs["version"], theirs["saved_by"], theirs["owner"]) == (3, "colleague", draft["owner"])
    mine = client.put(f"{DRAFTS}/D-0001", json=given(text="name: Mine", version=2))
    refused = str(problem(mine, 409, "draft-changed")["detail"])
    assert " colleague " in refused
    assert "version 3, yours is 2" in refused
    assert client.get(f"{DRAFTS}/D-0001").json()["text"] == "name: Theirs"


@AT_NIGHT
def test_a_draft_names_the_run_launched_from_it(client: httpx.Client) -> None:
    kept(client)
    run = submit(client)
    linked = client.put(f"{DRAFTS}/D-0001", json=given(version=1, run=run)).json()
    assert linked["run"] == run
    assert client.put(f"{DRAFTS}/D-0001", json=given(version=2)).json()["run"] == run
    problem(client.put(f"{DRAFTS}/D-0001", json=given(version=3, run="R-0099")), 404)


@AT_NIGHT
def test_deleting_is_noted_and_a_number_is_never_given_again(service: Service, client: httpx.Client) -> None:
    kept(client)
    problem(client.delete(f"{DRAFTS}/D-0001", params={"version": 2}), 409)
    assert client.delete(f"{DRAFTS}/D-0001", params={"version": 1}).status_code == 204
    problem(client.get(f"{DRAFTS}/D-0001"), 404)
    problem(client.delete(f"{DRAFTS}/D-0001"), 404)
    problem(client.put(f"{DRAFTS}/D-0001", json=given(version=1)), 404)
    assert kept(client)["id"] == "D-0002"
    with service.engine.connect() as connection:
        (row,) = connection.execute(sa.select(Audit.__table__).where(Audit.action == "draft.deleted"))
    assert (row.subject, row.detail["name"]) == ("D-0001", "Release 2.4")


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"name": "x" * 121}, "name"),
        ({"tags": ["two words"]}, "tags.0"),
        ({"text": "x" * 500_001}, "text"),
        ({"text": "a\0b"}, "text"),
        ({"version": 1}, "version"),
    ],
)
def test_what_is_no_draft_is_refused_by_field(guest: httpx.Client, changes: dict[str, Any], field: str) -> None:
    refused = problem(guest.post(DRAFTS, json=given(**changes)), 422)
    assert [error["field"] for error in refused["errors"]] == [field]
    assert guest.get(DRAFTS).json() == []


def test_other_names_are_no_drafts(guest: httpx.Client) -> None:
    for name in ("D-9999", "R-0001", "D-1234567890", "D-0x1"):
        problem(guest.get(f"{DRAFTS}/{name}"), 404)


def test_there_is_an_end_to_drafts(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drafts, "MOST", 1)
    kept(client)
    assert "delete some first" in problem(client.post(DRAFTS, json=given()), 409)["detail"]


def test_a_user_has_so_many_drafts_and_others_have_theirs(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drafts, "MOST_EACH", 1)
    kept(client)
    with service.visitor(authorization=f"Bearer {service.token('more')}") as program:  # of the same user
        assert "you have 1 drafts" in problem(program.post(DRAFTS, json=given()), 409)["detail"]
    with joined(service, client, "engineer") as (_, other):
        assert other.post(DRAFTS, json=given()).status_code == 201
