"""A policy that fails is stated wherever the run and its verdict are: in lists, trends, requirements, webhooks."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Run
from backend.webhooks.body import ended
from campaigns.results.regression import Regression, policy_word
from clearance.cli._following import ended_as
from clearance.client.answers import Run as Answer
from tests.faults.processes import REPOSITORY
from tests.given.at_night import rows_nightly_but
from tests.given.databases import KINDS
from tests.given.requirement_rows import AT, ran, row, sign
from tests.given.service import Service

API = REPOSITORY / "frontend" / "openapi.json"
SENTENCE, LEAF = "By the policy of the campaign on changes since its baseline, R-0001 fails", "since the baseline fails"
FAILING, HOLDING = {"ok": False, "accepted": False}, {"ok": True, "accepted": False}
SINCE: dict[str, list[tuple[dict[str, bool] | None, str | None]]] = {
    "cleared": [(None, None), (FAILING, "fails"), (HOLDING, "holds")],
    "violated": [(FAILING, "fails"), ({"ok": True, "accepted": True}, "accepts")],
    "inconclusive": [({"ok": True, "accepted": True}, "holds")],
}
"""By verdict: what the policy decided, and its word."""
ROWS = [(kind, verdict) for kind in KINDS for verdict in SINCE]
BY_DAY = [row for row in ROWS if row[0] == "sqlite" or row[1] == "violated"]


def compared(service: Service, since: dict[str, bool] | None) -> None:
    with service.engine.begin() as writer:
        summary = dict(writer.scalar(sa.select(Run.summary)) or {})
        regression = Regression(run="R-0009", position=1, cases=[], fail_on=[], statement=(), ok=True)
        if since is not None:
            summary["regression"] = regression.model_copy(update=since).model_dump(mode="json")
        writer.execute(sa.update(Run).values(summary=summary))


def stated(service: Service, client: httpx.Client) -> dict[str, Any]:
    """What each place states of the run."""
    with service.engine.connect() as reader:
        message = json.loads(ended(reader, 1, ""))["data"]
    (line,) = csv.DictReader(io.StringIO(client.get(f"{AT}/export/matrix.csv").text))
    (listed,) = client.get("/api/v1/runs").json()["items"]
    return {
        "list": listed["policy"],
        "run": client.get("/api/v1/runs/R-0001").json()["policy"],
        "trend": client.get("/api/v1/trends", params={"name": listed["campaign_name"]}).json()["runs"][0]["policy"],
        "report": client.get("/api/v1/reports").json()["items"][0]["policy"],
        "requirement": row(client, "REQ-1")["runs"][0]["policy"],
        "matrix": line["policy"] or None,
        "webhook": message["policy"],
    }


@pytest.mark.parametrize(("database", "verdict"), rows_nightly_but(BY_DAY, ROWS), indirect=["database"])
def test_every_place_states_what_the_policy_says(service: Service, client: httpx.Client, verdict: str) -> None:
    ran(service, client, "REQ-1", verdict=verdict)
    for since, word in SINCE[verdict]:
        compared(service, since)
        found = stated(service, client)
        assert found == dict.fromkeys(found, word)
        sentence = row(client, "REQ-1")["sentence"]
        exports = [client.get(f"{AT}/export/{name}").text for name in ("requirements.csv", "requirements.reqif")]
        argument = " ".join(client.get(f"{AT}/export/argument.gsn.yaml").text.split())
        assert {SENTENCE in text for text in (sentence, *exports, argument)} == {word == "fails"}
        assert (LEAF in argument) == (word == "fails")
        listed = Answer.model_validate(client.get("/api/v1/runs").json()["items"][0])
        assert ended_as(listed).endswith(", policy fails") == (word == "fails")
        report = client.get("/api/v1/runs/R-0001/report.html").text
        assert (f"</svg>{verdict.capitalize()}, policy fails<" in report) == (word == "fails")


def test_the_verdict_alone_decides_whether_a_requirement_is_met(service: Service, client: httpx.Client) -> None:
    run = ran(service, client, "REQ-1")
    compared(service, FAILING)
    sign(client, run)
    ran(service, client, "REQ-1", name="Another")
    found = row(client, "REQ-1")
    assert found["status"] == "unsigned"
    assert SENTENCE in found["sentence"], "also of a campaign whose evidence is no worse"


def test_what_states_a_verdict_and_what_it_lacks_states_the_policy() -> None:
    schemas = json.loads(API.read_text(encoding="utf-8"))["components"]["schemas"]
    shown = {name: set(schema.get("properties", ())) for name, schema in schemas.items()}
    both = {name for name, fields in shown.items() if {"verdict", "not_sampled"} <= fields}
    assert len(both) > 4
    assert {name for name in both if "policy" not in shown[name]} == {"RunVerdict"}, "that has the whole comparison"


def test_words() -> None:
    for verdict, decided in SINCE.items():
        for since, word in decided:
            known = since or {}
            assert policy_word(known.get("ok"), known.get("accepted"), verdict) == word
