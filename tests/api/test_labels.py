"""Labels of runs: at launch, in the list and its filters, on a sweep; earlier databases have none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
from alembic import command

from backend.db.engine import connect, default_url, migrate, migration_lock
from backend.db.migrate import config
from backend.db.purge import purge
from backend.db.queue import submit as queued
from backend.db.tables import RunBaseline, RunLabel
from tests.api.answers import problem
from tests.api.catalogue import campaign
from tests.api.reported import finish_fully
from tests.api.server import Service
from tests.unit.cases import campaign as case


def launched(client: httpx.Client, **fields: Any) -> httpx.Response:
    return client.post("/api/v1/runs", json={"campaign": campaign(), **fields})


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
    ("labels", "said"),
    [
        ({"a b": "x"}, "invalid label key 'a b': a letter, then letters, digits"),
        ({"branch": ""}, "invalid value '' of the label branch"),
        ({f"k{i}": "v" for i in range(21)}, "at most 20 items"),
        ({"branch": 1}, "valid string"),
        (["branch=main"], "valid dictionary"),
        ({"branch": "a\u0000b"}, "null characters"),
    ],
)
def test_a_bad_label_is_refused_with_a_sentence(client: httpx.Client, labels: Any, said: str) -> None:
    refused = problem(launched(client, labels=labels), 422)
    assert said in refused["errors"][0]["message"]
    assert refused["errors"][0]["field"].startswith("labels")
    assert listed(client) == []


def test_a_bad_filter_is_refused_with_a_sentence(client: httpx.Client) -> None:
    answer = client.get("/api/v1/runs", params={"label": "branch"})
    assert problem(answer, 422)["detail"].startswith("invalid label 'branch': give KEY=VALUE")


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
    migrate(default_url(tmp_path))
    engine = connect(default_url(tmp_path))
    with migration_lock(engine) as connection:
        command.downgrade(config(connection), "0015")
    with engine.connect() as connection:
        assert not {"run_labels", "run_baselines"} & set(sa.inspect(connection).get_table_names())
    migrate(default_url(tmp_path))
    with engine.begin() as connection:
        run_id = queued(connection, case(), name="a", tags=[], owner="", planned=1, given={"branch": "main"})
        connection.execute(sa.insert(RunBaseline).values(run_id=run_id, asked="R-0001", baseline=None))
        assert connection.execute(sa.select(RunLabel.key, RunLabel.value)).all() == [("branch", "main")]
    engine.dispose()
