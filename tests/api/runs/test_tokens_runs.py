"""Runs of a token belong to its user, with the token's name, wherever a run and who submitted it are shown."""

from __future__ import annotations

import json
from collections.abc import Iterator

import httpx
import pytest

from backend.db.engine import read
from backend.runs.quota import Quota
from backend.webhooks import body
from tests.given.joined_users import joined
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

API = "/api/v1"


@pytest.fixture
def launched(service: Service, client: httpx.Client) -> Iterator[tuple[str, str, httpx.Client]]:
    """A user, and the run of their token, which is revoked since."""
    with joined(service, client, "engineer") as (user, browser):
        secret = browser.post(f"{API}/tokens", json={"name": "nightly", "scope": "run"}).json()["secret"]
        with service.visitor(authorization=f"Bearer {secret}") as program:
            run = submit(program)
        browser.delete(f"{API}/tokens/nightly")
        finish_fully(service)
        yield user, run, browser


def test_user_and_token_are_shown_everywhere(
    service: Service, client: httpx.Client, launched: tuple[str, str, httpx.Client]
) -> None:
    user, run, browser = launched
    for found in (browser.get(f"{API}/runs").json()["items"][0], browser.get(f"{API}/runs/{run}").json()):
        assert (found["owner"], found["token"]) == (user, "nightly")
    report = browser.get(f"{API}/runs/{run}/report.html").text
    assert f"<td>Prepared by</td><td>{user} (token nightly)</td>" in report
    assert f"by {user} (token nightly)" in report.partition("Submitted")[2]
    with read(service.engine) as reader:
        data = json.loads(body.ended(reader, 1, ""))["data"]
    assert (data["owner"], data["token"]) == (user, "nightly")
    (entry,) = browser.get(f"{API}/runs/{run}/history").json()
    assert (entry["account"], entry["user"], entry["via"]) == (user, "nightly", "token")
    (row,) = client.get(f"{API}/audit", params={"actor": user, "action": "run"}).json()["items"]
    assert (row["account"], row["user"]) == (user, "nightly")


def test_a_run_is_found_by_user_and_by_token(launched: tuple[str, str, httpx.Client]) -> None:
    user, run, browser = launched
    for query in ({"owner": user}, {"owner": "nightly"}, {"q": "nightly"}, {"q": user}):
        assert [one["id"] for one in browser.get(f"{API}/runs", params=query).json()["items"]] == [run], query
    assert browser.get(f"{API}/runs", params={"owner": "another"}).json()["items"] == []
    assert browser.get(f"{API}/runs/facets").json()["owners"] == [{"value": user, "runs": 1}]


def test_the_user_may_change_it(launched: tuple[str, str, httpx.Client]) -> None:
    _, run, browser = launched
    assert browser.patch(f"{API}/runs/{run}", json={"name": "Renamed"}).status_code == 200


def test_quotas_count_what_tokens_have_launched(
    service: Service, client: httpx.Client, launched: tuple[str, str, httpx.Client]
) -> None:
    """Of the user, also by another token and after the first one was revoked; not of anybody else."""
    user, run, browser = launched
    stored = browser.get(f"{API}/runs/{run}").json()["evaluations"]
    assert stored > 0
    secret = browser.post(f"{API}/tokens", json={"name": "second", "scope": "run"}).json()["secret"]
    with service.visitor(authorization=f"Bearer {secret}") as program:
        for quota, what in ((Quota(100, stored, 10**12), "stored evaluations"), (Quota(0, 10**9, 10**12), "0 runs")):
            service.app.state.quota = quota
            for visitor in (program, browser):
                refused = problem(visitor.post(f"{API}/runs", json={"campaign": campaign()}), 409, "quota-reached")
                assert user in refused["detail"]
                assert what in refused["detail"]
        service.app.state.quota = Quota(1, stored + 1, 10**12)
        submit(program)
        refused = problem(browser.post(f"{API}/runs", json={"campaign": campaign()}), 409, "quota-reached")
        assert f"{user} has 1 run" in refused["detail"]
    submit(client)
