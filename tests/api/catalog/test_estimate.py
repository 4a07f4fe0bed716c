"""What a run takes is estimated by the service: as in an earlier run of the campaign, or as such runs usually are."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from backend.catalog.estimate import AFTERWARDS, AS_BEFORE, FEW, LATER, PROMISE, TIME_AS_BEFORE, UNKNOWN, bounded
from backend.catalog.pace import COMPUTED, UNTIMED
from backend.db.queue import Queue
from backend.db.store import RunStore
from campaigns.asked.allowance import validation
from campaigns.asked.load import load_document
from campaigns.asked.proposal import RETRIED, Cost
from campaigns.checked import prediction
from campaigns.checked.expected import expected, fewer, total
from campaigns.checked.foreseen import foreseen
from campaigns.stages.attraction import AttractionResult
from campaigns.stages.found import declared
from campaigns.stages.plan import bound, most, onward
from campaigns.stored.records import StagePlan
from tests import results
from tests.given.databases import AT_NIGHT
from tests.given.finished_runs import finish, search
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
    promise = bounded(load_document(campaign()), told["most"])
    allowed = f"{validation(load_document(campaign())).total:,}"
    assert promise == PROMISE.format(
        most=f"{told['most']:,}", called="", validation=allowed + LATER.format(onward=1000)
    )
    assert told["statement"] == f"{AFTERWARDS} {promise}"
    assert told["time_statement"] == UNKNOWN


def test_a_small_budget_and_several_calls_are_stated() -> None:
    stages = {"search": [{"method": "direct", "evaluations": 1}]}
    few = load_document(campaign(stages=stages))
    assert validation(few).total > 1
    assert f"at most {validation(few).total}{FEW}{LATER.format(onward=onward(bound(few), few))}." in bounded(
        few, most(few)
    )
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
    assert told["seconds_most"] == pytest.approx(told["seconds"] * told["most"] / told["evaluations"])
    took = AS_BEFORE.format(run=name, evaluations=f"{told['evaluations']:,}")
    assert told["statement"] == f"{took} {bounded(load_document(campaign()), told['most'])}"
    assert name in told["time_statement"]
    other = estimate(client, campaign(seed=7))
    assert other["run"] is None, "of another campaign it is an estimate"
    client.post("/api/v1/runs/remove", json={"runs": [name], "reason": "wrong"})
    assert estimate(client, campaign())["run"] is None


def test_a_campaign_with_problems_has_none(service: Service, client: httpx.Client) -> None:
    wrong = campaign(criterion={"component": "unknown", "threshold": 1})
    assert client.post("/api/v1/campaigns/check", json={"campaign": wrong}).json()["estimate"] is None


def test_what_bars_cleared_is_stated_before_the_run(service: Service, client: httpx.Client) -> None:
    few = [{"method": "direct", "evaluations": 10}]
    for changes, codes in (
        ({}, ["agreement"]),
        ({"stages": {"search": few, "certify": None}}, ["agreement", "sample"]),
        ({"target_probability": 1e-5}, ["agreement", "target"]),
    ):
        document = campaign(**changes)
        checked = client.post("/api/v1/campaigns/check", json={"campaign": document}).json()
        expected = foreseen(load_document(document), CATALOGUE)
        assert checked["foreseen"] == [{"code": each.code, "statement": each.statement} for each in expected]
        assert [each.code.value for each in expected] == codes
    wrong = campaign(criterion={"component": "unknown", "threshold": 1})
    assert client.post("/api/v1/campaigns/check", json={"campaign": wrong}).json()["foreseen"] == []


def predicted(client: httpx.Client, **changes: Any) -> tuple[list[str], dict[str, Any] | None]:
    """The fields of the problems of a campaign, and its predicted bound."""
    document = campaign(**changes)
    checked = client.post("/api/v1/campaigns/check", json={"campaign": document}).json()
    found = checked["predicted_bound"]
    if found is not None:
        conforms(found, {"$ref": "#/components/schemas/PredictedBound"})
        made = load_document(document)
        best = prediction.predicted(made, CATALOGUE)
        assert best is not None
        assert (found["statement"], found["warning"]) == (best.statement, prediction.warning(best, made))
        assert tuple(found[k] for k in ("source", "samples", "outside", "upper_bound")) == (
            best.source, best.samples, best.outside, best.upper_bound,
        )  # fmt: skip
    return [problem["field"] for problem in checked["problems"]], found


def test_the_bound_that_the_sample_can_show_is_predicted(service: Service, client: httpx.Client) -> None:
    def stages(**certify: Any) -> dict[str, Any]:
        return {"search": [{"method": "direct", "evaluations": 10}], "certify": certify or None}

    problems, found = predicted(client, stages=stages(samples=300))
    assert (problems, found and found["warning"]) == ([], None)
    problems, found = predicted(client, stages=stages(samples=59), target_probability=0.001)
    assert problems == []
    assert found is not None
    assert " 3,000 samples" in found["warning"]
    assert predicted(client, stages=stages()) == ([], None)
    tails = {"kind": "normal", "mean": 5.0, "deviation": 1.0}
    uncertain = {"vehicle.m": {"low": 4.0, "high": 6.0, "distribution": tails}}
    of = {"uncertain": uncertain, "target_probability": 0.05}
    problems, found = predicted(client, stages=stages(samples=20_000), **of)
    assert problems == []
    assert found is not None
    assert found["upper_bound"] > found["outside"] > 0.317
    assert "widen the bounds" in found["warning"]
    counted = stages(samples=20_000, keep="lowest", until="target")
    assert predicted(client, stages=counted, **of) == (["stages.certify.samples"], None)
    refused = client.post("/api/v1/runs", json={"campaign": campaign(stages=counted, **of)})
    assert refused.status_code == 422


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
            "One evaluation took 500 ms (R-0001, 15 evaluations), on 2 slots; 202 more confirm results. The time with "
            "all evaluations is that of one evaluation after the other."
        )
        assert told["seconds"] == 0.5 * (-(-told["evaluations"] // 2) + 101)
        assert told["seconds_least"] == 0.5 * -(-told["least"] // 2), "with all slots busy"
        assert told["seconds_most"] == 0.5 * told["most"], "those made again are among them"
        retried = package.campaign(seed=97)
        retried["simulator"] |= {"retries": 3}
        again = estimate(client, retried)
        assert [again[name] for name in ("seconds", "seconds_least")] == [told["seconds"], told["seconds_least"]]
        assert again["seconds_most"] == 4 * told["seconds_most"], "each call and three retries"
        assert f", {4 * told['most']:,} calls {RETRIED}, " in again["statement"]
        assert again["time_statement"].endswith(f", {RETRIED}.")
        run(bare, "aa", measured(call_seconds=0.5, slots=2, start_seconds=4.0, recycle=8))
        slow = estimate(client, package.campaign(seed=98))
        cost = Cost("R-0002", 0.5, 2, 15, start=4.0, recycle=8)
        assert slow["time_statement"] == cost.lasts(told["evaluations"], again=202)[1]
        assert slow["seconds"] == 4.0 + 1.0 * -(-told["evaluations"] // 2) + 4.5 * 101


def test_after_an_earlier_run_of_a_simulator_the_longest_time_is_that_of_any_run(
    bare: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.catalog.service.check", lambda campaign, catalogue: [])  # it has no methods
    publish(bare)
    with bare.signed_in() as client:
        run(bare, "aa", measured(call_seconds=0.5, slots=2), evaluations=15)
        other, told = estimate(client, package.campaign(seed=99)), estimate(client, package.campaign())
        assert (told["run"], told["evaluations"], told["seconds"]) == ("R-0001", 15, 1.0)
        assert told["seconds_most"] == other["seconds_most"] == 0.5 * told["most"]
        before = TIME_AS_BEFORE.format(run="R-0001", scaled="")
        assert told["time_statement"] == f"{before} {other['time_statement']}"


@pytest.fixture
def unchecked(monkeypatch: pytest.MonkeyPatch) -> None:
    """The small catalogue has no component with noise, and none with a polynomial model."""
    for module in ("catalog.service", "runs.submission"):
        monkeypatch.setattr(f"backend.{module}.check", lambda campaign, catalogue: [])


@AT_NIGHT
@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("before", [1, 2, 40])
def test_the_time_is_in_proportion_to_the_realisations(service: Service, client: httpx.Client, before: int) -> None:
    submit(client, **noisy_scenario(before))
    evaluate(service, seconds=2.0)
    for after in (1, 2, 40):
        told = estimate(client, campaign(**noisy_scenario(after), seed=7))
        assert told["run"] is None
        for name, number in (("seconds", "evaluations"), ("seconds_least", "least"), ("seconds_most", "most")):
            assert told[name] == pytest.approx(2.0 / 1000 * told[number] * after / before)


def noisy_scenario(realisations: int) -> dict[str, Any]:
    return {"scenario": campaign()["scenario"] | {"realisations": {"seeds": list(range(realisations))}}}


def evaluate(service: Service, seconds: float, computing: dict[str, float] | None = None) -> None:
    """Work off the next run: a search of 1000 evaluations, and stages without any."""
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    others = computing or {}
    store.plan([StagePlan("search", "direct", 1000), *(StagePlan(kind, None, 0) for kind in others)])
    store.append(0, 0, search(0, 1000))
    store.finish(0, results.searched(), seconds)
    for position, (kind, spent) in enumerate(others.items(), 1):
        store.finish(position, RESULTS[kind], spent)
    store.conclude(results.verdict("cleared", "", 1.0, 1.0))


RESULTS = {"attraction": AttractionResult(states=[], held=[], flow=[])}
"""A result of each kind of stage that computes without evaluations."""


@AT_NIGHT
@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("kind", RESULTS)
def test_a_stage_without_evaluations_is_part_of_the_time_or_named(
    service: Service, client: httpx.Client, kind: str
) -> None:
    stages, title = {**campaign()["stages"], kind: {}}, declared()[kind].title
    submit(client)
    evaluate(service, 2.0)
    untimed = UNTIMED.format(title=title)
    told = estimate(client, campaign(stages=stages))
    assert (told["untimed"], told["seconds_most"]) == ([title], None)
    assert told["seconds"] == pytest.approx(told["evaluations"] * 2.0 / 1000)
    assert told["time_statement"].endswith(untimed)
    check = client.post("/api/v1/campaigns/check", json={"campaign": campaign(stages=stages)}).json()
    assert check["seconds"] is None

    submit(client, stages=stages)
    evaluate(service, 2.0, {kind: 40.0})
    same = estimate(client, campaign(stages=stages))
    assert (same["run"], same["seconds"], same["untimed"]) == ("R-0002", 42.0, [])
    assert same["seconds_most"] == pytest.approx(40.0 + 2.0 * same["most"] / 1000)
    known = estimate(client, campaign(stages=stages, seed=7))
    assert (known["run"], known["untimed"]) == (None, [])
    for name, number in (("seconds", "evaluations"), ("seconds_least", "least"), ("seconds_most", "most")):
        assert known[name] == pytest.approx(40.0 + 2.0 / 1000 * known[number])
    assert known["time_statement"].endswith(COMPUTED.format(title=title, time="40 s", run="R-0002"))
    moved = campaign(stages=stages)
    moved["scenario"] = moved["scenario"] | {"goal": {"x": 5, "y": 7}}
    assert estimate(client, moved)["untimed"] == [title], "of another scenario it is not known"


def test_a_stage_that_may_take_fewer_evaluations_is_named(service: Service, client: httpx.Client) -> None:
    stages = {**campaign()["stages"], "estimate": {"evaluations": 1000}}
    told, usual = estimate(client, campaign(stages=stages)), estimate(client, campaign())
    assert told["evaluations"] - usual["evaluations"] == told["most"] - usual["most"] == 1000
    assert told["least"] == usual["least"], "a run without a violation"
    shorter = fewer(load_document(campaign(stages=stages)), "estimate")
    assert shorter is not None
    assert shorter.when in told["statement"]
