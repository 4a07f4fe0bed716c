"""Annotations of submitted runs, and cancelling several at once."""

from __future__ import annotations

import hashlib
from typing import Any

import httpx
import numpy as np
import pytest
import sqlalchemy as sa

from backend.db.tables import Audit
from tests.given.databases import BOTH
from tests.given.finished_runs import Work, finish, search
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

NOTES = "# Why\n\nThe *planning radius* is <b>75 m</b>."


@pytest.mark.by_day(2)
@pytest.mark.parametrize("given", ["", " ", "a\nb", "a\x1bb", "x" * 121, "\u202eevil"])
def test_a_name_is_checked_as_at_submission(service: Service, client: httpx.Client, given: str) -> None:
    run = submit(client)
    assert client.patch(f"/api/v1/runs/{run}", json={"name": given}).status_code == 422
    assert client.post("/api/v1/runs", json={"campaign": campaign(), "name": given}).status_code == 422


def test_name_tags_notes_and_pin_are_stored(client: httpx.Client) -> None:
    run = submit(client)
    before = client.get(f"/api/v1/runs/{run}").json()
    assert (before["notes"], before["pinned"]) == ("", False)
    given = {"name": "Release 2.4", "tags": ["a", "b", "a"], "notes": NOTES, "pinned": True}
    answer = client.patch(f"/api/v1/runs/{run}", json=given)
    assert answer.status_code == 200
    after = client.get(f"/api/v1/runs/{run}").json()
    assert answer.json() == after
    assert after == before | given | {"tags": ["a", "b"]}


def test_what_is_left_out_stays(client: httpx.Client) -> None:
    run = submit(client)
    client.patch(f"/api/v1/runs/{run}", json={"notes": NOTES, "tags": ["a"]})
    client.patch(f"/api/v1/runs/{run}", json={"pinned": True})
    client.patch(f"/api/v1/runs/{run}", json={"tags": []})
    after = client.get(f"/api/v1/runs/{run}").json()
    assert (after["notes"], after["pinned"], after["tags"]) == (NOTES, True, [])


