"""Runs are removed with a reason and restored; purged ones leave their name, digest and history, and a 410."""

from __future__ import annotations

import threading
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.purge import due, purge
from backend.db.queue import Queue
from backend.db.tables import Run, RunText
from clearance.cli import invoke
from tests.given.databases import AT_NIGHT, BOTH, POSTGRESQL
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

WHY = {"reason": "The bounds were those of another vehicle."}


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """The address of a finished run, R-0001."""
    run = submit(client, tags=["mine"])
    finish_fully(service)
    return f"/api/v1/runs/{run}"


def listed(client: httpx.Client, **query: Any) -> list[str]:
    page = client.get("/api/v1/runs", params=query).json()
    found = [item["id"] for item in page["items"]]
    assert page["counts"]["total"] == len(found)
    return found


def history(client: httpx.Client, run: str) -> list[tuple[str, str]]:
    return [(entry["action"], entry["via"]) for entry in client.get(f"{run}/history").json()]


def sign(client: httpx.Client, run: str) -> httpx.Response:
    digest = client.get(f"{run}/signoffs").json()["digest"]
    return client.post(f"{run}/signoffs", json={"name": "Ada", "role": "Review", "digest": digest})


@AT_NIGHT
def test_a_removed_run_is_in_no_list_and_keeps_its_address(client: httpx.Client, run: str) -> None:
    submit(client, seed=2)
    before = client.get(run).json()
    removed = client.delete(run, params=WHY).json()
    assert (removed["removed_by"], removed["removed_reason"]) == ("local", WHY["reason"])
    assert listed(client) == ["R-0002"]
    assert listed(client, q="R-0001") == client.get("/api/v1/runs?verdict=cleared").json()["items"] == []
    assert "mine" not in [tag["value"] for tag in client.get("/api/v1/runs/facets").json()["tags"]]
    assert listed(client, removed=True) == listed(client, removed=True, q="pillar", verdict="cleared") == ["R-0001"]
    told = client.get(run).json()
    assert told == before | {key: removed[key] for key in ("removed", "removed_by", "removed_reason")}
    assert client.get(f"{run}/findings").json()
    report = client.get(f"{run}/report.html").text
    assert 'aria-label="Removed"' in report
    assert WHY["reason"] in report
    assert client.delete(run, params={"reason": "Again."}).json()["removed_reason"] == WHY["reason"]
    assert history(client, run)[0] == ("run.removed", "link")
    restored = client.post(f"{run}/restore").json()
    assert (restored["removed"], restored["removed_by"], restored["removed_reason"]) == (None, None, None)
    assert client.get(run).json() == before
    assert listed(client) == ["R-0002", "R-0001"]
    client.post(f"{run}/restore")
    actions = [action for action, _ in history(client, run)]
    assert actions == ["run.restored", "run.removed", "run.submitted"]


def test_nothing_is_written_on_a_removed_run(client: httpx.Client, run: str) -> None:
    client.delete(run, params=WHY)
    for answer in (client.patch(run, json={"name": "x"}), sign(client, run)):
        problem(answer, 409, "removed")
    assert client.post(f"{run}/cancel").json()["state"] == "done"


@AT_NIGHT
def test_a_running_run_and_a_signed_one_are_not_removed(service: Service, client: httpx.Client, run: str) -> None:
    signed = sign(client, run).json()
    waiting = submit(client, seed=2)
    told = problem(client.delete(run, params=WHY), 409, "not-removable")
    assert " signed off by Ada" in str(told["detail"])
    assert Queue(service.engine).claim("w1") is not None
    told = problem(client.post("/api/v1/runs/remove", json={"runs": ["R-0001", waiting], **WHY}), 409, "not-removable")
    assert " running" in str(told["detail"])
    assert "None was removed" in str(told["detail"])
    assert [error["given"] for error in told["errors"]] == ["R-0001", "R-0002"]  # type: ignore[attr-defined]
    assert listed(client) == ["R-0002", "R-0001"]
    client.post(f"{run}/signoffs/{signed['id']}/withdraw", json={"reason": "Too early."})
    assert client.delete(run, params=WHY).status_code == 200


@pytest.mark.by_day(1)
@BOTH
def test_several_are_removed_and_restored_together_or_none(client: httpx.Client, run: str) -> None:
    submit(client, seed=2)
    client.post("/api/v1/runs/R-0002/cancel")
    both = {"runs": ["R-0002", "R-0001", "R-0002"]}
    problem(client.post("/api/v1/runs/remove", json={"runs": ["R-0001", "R-0099"], **WHY}), 404)
    assert len(listed(client)) == 2
    answer = client.post("/api/v1/runs/remove", json=both | WHY)
    assert [item["id"] for item in answer.json()] == ["R-0002", "R-0001"]
    assert listed(client) == []
    assert [item["removed"] for item in client.post("/api/v1/runs/restore", json=both).json()] == [None, None]
    assert len(listed(client)) == 2


def test_a_reason_is_needed(client: httpx.Client, run: str) -> None:
    for reason in (None, "", "  \n", "x" * 401, "a\0b"):
        problem(client.delete(run, params={} if reason is None else {"reason": reason}), 422)
        problem(client.post("/api/v1/runs/remove", json={"runs": ["R-0001"], "reason": reason}), 422)
        assert listed(client) == ["R-0001"], reason


def test_what_is_not_there_is_not_found(client: httpx.Client, run: str) -> None:
    problem(client.delete("/api/v1/runs/R-0009", params=WHY), 404)
    problem(client.delete("/api/v1/runs/1", params=WHY), 404)
    problem(client.post("/api/v1/runs/R-0009/restore"), 404)


