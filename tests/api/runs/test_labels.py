"""Labels of runs: at launch, in the list and its filters, on a sweep; earlier databases have none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
from alembic import command

from backend.db import users
from backend.db.access import create_token
from backend.db.engine import connect, default_url, migrate, migration_lock
from backend.db.migrate import config
from backend.db.purge import purge
from backend.db.queue import Queue
from backend.db.queue import submit as queued
from backend.db.tables import RunBaseline, RunLabel
from tests.given.case_campaigns import campaign as case
from tests.given.databases import BOTH
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign


def launched(client: httpx.Client, **fields: Any) -> httpx.Response:
    return client.post("/api/v1/runs", json={"campaign": campaign()} | fields)


def listed(client: httpx.Client, *labels: str) -> list[str]:
    answer = client.get("/api/v1/runs", params=[("label", label) for label in labels])
    assert answer.status_code == 200, answer.text
    return [run["id"] for run in answer.json()["items"]]


def test_labels_are_given_at_launch_and_filter_the_list(client: httpx.Client) -> None:
    for branch, build in (("main", "1"), ("main", "2"), ("slow", "3")):
        answer = launched(client, labels={"build": build, "branch": branch})
        assert answer.status_code == 201, answer.text
        assert list(answer.json()["labels"].items()) == [("branch", branch), ("build", build)]
    assert launched(client).json()["labels"] == {}
    assert client.get("/api/v1/runs/R-0003").json()["labels"] == {"branch": "slow", "build": "3"}
    assert client.get("/api/v1/runs").json()["items"][1]["labels"] == {"branch": "slow", "build": "3"}
    assert listed(client, "branch=main") == ["R-0002", "R-0001"]
    assert listed(client, "branch=main", "build=2") == ["R-0002"], "every key is required"
    assert listed(client, "branch=main", "branch=slow") == ["R-0003", "R-0002", "R-0001"], "alternatives of one key"
    assert listed(client, "branch=ma") == []
    facets = client.get("/api/v1/runs/facets").json()["labels"]
    assert facets[0] == {"value": "branch=main", "runs": 2}
    assert {facet["value"] for facet in facets} == {"branch=main", "branch=slow", "build=1", "build=2", "build=3"}
    (submitted,) = client.get("/api/v1/runs/R-0003/history").json()
    assert submitted["detail"]["labels"] == {"branch": "slow", "build": "3"}


@pytest.mark.parametrize(
    ("labels", "statement"),
    [
        ({"a b": "x"}, "invalid label key 'a b': a letter, then letters, digits"),
        ({"branch": ""}, "invalid value '' of the label branch"),
        ({f"k{i}": "v" for i in range(21)}, "at most 20 items"),
        ({"branch": 1}, "valid string"),
        (["branch=main"], "valid dictionary"),
        ({"branch": "a\u0000b"}, "null characters"),
    ],
)
def test_a_bad_label_is_refused_with_a_sentence(client: httpx.Client, labels: Any, statement: str) -> None:
    refused = problem(launched(client, labels=labels), 422)
    assert statement in refused["errors"][0]["message"]
    assert refused["errors"][0]["field"].startswith("labels")
    assert listed(client) == []


def test_a_bad_filter_is_refused_with_a_sentence(client: httpx.Client) -> None:
    answer = client.get("/api/v1/runs", params={"label": "branch"})
    assert problem(answer, 422)["detail"].startswith("invalid label 'branch': ")


def test_every_run_of_a_sweep_has_the_labels(client: httpx.Client) -> None:
    body = {"campaign": campaign(), "path": "avoider.d_0", "values": [1.0, 2.0], "labels": {"branch": "main"}}
    answer = client.post("/api/v1/sweeps", json=body)
    assert answer.status_code == 201, answer.text
    assert listed(client, "branch=main") == ["R-0002", "R-0001"]


def test_a_purged_run_has_no_labels(service: Service, client: httpx.Client) -> None:
    launched(client, labels={"branch": "main"}, baseline="label:branch=main")
    finish_fully(service)
    client.delete("/api/v1/runs/R-0001", params={"reason": "wrong"})
    assert listed(client, "branch=main") == []
    assert client.get("/api/v1/runs/facets").json()["labels"] == []
    assert purge(service.engine, 1, 0.0, "ada")
    rows = service.rows()
    assert (rows["run_labels"], rows["run_baselines"]) == (0, 0)


def test_an_earlier_database_gets_the_tables_and_keeps_its_runs(tmp_path: Path) -> None:
    engine = connect(default_url(tmp_path))
    with migration_lock(engine) as connection:
        command.upgrade(config(connection), "0015")
    with engine.connect() as connection:
        assert not {"run_labels", "run_baselines"} & set(sa.inspect(connection).get_table_names())
    migrate(default_url(tmp_path))
    with engine.begin() as connection:
        run_id = queued(connection, case(), name="a", tags=[], owner="", planned=1, labelled={"branch": "main"})
        connection.execute(sa.insert(RunBaseline).values(run_id=run_id, asked="R-0001", baseline=None))
        assert connection.execute(sa.select(RunLabel.key, RunLabel.value)).all() == [("branch", "main")]
    engine.dispose()


def grouped(client: httpx.Client, group: str, **fields: Any) -> dict[str, Any]:
    answer = launched(client, group=group, **fields)
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


@pytest.mark.by_day(1)
@BOTH
def test_a_newer_run_of_a_group_cancels_those_that_have_not_ended(service: Service, client: httpx.Client) -> None:
    assert grouped(client, "p/main")["superseded"] == []
    finish_fully(service)
    assert grouped(client, "p/main", labels={"branch": "main"})["superseded"] == [], "R-0001 has ended"
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    assert grouped(client, "p/other")["superseded"] == []
    assert launched(client).json()["group"] is None
    newest = grouped(client, "p/main", labels={"branch": "main"})
    assert newest["superseded"] == ["R-0002"], "running"
    run = client.get("/api/v1/runs/R-0002").json()
    assert (run["state"], run["group"], run["superseded_by"]) == ("cancelling", "p/main", "R-0005")
    Queue(service.engine).cancelled(claim)
    assert grouped(client, "p/main")["superseded"] == ["R-0005"], "queued; R-0002 stays superseded by R-0005"
    states = {run["id"]: (run["state"], run["superseded_by"]) for run in client.get("/api/v1/runs").json()["items"]}
    assert states == {
        "R-0001": ("done", None),
        "R-0002": ("cancelled", "R-0005"),
        "R-0003": ("queued", None),
        "R-0004": ("queued", None),
        "R-0005": ("cancelled", "R-0006"),
        "R-0006": ("queued", None),
    }
    cancelled, _ = client.get("/api/v1/runs/R-0005/history").json()
    noted = {"state": "cancelled", "group": "p/main", "superseded_by": "R-0006"}
    assert (cancelled["action"], cancelled["detail"]) == ("run.cancelled", noted)
    (submitted,) = client.get("/api/v1/runs/R-0006/history").json()
    assert submitted["detail"]["group"] == "p/main"


def test_a_group_is_no_label(service: Service, client: httpx.Client) -> None:
    grouped(client, "p/main", labels={"branch": "main"})
    assert client.get("/api/v1/runs/R-0001").json()["labels"] == {"branch": "main"}
    assert [facet["value"] for facet in client.get("/api/v1/runs/facets").json()["labels"]] == ["branch=main"]
    for label in ("@group=p/main", "@superseded=R-0001"):
        problem(client.get("/api/v1/runs", params={"label": label}), 422)
        problem(launched(client, labels={label.partition("=")[0]: "x"}), 422)
    problem(launched(client, baseline="label:@group=p/main"), 422)


def test_a_repeated_submission_supersedes_nothing_again(service: Service, client: httpx.Client) -> None:
    first = client.post("/api/v1/runs", json={"campaign": campaign(), "group": "g"}, headers={"Idempotency-Key": "1"})
    second = client.post("/api/v1/runs", json={"campaign": campaign(), "group": "g"}, headers={"Idempotency-Key": "2"})
    assert second.json()["superseded"] == ["R-0001"]
    again = client.post("/api/v1/runs", json={"campaign": campaign(), "group": "g"}, headers={"Idempotency-Key": "1"})
    assert (again.json()["id"], again.json()["superseded"]) == (first.json()["id"], [])
    assert client.get("/api/v1/runs/R-0002").json()["state"] == "queued"


def test_a_group_reaches_the_runs_of_others_only_from_an_administrator(service: Service) -> None:
    with service.engine.begin() as writer:
        for name in ("ada", "bob"):
            users.accept(writer, users.invite(writer, name, "engineer", "local"), "hash")
        tokens = {name: create_token(writer, f"ci-{name}", name, "run") for name in ("ada", "bob")}
    for name, superseded in (("ada", []), ("bob", []), ("ada", ["R-0001"])):
        with service.visitor(Authorization=f"Bearer {tokens[name]}") as visitor:
            assert grouped(visitor, "p/main")["superseded"] == superseded
    with service.signed_in() as administrator:
        assert grouped(administrator, "p/main")["superseded"] == ["R-0002", "R-0003"]


@pytest.mark.parametrize("group", ["", " ", "a\nb", "x" * 201])
def test_a_group_is_one_line(guest: httpx.Client, group: str) -> None:
    for answer in (
        launched(guest, group=group),
        guest.post("/api/v1/runs", params={"group": group}, json={"campaign": campaign()}),
    ):
        problem(answer, 422)


def test_a_reused_verdict_supersedes_what_has_not_ended(service: Service, client: httpx.Client) -> None:
    service.compare()
    launched(client)
    finish_fully(service)
    grouped(client, "g", campaign=campaign(seed=2))
    reused = grouped(client, "g", reuse=True)
    assert (reused["id"], reused["superseded"], reused["group"]) == ("R-0001", ["R-0002"], None)
    assert client.get("/api/v1/runs/R-0002").json()["superseded_by"] == "R-0001"
