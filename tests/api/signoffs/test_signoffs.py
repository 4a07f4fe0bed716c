"""Sign-offs: bound to the reviewed results, never edited, withdrawn with a reason, recorded in the audit trail."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Audit, Finding, Run, Stage, Trace
from tests import results
from tests.given.databases import AT_NIGHT
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.submissions import submit


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """The address of a finished run's sign-offs."""
    run = submit(client)
    finish_fully(service)
    return f"/api/v1/runs/{run}/signoffs"


@pytest.fixture(scope="module")
def unsigned(still: Service, guest: httpx.Client) -> str:
    """Results of the shared service that no test signs."""
    run = submit(guest)
    finish_fully(still)
    return f"/api/v1/runs/{run}/signoffs"


def given(client: httpx.Client, run: str, **changes: Any) -> dict[str, Any]:
    digest = client.get(run).json()["digest"]
    return {"name": "Grace Hopper", "role": "Independent review", "comment": "Read.", "digest": digest} | changes


@AT_NIGHT
def test_a_reviewer_signs_off_what_was_reviewed(service: Service, client: httpx.Client, run: str) -> None:
    before = client.get(run).json()
    assert (before["items"], before["can_sign"]) == ([], True)
    answer = client.post(run, json=given(client, run))
    assert answer.status_code == 201, answer.text
    signed = answer.json()
    assert signed["current"] is True
    assert signed["digest"] == before["digest"]
    assert (signed["name"], signed["role"], signed["comment"]) == ("Grace Hopper", "Independent review", "Read.")
    assert client.get(run).json()["items"] == [signed]
    text = client.get(run.replace("signoffs", "report.html")).text
    assert "Grace Hopper" in text
    assert "of these results" in text
    (row,) = audit(service)
    assert (row.action, row.subject, row.user) == ("signoff.created", "R-0001", signed["user"])
    assert row.detail["digest"] == before["digest"]


def audit(service: Service) -> list[Any]:
    with service.engine.connect() as connection:
        return list(
            connection.execute(sa.select(Audit.__table__).where(Audit.action.startswith("signoff.")).order_by(Audit.id))
        )


CHANGES: list[tuple[Any, dict[str, Any]]] = [
    (Run, {"verdict": "violated"}),
    (Run, {"summary": {"sentence": "Another one."}}),
    (Finding, {"cost": 1.2999999999999998}),
    (Stage, {"result": results.nominal(1.5).model_dump()}),
    (Trace, {"data": b"\0" * 301 * 10 * 8}),
]


@pytest.mark.nightly
@AT_NIGHT
def test_a_later_change_of_a_result_shows(service: Service, client: httpx.Client, run: str) -> None:
    """Each change by itself: the results that were signed are there again before the next one."""
    signed = client.post(run, json=given(client, run)).json()["digest"]
    for table, values in CHANGES:
        with changed(service.engine, sa.update(table).values(**values)):
            now = client.get(run).json()
            assert now["items"][0]["current"] is False, values
            assert now["digest"] != now["items"][0]["digest"] == signed
            assert 'data-current="false"' in client.get(run.replace("signoffs", "report.html")).text
        assert client.get(run).json()["items"][0]["current"] is True, values


@AT_NIGHT
def test_what_people_write_on_a_run_is_no_result(service: Service, client: httpx.Client, run: str) -> None:
    client.post(run, json=given(client, run))
    with service.engine.begin() as connection:
        connection.execute(sa.update(Run).values(name="Another name", tags=["b"], notes="Looks good."))
    assert client.get(run).json()["items"][0]["current"] is True


def test_other_results_than_those_reviewed_are_not_signed(client: httpx.Client, run: str) -> None:
    told = problem(client.post(run, json=given(client, run, digest="0" * 64)), 409)
    assert "review it again" in str(told["detail"])
    assert client.get(run).json()["items"] == []


@AT_NIGHT
def test_other_texts_than_those_reviewed_are_not_signed(service: Service, client: httpx.Client) -> None:
    address = "/api/v1/requirements"
    client.put(address, json={"id": "REQ-1", "text": "Keep 0.5 m."})
    name = submit(client, criterion={"threshold": 0.5, "requirements": ["REQ-1"]})
    finish_fully(service)
    run = f"/api/v1/runs/{name}/signoffs"
    read = client.get(run).json()["texts"]
    assert [*read] == ["REQ-1"]
    client.put(address, json={"id": "REQ-1", "text": "Keep 50 m."})
    told = problem(client.post(run, json=given(client, run, texts=read)), 409)
    assert " REQ-1 " in str(told["detail"])
    assert client.get(run).json()["items"] == []
    assert client.post(run, json=given(client, run, texts=client.get(run).json()["texts"])).status_code == 201


