"""The runs of a campaign in time."""

from __future__ import annotations

import json
from typing import Any

import httpx
import sqlalchemy as sa

from backend.db.tables import Run
from backend.webhooks.body import ended
from campaigns import Campaign
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit, swept

DIGEST = Campaign.model_validate(campaign()).digest
NAME = "Unicycle past a pillar"


def trend(client: httpx.Client, **query: Any) -> dict[str, Any]:
    answer = client.get("/api/v1/trends", params=query)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def test_changes_of_code_and_campaign_are_marked(service: Service, client: httpx.Client) -> None:
    codes = ["a", None, "a", "b", None, "b", "a"]
    for i, code in enumerate(codes):
        submit(client, seed=2 if i == 3 else 1)
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).where(Run.id == i + 1).values(flown=None if code is None else {"code": code}))
    submit(client, name="Another")
    found = trend(client, name=NAME)
    assert [run["id"] for run in found["runs"]] == [f"R-000{i}" for i in range(1, 8)]
    assert [run["code_changed"] for run in found["runs"]] == [False, False, False, True, False, False, True]
    assert [run["campaign_changed"] for run in found["runs"]] == [False, False, False, True, True, False, False]
    assert (found["name"], found["digest"], found["campaigns"], found["total"]) == (NAME, None, 2, 7)
    alone = trend(client, campaign=DIGEST)
    assert [run["id"] for run in alone["runs"]] == [f"R-000{i}" for i in (1, 2, 3, 5, 6, 7)]
    assert (alone["name"], alone["digest"], alone["campaigns"], alone["total"]) == (NAME, DIGEST, 1, 6)
    newest = trend(client, campaign=DIGEST, limit=2)
    assert ([run["id"] for run in newest["runs"]], newest["total"]) == (["R-0006", "R-0007"], 6)


def test_outcomes_and_removed_runs(service: Service, client: httpx.Client) -> None:
    for verdict in ("cleared", "violated"):
        submit(client)
        finish_fully(service, verdict)
    queued = submit(client)
    client.delete("/api/v1/runs/R-0001", params={"reason": "wrong"})
    found = trend(client, campaign=DIGEST)
    assert [(run["id"], run["verdict"], run["worst_cost"]) for run in found["runs"]] == [
        ("R-0002", "violated", 1.3),
        (queued, None, None),
    ]
    listed = client.get("/api/v1/runs").json()["items"]
    same = ("id", "quantity", "unit", "threshold")
    assert [[run[key] for key in same] for run in found["runs"]] == [[run[key] for key in same] for run in listed[::-1]]
    with service.engine.connect() as reader:
        body = json.loads(ended(reader, 3, ""))["data"]
    assert (body["verdict"], body["quantity"], body["unit"]) == (None, "d_min", "m"), "without a verdict as well"


def test_a_trend_by_name_leaves_out_the_variants_of_sweeps(client: httpx.Client) -> None:
    submit(client)
    sweep = swept(client, [1.5, 2.5])
    found = trend(client, name=NAME)
    assert [run["id"] for run in found["runs"]] == ["R-0001"]
    assert (found["total"], found["campaigns"], found["sweeps"]) == (1, 1, 2)
    variant = sweep["points"][0]["outcome"]["campaign_digest"]
    alone = trend(client, campaign=variant)
    assert ([run["id"] for run in alone["runs"]], alone["sweeps"]) == (["R-0002"], 0)


def test_runs_with_a_label_are_a_trend_of_their_own(service: Service, client: httpx.Client) -> None:
    """Changes of the code are those between its runs."""
    for number, (branch, code) in enumerate((("main", "a"), ("other", "b"), ("main", "a"), ("main", "c")), 1):
        labels = {"branch": branch, "commit": str(number)}
        sent = client.post("/api/v1/runs", json={"campaign": campaign(seed=number), "labels": labels})
        assert sent.status_code == 201, sent.text
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).where(Run.id == number).values(flown={"code": code}))
    submit(client, seed=9)
    found = trend(client, name=NAME, label="branch=main")
    assert [(run["id"], run["code_changed"]) for run in found["runs"]] == [
        ("R-0001", False), ("R-0003", False), ("R-0004", True),
    ]  # fmt: skip
    assert (found["total"], found["campaigns"]) == (3, 3)
    assert found["runs"][0]["labels"] == {"branch": "main", "commit": "1"}
    assert found["labels"][0] == {"value": "branch=main", "runs": 3}
    assert {one["value"] for one in found["labels"]} >= {"branch=other", "commit=2"}, "those by which others are found"
    both = trend(client, name=NAME, label=["branch=main", "branch=other", "commit=2"])
    assert [run["id"] for run in both["runs"]] == ["R-0002"]
    assert trend(client, name=NAME)["total"] == 5
    assert "KEY=VALUE" in str(problem(client.get("/api/v1/trends", params={"name": NAME, "label": "main"}), 422))


def test_an_invalid_request_is_refused(client: httpx.Client) -> None:
    problem(client.get("/api/v1/trends"), 422)
    problem(client.get("/api/v1/trends", params={"campaign": DIGEST, "name": NAME}), 422)
    problem(client.get("/api/v1/trends", params={"campaign": DIGEST}), 404)
    assert trend(client, name="no such name")["runs"] == []
