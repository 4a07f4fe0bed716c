"""What a run takes is estimated by the service: as in an earlier run of the campaign, or as such runs usually are."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from backend.catalog.estimate import FEW, UNKNOWN, USUAL, bounded
from campaigns.asked.allowance import validation
from campaigns.asked.load import load_document
from campaigns.asked.proposal import Cost
from campaigns.checked.expected import expected, total
from campaigns.stages.plan import most
from tests.given.finished_runs import finish
from tests.given.openapi_document import conforms
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE, campaign
from tests.given.submissions import submit
from tests.given.timed_simulators import measured, publish, run
from tests.simulators import noisy, package


def estimate(client: httpx.Client, document: dict[str, Any]) -> dict[str, Any]:
    checked = client.post("/api/v1/campaigns/check", json={"campaign": document}).json()
    assert checked["problems"] == []
    conforms(checked["estimate"], {"$ref": "#/components/schemas/Estimate"})
    return dict(checked["estimate"])


def test_of_a_new_campaign_every_stage_is_estimated(service: Service, client: httpx.Client) -> None:
    told = estimate(client, campaign())
    found = expected(load_document(campaign()), CATALOGUE)
    assert told["stages"] == [stage._asdict() for stage in found]
    assert (told["least"], told["evaluations"], told["most"]) == total(found)
    assert told["least"] < told["evaluations"] < told["most"]
    assert (told["run"], told["seconds"], told["seconds_least"], told["seconds_most"]) == (None, None, None, None)
    assert told["statement"] == USUAL.format(
        most=f"{told['most']:,}", called="", validation=f"{validation(load_document(campaign())).total:,}"
    )
    assert told["time_statement"] == UNKNOWN


def test_a_small_budget_and_several_calls_are_stated() -> None:
    stages = {"search": [{"method": "direct", "evaluations": 1}]}
    few = load_document(campaign(stages=stages))
    assert validation(few).total > 1
    assert f"at most {validation(few).total}{FEW}." in bounded(few, most(few))
    several = noisy.campaign(1.0, 20, **noisy.REPEATS)
    assert several.simulator is not None
    assert f"{most(several):,} evaluations, {several.simulator.calls * most(several):,} calls, those" in bounded(
        several, most(several)
    )


def test_of_a_campaign_that_has_run_it_is_what_that_run_had(service: Service, client: httpx.Client) -> None:
    name = submit(client)
    finish(service)
    found = client.get(f"/api/v1/runs/{name}").json()
    told = estimate(client, campaign())
    assert (told["run"], told["evaluations"]) == (name, found["evaluations"])
    assert told["least"] == found["evaluations"] < told["most"] == most(load_document(campaign())) == found["planned"]
    assert told["seconds"] == told["seconds_least"] > 0
    assert told["seconds_most"] is None
    assert name in told["statement"]
    assert name in told["time_statement"]
    other = estimate(client, campaign(seed=7))
    assert other["run"] is None, "of another campaign it is an estimate"
    client.post("/api/v1/runs/remove", json={"runs": [name], "reason": "wrong"})
    assert estimate(client, campaign())["run"] is None


def test_a_campaign_with_problems_has_none(service: Service, client: httpx.Client) -> None:
    wrong = campaign(criterion={"component": "unknown", "threshold": 1})
    assert client.post("/api/v1/campaigns/check", json={"campaign": wrong}).json()["estimate"] is None


def test_of_a_simulator_the_time_is_as_measured_or_how_to_measure_it(
    bare: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.catalog.service.check", lambda campaign, catalogue: [])  # it has no methods
    publish(bare)
    with bare.signed_in() as client:
        told = estimate(client, package.campaign())
        assert told["seconds"] is None
        assert "`clearance check-simulator two_basins --data DIR`" in told["time_statement"]
        run(bare, "aa", measured(call_seconds=0.5, slots=2))
        told = estimate(client, package.campaign(seed=99))
        assert told["time_statement"] == (
            "One evaluation took 500 ms (R-0001, 15 evaluations), on 2 slots; 202 more confirm results. The most "
            "is the time of one evaluation after the other."
        )
        assert told["seconds"] == 0.5 * (-(-told["evaluations"] // 2) + 101)
        assert told["seconds_least"] == 0.5 * -(-told["least"] // 2), "with all slots busy"
        assert told["seconds_most"] == 0.5 * told["most"], "those made again are among them"
        run(bare, "aa", measured(call_seconds=0.5, slots=2, start_seconds=4.0, recycle=8))
        slow = estimate(client, package.campaign(seed=98))
        cost = Cost("R-0002", 0.5, 2, 15, start=4.0, recycle=8)
        assert slow["time_statement"] == cost.lasts(told["evaluations"], again=202)[1]
        assert slow["seconds"] == 4.0 + 1.0 * -(-told["evaluations"] // 2) + 4.5 * 101
