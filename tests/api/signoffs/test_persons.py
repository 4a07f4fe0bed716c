"""One person signs once: under the account, whatever name, title or token; without accounts under the name as typed."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Audit, Signoff, Token, User
from tests.given.databases import BOTH
from tests.given.joined_users import joined
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit

TITLE = "Independent review"
Reviewer = tuple[str, httpx.Client]


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """The address of the sign-offs of a run that `local` launched."""
    run = submit(client)
    finish_fully(service)
    return f"/api/v1/runs/{run}/signoffs"


@pytest.fixture
def reviewer(service: Service, client: httpx.Client) -> Iterator[Reviewer]:
    with joined(service, client, "reviewer") as user:
        yield user


def body(client: httpx.Client, run: str, **more: Any) -> dict[str, Any]:
    return {"role": TITLE, "digest": client.get(run).json()["digest"], **more}


def store(service: Service, run: str, client: httpx.Client, **values: Any) -> None:
    """A sign-off that an earlier version stored."""
    row = {"run_id": 1, "role": TITLE, "comment": "", "digest": client.get(run).json()["digest"], "created": 1.0}
    with service.engine.begin() as writer:
        writer.execute(sa.insert(Signoff).values(**row | values))


@pytest.mark.nightly
def test_an_account_signs_under_its_name_and_once(service: Service, run: str, reviewer: Reviewer) -> None:
    user, browser = reviewer
    assert browser.get(run).json()["signs_as"] == user
    detail = str(problem(browser.post(run, json=body(browser, run, name="Grace Hopper")), 422)["detail"])
    assert f"{user} is signed in" in detail
    signed = browser.post(run, json=body(browser, run, name=user)).json()
    assert (signed["name"], signed["typed"], signed["stated"], signed["role"]) == (user, False, None, TITLE)
    for role in (TITLE, "Safety authority"):
        refused = problem(browser.post(run, json=body(browser, run, role=role)), 409)
        assert refused["type"] == "urn:clearance:problem:already-signed"
    assert browser.get(run).json()["barred"] == refused["detail"], "the page says what the service would"
    with service.engine.connect() as reader:
        created = reader.scalar(sa.select(Audit.detail).where(Audit.action == "signoff.created")) or {}
    assert (created["name"], created["typed"], created["role"]) == (user, False, TITLE)
    browser.post(f"{run}/{signed['id']}/withdraw", json={"reason": "read again"})
    assert browser.get(run).json()["barred"] is None
    assert browser.post(run, json=body(browser, run)).status_code == 201


def test_a_token_signs_as_its_user(service: Service, run: str, reviewer: Reviewer) -> None:
    user, browser = reviewer
    with service.engine.begin() as writer:
        writer.execute(sa.update(User).where(User.name == user).values(role="admin"))
    made = browser.post("/api/v1/tokens", json={"name": "robot", "scope": "admin"})
    with service.visitor(authorization=f"Bearer {made.json()['secret']}") as program:
        signed = program.post(run, json=body(program, run)).json()
        assert (signed["name"], signed["account"], signed["user"]) == (user, user, "robot")
    problem(browser.post(run, json=body(browser, run)), 409)
    browser.delete("/api/v1/tokens/robot")
    assert browser.get(run).json()["items"][0]["name"] == user
    with service.engine.begin() as writer:  # no version deletes either: what is stored with the sign-off is enough
        writer.execute(sa.delete(Token).where(Token.name == "robot"))
        writer.execute(sa.delete(User).where(User.name == user))
    with service.signed_in() as other:
        assert other.get(run).json()["items"][0]["name"] == user


def test_the_login_link_is_an_account_where_there_are_accounts(
    run: str, client: httpx.Client, reviewer: Reviewer
) -> None:
    assert client.get(run).json()["signs_as"] == "local"
    problem(client.post(run, json=body(client, run, name="Grace Hopper")), 422)
    client.patch("/api/v1/settings", json={"own_sign_offs": True})
    signed = client.post(run, json=body(client, run)).json()
    assert (signed["name"], signed["typed"]) == ("local", False)
    problem(client.post(run, json=body(client, run, role="Safety authority")), 409)


def test_two_names_of_one_account_are_that_account(service: Service, run: str, reviewer: Reviewer) -> None:
    """As an earlier version stored them: everywhere the account, with what was typed beside it."""
    user, browser = reviewer
    for name in ("Grace Hopper", "Alan Turing"):
        store(service, run, browser, name=name, user=user, account=user)
    items = browser.get(run).json()["items"]
    assert [(one["name"], one["stated"]) for one in items] == [(user, "Grace Hopper"), (user, "Alan Turing")]
    problem(browser.post(run, json=body(browser, run)), 409)
    text = browser.get(run.replace("signoffs", "report.html")).text
    assert text.count(f'<span class="b">{user}</span>') == 2
    assert "Alan Turing" in text


def test_a_typed_name_of_earlier_stays_typed(service: Service, run: str, client: httpx.Client) -> None:
    store(service, run, client, name="Grace Hopper", user="local", account="local")
    (one,) = client.get(run).json()["items"]
    assert (one["name"], one["typed"]) == ("Grace Hopper", True)
    assert "without an account" in client.get(run.replace("signoffs", "report.html")).text
    problem(client.post(run, json=body(client, run, name="grace hopper")), 409)


@pytest.mark.by_day(1)
@BOTH
def test_sign_offs_at_the_same_time_are_one(run: str, client: httpx.Client) -> None:
    sent = body(client, run, name="Grace Hopper")
    with ThreadPoolExecutor(6) as pool:
        answers = list(pool.map(lambda _: client.post(run, json=sent).status_code, range(6)))
    assert sorted(answers) == [201, 409, 409, 409, 409, 409]
    assert len(client.get(run).json()["items"]) == 1