def test_a_finished_run_can_be_written_on_but_its_campaign_stays(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    before = client.get(f"/api/v1/runs/{run}").json()
    after = client.patch(f"/api/v1/runs/{run}", json={"name": "Another name"}).json()
    assert after == before | {"name": "Another name"}
    assert after["campaign_name"] != "Another name"


def test_the_audit_trail_keeps_who_wrote_what(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    client.patch(f"/api/v1/runs/{run}", json={"tags": ["a"], "notes": NOTES})
    client.patch(f"/api/v1/runs/{run}", json={"state": "done"})
    client.post(f"/api/v1/runs/{run}/cancel")
    with service.engine.connect() as reader:
        rows = reader.execute(sa.select(Audit).where(Audit.action.startswith("run.")).order_by(Audit.id)).all()
    assert {(r.user, r.subject) for r in rows} == {("local", run)}
    assert [r.action for r in rows] == ["run.submitted", "run.edited", "run.cancelled"]
    assert rows[0].detail["name"] == campaign()["name"]
    digest = hashlib.sha256(NOTES.encode()).hexdigest()
    assert rows[1].detail == {"tags": ["a"], "notes": {"characters": len(NOTES), "sha256": digest}}


@pytest.fixture(scope="module")
def waiting(guest: httpx.Client) -> str:
    """A run of the shared service, which no test changes."""
    return submit(guest)


@pytest.mark.by_day(4)
@pytest.mark.parametrize(
    "given",
    [
        {},
        {"name": ""},
        {"name": "x" * 121},
        {"name": None},
        {"tags": ["two words"]},
        {"tags": ["x"] * 21},
        {"notes": "x" * 20_001},
        {"pinned": "perhaps"},
        {"state": "done"},
        {"verdict": "cleared"},
    ],
)
def test_anything_else_is_refused(guest: httpx.Client, waiting: str, given: dict[str, Any]) -> None:
    before = guest.get(f"/api/v1/runs/{waiting}").json()
    problem(guest.patch(f"/api/v1/runs/{waiting}", json=given), 422)
    assert guest.get(f"/api/v1/runs/{waiting}").json() == before


def test_a_run_that_is_not_there_cannot_be_written_on(client: httpx.Client) -> None:
    problem(client.patch("/api/v1/runs/R-0099", json={"pinned": True}), 404)


def test_a_page_of_another_service_cannot_write(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    foreign = {"Origin": "https://evil.example"}
    problem(client.patch(f"/api/v1/runs/{run}", json={"pinned": True}, headers=foreign), 403)
    problem(client.post("/api/v1/runs/cancel", json={"runs": [run]}, headers=foreign), 403)
    with service.visitor() as stranger:
        problem(stranger.patch(f"/api/v1/runs/{run}", json={"pinned": True}), 401)
    assert client.get(f"/api/v1/runs/{run}").json()["pinned"] is False


def test_several_runs_are_cancelled_at_once(service: Service, client: httpx.Client) -> None:
    first, second, third = (submit(client, seed=seed) for seed in (1, 2, 3))
    finish(service)
    Work(service).nominal()
    answer = client.post("/api/v1/runs/cancel", json={"runs": [third, second, first, third]})
    assert answer.status_code == 200
    assert [(r["id"], r["state"]) for r in answer.json()] == [
        (third, "cancelled"),
        (second, "cancelling"),
        (first, "done"),
    ]
    client.post(f"/api/v1/runs/{second}/cancel")
    with service.engine.connect() as reader:
        noted = reader.scalars(sa.select(Audit.subject).where(Audit.action == "run.cancelled").order_by(Audit.id)).all()
    assert noted == [second, third], "what a request did not change is not noted"


def test_one_unknown_run_and_none_is_cancelled(client: httpx.Client) -> None:
    run = submit(client)
    problem(client.post("/api/v1/runs/cancel", json={"runs": [run, "R-0099"]}), 404)
    problem(client.post("/api/v1/runs/cancel", json={"runs": []}), 422)
    assert client.get(f"/api/v1/runs/{run}").json()["state"] == "queued"


def test_the_list_has_the_convergence_history_and_the_bound(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    work.nominal()
    work.search(0, 700)
    work.search(700, 300)
    (item,) = client.get("/api/v1/runs").json()["items"]
    assert item["id"] == run
    evaluations, costs = zip(*item["best_so_far"], strict=True)
    assert list(evaluations) == sorted(set(evaluations))
    assert list(costs) == sorted(set(costs), reverse=True)
    assert costs[-1] == float(f"{item['worst_cost']:.6g}")
    lower = search(0, 1)
    work.store.begin(1)
    work.store.append(1, 0, lower._replace(costs=np.full((1, 1), -1.0)))
    (after,) = client.get("/api/v1/runs").json()["items"]
    assert (after["worst_cost"], after["best_so_far"]) == (-1.0, item["best_so_far"]), (
        "the history is of searches alone"
    )
    assert item["upper_bound"] is None


def test_the_history_of_a_run_is_reported(service: Service, client: httpx.Client) -> None:
    run, other = submit(client), submit(client, seed=2)
    client.patch(f"/api/v1/runs/{other}", json={"pinned": True})
    client.patch(f"/api/v1/runs/{run}", json={"tags": ["a"]})
    client.post(f"/api/v1/runs/{run}/cancel")
    told = client.get(f"/api/v1/runs/{run}/history").json()
    assert [entry["action"] for entry in told] == ["run.cancelled", "run.edited", "run.submitted"]
    assert {(entry["user"], entry["via"]) for entry in told} == {("local", "link")}
    assert told[1]["detail"] == {"tags": ["a"]}
    assert [entry["at"] for entry in told] == sorted((entry["at"] for entry in told), reverse=True)
    problem(client.get("/api/v1/runs/R-0999/history"), 404)


@pytest.mark.by_day(1)
@BOTH
def test_notes_changed_by_another_user_are_not_overwritten(client: httpx.Client) -> None:
    run = submit(client)
    for _ in range(2):  # also when the answer was lost and the request is repeated
        assert client.patch(f"/api/v1/runs/{run}", json={"notes": "mine", "notes_before": ""}).status_code == 200
    late = problem(client.patch(f"/api/v1/runs/{run}", json={"notes": "theirs", "notes_before": ""}), 409)
    assert "read them again" in str(late["detail"])
    assert client.get(f"/api/v1/runs/{run}").json()["notes"] == "mine"
    again = client.patch(f"/api/v1/runs/{run}", json={"notes": "mine and theirs", "notes_before": "mine"})
    assert again.json()["notes"] == "mine and theirs"
    assert client.patch(f"/api/v1/runs/{run}", json={"notes": "regardless"}).json()["notes"] == "regardless"