def test_a_typed_name_signs_once(client: httpx.Client, run: str) -> None:
    """Under whatever title, and in whatever case, spaces, punctuation and form of characters."""
    body = given(client, run)
    signed = client.post(run, json=body).json()
    assert (signed["name"], signed["typed"], signed["account"]) == ("Grace Hopper", True, "local")
    for name in ("Grace Hopper", "grace  HOPPER", "Ｇｒａｃｅ Hopper", "Grace-Hopper", "Grace Hopper."):
        for role in (body["role"], "Safety authority"):
            detail = str(problem(client.post(run, json=body | {"name": name, "role": role}), 409)["detail"])
            assert detail.startswith("Grace Hopper")
            assert "as Independent review" in detail
    assert client.post(run, json=body | {"name": "Ada Lovelace"}).status_code == 201
    assert "has no accounts" in str(problem(client.post(run, json=body | {"name": None}), 422)["detail"])


WRONG = "The bounds were wrong."


@AT_NIGHT
def test_a_sign_off_is_withdrawn_once_and_stays_on_record(service: Service, client: httpx.Client, run: str) -> None:
    signed = client.post(run, json=given(client, run)).json()
    address = f"{run}/{signed['id']}/withdraw"
    problem(client.post(address, json={"reason": ""}), 422)
    problem(client.post(address, json={}), 422)
    withdrawn = client.post(address, json={"reason": WRONG}).json()
    new = ("standing", "sentence", "withdrawn", "withdrawn_by", "withdrawn_reason")
    assert {k: v for k, v in withdrawn.items() if k not in new} == {k: v for k, v in signed.items() if k not in new}
    assert (signed["standing"], withdrawn["standing"]) == ("standing", "withdrawn")
    assert withdrawn["withdrawn_reason"] == WRONG
    assert withdrawn["withdrawn"] >= signed["created"]
    problem(client.post(address, json={"reason": "Again."}), 409)
    assert client.get(run).json()["items"] == [withdrawn]
    assert WRONG in client.get(run.replace("signoffs", "report.html")).text
    assert client.post(run, json=given(client, run)).status_code == 201
    assert [row.action for row in audit(service)] == ["signoff.created", "signoff.withdrawn", "signoff.created"]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("method", ["PUT", "PATCH", "DELETE"])
def test_nothing_edits_a_sign_off(client: httpx.Client, run: str, method: str) -> None:
    signed = client.post(run, json=given(client, run)).json()
    for address in (run, f"{run}/{signed['id']}"):
        assert client.request(method, address, json=given(client, run)).status_code in (404, 405)
    assert client.get(run).json()["items"] == [signed]


@pytest.mark.parametrize(
    "changes",
    [
        {"name": ""},
        {"name": " "},
        {"name": "two\nlines"},
        {"role": "x" * 121},
        {"comment": "\0"},
        {"comment": "x" * 4001},
        {"digest": "F" * 64},
        {"digest": None},
        {"created": 0},
    ],
)
def test_what_is_no_sign_off_is_refused(guest: httpx.Client, unsigned: str, changes: dict[str, Any]) -> None:
    problem(guest.post(unsigned, json=given(guest, unsigned, **changes)), 422)


def test_a_run_without_a_verdict_is_not_signed(client: httpx.Client) -> None:
    address = f"/api/v1/runs/{submit(client)}/signoffs"
    assert client.get(address).json()["can_sign"] is False
    assert "no verdict" in str(problem(client.post(address, json=given(client, address)), 409)["detail"])


def test_what_is_not_there_is_not_found(client: httpx.Client, run: str) -> None:
    problem(client.get("/api/v1/runs/R-0999/signoffs"), 404)
    problem(client.post("/api/v1/runs/R-0999/signoffs", json=given(client, run)), 404)
    problem(client.post(f"{run}/77/withdraw", json={"reason": "x"}), 404)


def test_hostile_words_of_a_reviewer_stay_words(client: httpx.Client, run: str) -> None:
    words = "<script>alert(1)</script>"
    assert client.post(run, json=given(client, run, name=words, role=words, comment=words)).status_code == 201
    text = client.get(run.replace("signoffs", "report.html")).text
    assert "<script" not in text
    assert text.count("&lt;script&gt;alert(1)&lt;/script&gt;") == 3


@AT_NIGHT
def test_a_file_made_before_a_sign_off_is_not_taken_for_the_one_after(client: httpx.Client, run: str) -> None:
    address = run.replace("signoffs", "exports/run.json")
    before = client.get(address)
    client.post(run, json=given(client, run))
    after = client.get(address, headers={"If-None-Match": before.headers["etag"]})
    assert after.status_code == 200
    assert after.json()["signoffs"][0]["name"] == "Grace Hopper"
    assert after.json()["results_digest"] == before.json()["results_digest"]
