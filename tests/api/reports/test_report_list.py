"""The list of reports: of every run that has ended, with its sign-offs and the digest printed on the report."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.digest import digest_before_0033, results_digest
from backend.db.engine import read
from backend.db.tables import Run, Stage
from backend.reports import pdf
from backend.reports.numbers import printed
from tests.given.databases import KINDS
from tests.given.finished_runs import Work, finish
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit


def listed(client: httpx.Client, **query: Any) -> dict[str, Any]:
    answer = client.get("/api/v1/reports", params=query)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def sign(client: httpx.Client, run: str, name: str) -> int:
    digest = client.get(f"/api/v1/runs/{run}/signoffs").json()["digest"]
    answer = client.post(f"/api/v1/runs/{run}/signoffs", json={"name": name, "role": "Reviewer", "digest": digest})
    assert answer.status_code == 201
    return int(answer.json()["id"])


def stood(report: dict[str, Any]) -> list[tuple[str, str]]:
    return [(one["name"], one["standing"]) for one in report["signoffs"]]


def test_reports_of_ended_runs(service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("Alpha", "Beta", "Gamma", "Delta")  # with bounds of their own: another's violation would speak against one
    bounds = [{"vehicle.m": {"plus_minus": f"{20 + at}%"}} for at in range(len(names))]
    runs = [submit(client, name=name, uncertain=own) for name, own in zip(names, bounds, strict=True)]
    finish_fully(service, "cleared")
    finish(service)
    client.post(f"/api/v1/runs/{runs[2]}/cancel")
    sign(client, runs[0], "Ada")
    gone = sign(client, runs[0], "Bob")
    client.post(f"/api/v1/runs/{runs[0]}/signoffs/{gone}/withdraw", json={"reason": "on second thoughts"})
    found = listed(client)
    assert [item["run"] for item in found["items"]] == runs[2::-1]
    assert (found["total"], found["next_cursor"]) == (3, None)
    client.patch(f"/api/v1/runs/{runs[0]}", json={"pinned": True})
    assert [item["run"] for item in listed(client)["items"]] == runs[2::-1], "the newest first, pinned or not"
    newest = listed(client, limit=2)
    older = listed(client, limit=2, cursor=newest["next_cursor"])
    assert [item["run"] for item in (*newest["items"], *older["items"])] == runs[2::-1]
    first = found["items"][2]
    assert (first["verdict"], stood(first)) == ("cleared", [("Ada", "standing")])
    assert first["digest"] == client.get(f"/api/v1/runs/{runs[0]}/signoffs").json()["digest"]
    html, printed = first["files"]
    assert first["id"] in client.get(html["href"]).text
    assert (html["unavailable"], printed["href"]) == (None, f"/api/v1/runs/{runs[0]}/report.pdf")
    assert (found["items"][0]["state"], found["items"][0]["verdict"]) == ("cancelled", None)
    monkeypatch.setattr(pdf, "browser", lambda: None)
    assert "install it" in listed(client)["items"][0]["files"][1]["unavailable"]


def test_a_sign_off_of_other_results_is_outdated(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish_fully(service)
    sign(client, run, "Ada")
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).values(worst_cost=99.0))
    (item,) = listed(client)["items"]
    assert stood(item) == [("Ada", "of other results")]


def test_reports_are_listed_in_pages_and_searched(client: httpx.Client) -> None:
    for i in range(5):
        client.post(f"/api/v1/runs/{submit(client, name='Loop odd' if i % 2 else 'Loop even', seed=i)}/cancel")
    first = listed(client, limit=2)
    second = listed(client, limit=2, cursor=first["next_cursor"])
    third = listed(client, limit=2, cursor=second["next_cursor"])
    assert [item["run"] for page in (first, second, third) for item in page["items"]] == [
        f"R-000{i}" for i in range(5, 0, -1)
    ]
    assert third["next_cursor"] is None
    found = listed(client, q="loop odd")
    assert ([item["run"] for item in found["items"]], found["total"]) == (["R-0004", "R-0002"], 2)
    assert listed(client, q="no such thing")["items"] == []
    problem(client.get("/api/v1/reports", params={"cursor": "x"}), 422)


def test_a_report_is_found_by_its_number(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish_fully(service)
    (item,) = listed(client)["items"]
    for words in (item["id"], f"{item['id'].lower()} {item['name']}"):
        found = listed(client, q=words)
        assert ([one["run"] for one in found["items"]], found["note"]) == ([run], "")
    found = listed(client, q="CLR-R-0999-01234567")
    assert (found["items"], found["note"]) == ([], "")
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).values(worst_cost=99.0))
    found = listed(client, q=item["id"])
    (now,) = found["items"]
    assert now["id"] != item["id"]
    assert {item["id"], now["id"]} <= set(found["note"].replace(".", "").split())


@pytest.mark.parametrize("database", KINDS, indirect=True)
def test_a_report_is_found_by_its_number_of_before_the_lowest_value_of_every_stage(
    service: Service, client: httpx.Client
) -> None:
    """As revision 0033 changes a run without a verdict; the results are those of the report."""
    run = submit(client)
    Work(service)
    client.post(f"/api/v1/runs/{run}/cancel")
    with service.engine.begin() as writer:
        for kind, cost in {"search": 0.8, "nominal": 0.7}.items():
            writer.execute(sa.update(Stage).where(Stage.kind == kind).values(best=cost))
        writer.execute(sa.update(Run).values(worst_cost=0.8, state="cancelled"))
        before = results_digest(writer, 1)
        writer.execute(sa.update(Run).values(worst_cost=0.7))
    with read(service.engine) as reader:
        assert digest_before_0033(reader, 1) == before
    found = listed(client, q=printed(run, before))
    assert [one["run"] for one in found["items"]] == [run]
    changed = listed(client, q=printed(run, "0" * 64))
    assert changed["items"] == found["items"]
    assert len({found["note"], changed["note"], ""}) == 3, "each says what it is"
