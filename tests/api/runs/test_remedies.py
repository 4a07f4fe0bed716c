"""The remedies of an inconclusive verdict over the API, and that stored results of other versions do not prevent it."""

from __future__ import annotations

import json
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Stage
from campaigns import Campaign
from campaigns.results.remedies import Remedy, applied
from campaigns.results.verdict import Check
from tests import results
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

FAILING = [
    Check(code="validation", ok=False, statement=results.statement("the integrations disagree for F1")),
    Check(code="agreement", ok=False, statement=results.statement("only DIRECT reached the worst case")),
    Check(code="probability", ok=False, statement=results.statement("the bound of 9 % is above the required 5 %")),
    Check(code="motion", ok=False, statement=results.statement("the vehicle moves 0 m")),
]


def checks(client: httpx.Client, run: str) -> dict[str, list[dict[str, Any]]]:
    answer = client.get(f"/api/v1/runs/{run}")
    assert answer.status_code == 200, answer.text
    return {check["name"]: check["remedies"] for check in answer.json()["summary"]["checks"]}


def test_failing_checks_of_an_inconclusive_verdict_carry_changes_of_the_campaign(
    service: Service, client: httpx.Client
) -> None:
    run = submit(client)
    finish_fully(service, "inconclusive", further=FAILING)
    found = checks(client, run)
    (step,) = found["validation"]
    asked = Campaign.model_validate(campaign())
    half = asked.given_scenario.step / 2
    assert step["changes"] == [{"at": ["scenario", "step"], "value": half}]
    assert (step["kind"], step["text"]) == ("step", f"with step {1000 * half:g} ms")
    (more,) = found["probability"]
    assert (more["kind"], more["text"]) == ("sample", "with 3\u202f000 samples")
    assert found["agreement"] == [], "DIRECT ended by its own rule, and no other global method is installed"
    assert found["motion"] == found["nominal"] == found["x"] == []
    # What a page starts from it is a campaign that the service accepts.
    chosen = [Remedy.model_validate(remedy) for remedies in found.values() for remedy in remedies]
    changed = applied(asked, chosen)
    assert changed is not None
    assert client.post("/api/v1/runs", json={"campaign": changed.document()}).status_code == 201


@pytest.mark.parametrize("verdict", ["cleared", "violated"])
def test_another_verdict_offers_no_next_step(service: Service, client: httpx.Client, verdict: str) -> None:
    run = submit(client)
    finish_fully(service, verdict, further=FAILING)
    assert not any(checks(client, run).values())


def test_a_result_of_another_version_costs_the_remedies_and_nothing_else(
    service: Service, client: httpx.Client
) -> None:
    run = submit(client)
    finish_fully(service, "inconclusive", further=FAILING)
    with service.engine.begin() as writer:
        writer.execute(sa.update(Stage).where(Stage.kind == "search").values(result={"stage": "search", "later": 1}))
    assert client.get(f"/api/v1/runs/{run}/stages").status_code == 409
    assert not any(checks(client, run).values())
    assert json.loads(client.get(f"/api/v1/runs/{run}").text)["verdict"] == "inconclusive"
