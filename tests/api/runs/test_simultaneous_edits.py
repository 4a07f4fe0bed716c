"""Of two edits that are made at the same time, none is lost unseen; on PostgreSQL, which has several writers."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import AuditHead, Draft, Requirement, Run
from tests.faults.processes import until
from tests.given.databases import POSTGRESQL
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

DRAFT = {"name": "", "text": "name: x"}
EDITS: dict[str, tuple[str, str, list[dict[str, Any]]]] = {
    "a draft": ("/api/v1/drafts/D-0001", "PUT", [{**DRAFT, "version": 1}] * 2),
    "a user": ("/api/v1/users/ann", "PATCH", [{"role": "engineer"}, {"disabled": True}]),
    "settings": ("/api/v1/settings", "PATCH", [{"own_sign_offs": True}] * 2),  # the default is false: both change it
}


WAITING = "select count(*) from pg_stat_activity where wait_event_type = 'Lock' and datname = current_database()"


def _outside(service: Service) -> sa.Connection:
    """Within a transaction, PostgreSQL would show the same activity for ever."""
    return service.engine.connect().execution_options(isolation_level="AUTOCOMMIT")


@pytest.mark.by_day(1)
@POSTGRESQL
@pytest.mark.parametrize("name", EDITS)
def test_of_two_who_edit_at_the_same_time_one_is_refused(service: Service, client: httpx.Client, name: str) -> None:
    """Both wait for the audit trail or for each other, until the trail is released."""
    client.post("/api/v1/users", json={"name": "ann", "role": "viewer"})
    client.post("/api/v1/drafts", json=DRAFT)
    path, method, given = EDITS[name]
    read = client.get(path).headers["etag"]

    def edit(body: dict[str, Any]) -> int:
        return client.request(method, path, json=body, headers={"If-Match": read}).status_code

    with ThreadPoolExecutor(2) as two, _outside(service) as watching:
        with service.engine.begin() as holding:
            holding.execute(sa.select(AuditHead.row).with_for_update())
            holding.execute(sa.select(Draft.id).with_for_update())
            answers = two.map(edit, given)
            until(lambda: watching.scalar(sa.text(WAITING)) == 2, "both wait")
        assert sorted(answers) == [200, 412]


LAUNCHES: dict[str, tuple[int, dict[str, Any]]] = {
    "runs": (1, {"campaign": campaign()}),
    "sweeps": (2, {"campaign": campaign(), "path": "avoider.d_0", "values": [0.5, 0.6], "name": "Range"}),
}
"""How many runs each launches."""


@pytest.mark.by_day(1)
@POSTGRESQL
@pytest.mark.parametrize("two", [("runs", "runs"), ("runs", "sweeps"), ("sweeps", "sweeps")], ids=" and ".join)
def test_of_two_launches_at_the_same_time_one_is_beyond_the_quota(
    service: Service, client: httpx.Client, two: tuple[str, str]
) -> None:
    """Each alone is within it. Both wait for the audit trail or for each other, until the trail is released."""
    most = sum(LAUNCHES[what][0] for what in two) - 1
    service.app.state.quota = replace(service.app.state.quota, active=most)

    def launch(what: str) -> int:
        return client.post(f"/api/v1/{what}", json=LAUNCHES[what][1]).status_code

    with ThreadPoolExecutor(2) as pool, _outside(service) as watching:
        with service.engine.begin() as holding:
            holding.execute(sa.select(AuditHead.row).with_for_update())
            answers = pool.map(launch, two)
            until(lambda: watching.scalar(sa.text(WAITING)) == 2, "both wait")
        assert sorted(answers) == [201, 409]


REQUIREMENTS = "/api/v1/requirements"


def _while_held(service: Service, holding: sa.Executable, request: Callable[[], httpx.Response]) -> httpx.Response:
    """The answer to a request that waits for another transaction, which then commits."""
    with ThreadPoolExecutor(1) as one, _outside(service) as watching:
        with service.engine.begin() as writer:
            writer.execute(holding)
            answer = one.submit(request)
            until(lambda: watching.scalar(sa.text(WAITING)) == 1, "it waits")
        return answer.result()


@POSTGRESQL
def test_a_requirement_that_is_added_twice_at_the_same_time_is_refused_once(
    service: Service, client: httpx.Client
) -> None:
    row = {"id": "X", "text": "one", "attributes": {}, "created": 1.0, "changed": 1.0, "changed_by": "ada"}
    body = {"id": "X", "text": "two"}
    answer = _while_held(service, sa.insert(Requirement).values(**row), lambda: client.put(REQUIREMENTS, json=body))
    assert (answer.status_code, answer.json()["type"].rpartition(":")[2]) == (409, "requirement-conflict")


@POSTGRESQL
def test_cancelling_several_waits_for_an_edit_of_one_and_not_the_other_way_round(
    service: Service, client: httpx.Client
) -> None:
    """The edit holds a run, and then takes the audit trail, which the request must not hold yet."""
    runs = [submit(client), submit(client)]
    with ThreadPoolExecutor(1) as one, _outside(service) as watching:
        with service.engine.begin() as edit:
            edit.execute(sa.update(Run).where(Run.id == 2).values(name="edited"))
            answer = one.submit(lambda: client.post("/api/v1/runs/cancel", json={"runs": runs}))
            until(lambda: watching.scalar(sa.text(WAITING)) == 1, "it waits")
            edit.execute(sa.select(AuditHead.row).with_for_update())
        assert [run["state"] for run in answer.result().json()] == ["cancelled", "cancelled"]


@pytest.mark.nightly
@POSTGRESQL
def test_an_import_sees_the_edit_that_it_waited_for(service: Service, client: httpx.Client) -> None:
    def imported() -> httpx.Response:
        return client.post(
            f"{REQUIREMENTS}/files", params={"name": "a.csv", "kind": "csv"}, content=b"id,text\nR,Hold.\n"
        )

    imported()
    edit = sa.update(Requirement).where(Requirement.id == "R").values(text="Hold 50 m.", changed_by="ada")
    answer = _while_held(service, edit, imported).json()
    assert (answer["changed"], answer["unchanged"]) == (["R"], 0)


@POSTGRESQL
def test_settings_that_are_changed_at_the_same_time_are_both_stored(service: Service, client: httpx.Client) -> None:
    with ThreadPoolExecutor(4) as four:
        stored = four.map(
            lambda on: client.patch("/api/v1/settings", json={"own_sign_offs": on}).status_code, [True, False] * 8
        )
        assert set(stored) == {200}