READ = (
    "", "/campaign.yaml", "/stages", "/findings", "/traces", "/traces/F1", "/evaluations", "/components", "/signoffs",
    "/report.html", "/exports", "/exports/run.json", "/exports/evaluations.csv", "/exports/traces.mat",
    "/exports/flight-F1.html", "/exports/worst-case.svg",
)  # fmt: skip


@AT_NIGHT
def test_a_purged_run_leaves_a_tombstone(service: Service, client: httpx.Client, run: str) -> None:
    submit(client, seed=2)
    digest = client.get(f"{run}/signoffs").json()["digest"]
    signed = sign(client, run).json()
    client.post(f"{run}/signoffs/{signed['id']}/withdraw", json={"reason": "Too early."})
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 2).values(continues=1))
        writer.execute(sa.insert(RunText).values(run_id=1, text="# Ours."))
    client.delete(run, params=WHY)
    assert due(service.engine, 60.0) == []
    (found,) = due(service.engine, 0.0)
    assert (found.id, found.evaluations) == (1, 1000)
    assert found.size > 1000 * 4 * 8
    assert purge(service.engine, 1, 0.0, "root")
    assert not purge(service.engine, 1, 0.0, "root")
    rows = service.rows()
    assert {rows[name] for name in ("evaluation_chunks", "stages", "findings", "traces", "run_texts")} == {0}
    assert (rows["runs"], rows["signoffs"], rows["campaigns"]) == (2, 1, 2)
    for path in (*(run + path for path in READ), "/api/v1/events?run=R-0001"):
        told = problem(client.get(path), 410, "purged")
        assert str(told["detail"]).startswith(f"R-0001 “{campaign()['name']}” ")
        assert digest in str(told["detail"])
        assert f"({WHY['reason'].rstrip('.')})" in str(told["detail"])
    for answer in (
        client.delete(run, params=WHY),
        client.post(f"{run}/restore"),
        client.post(f"{run}/cancel"),
        client.patch(run, json={"name": "x"}),
        client.post(f"{run}/signoffs", json={"name": "A", "role": "B", "digest": digest}),
        client.get("/view/R-0001/F1/recorded/"),
    ):
        problem(answer, 410)
    assert listed(client) == ["R-0002"]
    assert listed(client, removed=True) == []
    assert client.get("/api/v1/runs/R-0002").json()["continues"] == "R-0001"
    assert history(client, run)[:2] == [("run.purged", "cli"), ("run.removed", "link")]
    assert client.get(f"{run}/history").json()[0]["detail"] == {"evaluations": 1000, "results_digest": digest}
    assert submit(client, seed=3) == "R-0003"


def test_a_run_that_was_restored_or_signed_is_not_purged(service: Service, client: httpx.Client, run: str) -> None:
    assert not purge(service.engine, 1, 0.0, "root")
    sign(client, run)
    with service.engine.begin() as writer:  # not possible through the API
        writer.execute(sa.update(Run).values(removed=1.0, removed_by="x", removed_reason="y"))
    assert due(service.engine, 0.0) == []
    assert not purge(service.engine, 1, 0.0, "root")
    assert client.get(f"{run}/findings").json()


def test_a_purge_that_breaks_off_has_done_nothing(
    service: Service, client: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    client.delete(run, params=WHY)
    before, told = service.rows(), client.get(run).json()

    def torn(*_: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr("backend.db.purge.audit.note_command", torn)
    with pytest.raises(OSError, match="disk"):
        purge(service.engine, 1, 0.0, "root")
    assert (service.rows(), client.get(run).json()) == (before, told)


def test_a_repeated_submission_reports_the_state_of_its_run(service: Service, client: httpx.Client) -> None:
    def post() -> httpx.Response:
        return client.post("/api/v1/runs", json={"campaign": campaign()}, headers={"Idempotency-Key": "k"})

    assert post().status_code == 201
    client.post("/api/v1/runs/R-0001/cancel")
    client.delete("/api/v1/runs/R-0001", params=WHY)
    assert post().json()["removed_reason"] == WHY["reason"]
    assert purge(service.engine, 1, 0.0, "root")
    problem(post(), 410)
    assert service.rows()["runs"] == 1


@POSTGRESQL
def test_who_signs_while_the_run_is_being_removed_comes_too_late(
    service: Service, client: httpx.Client, run: str
) -> None:
    """SQLite has one writer at a time; here the row is what the two wait for."""
    answers: list[httpx.Response] = []
    thread = threading.Thread(target=lambda: answers.append(sign(client, run)), daemon=True)
    waiting = sa.text("select count(*) from pg_locks where not granted")
    with service.engine.begin() as writer:
        writer.execute(sa.select(Run.id).where(Run.id == 1).with_for_update())
        thread.start()
        with service.engine.execution_options(isolation_level="AUTOCOMMIT").connect() as beside:
            until(lambda: beside.scalar(waiting))
        writer.execute(sa.update(Run).values(removed=1.0, removed_by="ada", removed_reason="a trial"))
    thread.join(20)
    assert [answer.status_code for answer in answers] == [409]
    assert "is removed" in answers[0].text


@POSTGRESQL
def test_the_command_purges(
    service: Service, client: httpx.Client, run: str, capsys: pytest.CaptureFixture[str]
) -> None:
    client.delete(run, params=WHY)
    assert invoke(["purge", "--older-than", "0d", "--yes", "--database", service.settings.database]) == 0
    statement = capsys.readouterr().out
    assert "1 run purged." in statement
    assert "autovacuum" in statement
    assert client.get(run).status_code == 410
    assert service.rows()["evaluation_chunks"] == 0
