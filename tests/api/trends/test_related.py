"""Other runs with the same input: the same campaign, another seed, other code."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Run
from backend.trends import service as trends
from campaigns import Campaign
from campaigns.runs import run_number
from tests.given.databases import BOTH
from tests.given.finished_runs import Work, finish
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit


def listed(client: httpx.Client, run: str) -> dict[str, Any]:
    answer = client.get(f"/api/v1/runs/{run}/related")
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def simulated_by(service: Service, run: str, code: str | None) -> None:
    flown = None if code is None else {"code": code, "clearance": "0.1.0"}
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == run_number(run)).values(flown=flown))


@pytest.mark.by_day(1)
@BOTH
def test_runs_that_differ_in_one_thing(service: Service, client: httpx.Client) -> None:
    codes = {"same": "a", "other code": "b", "other seed": "a", "both": "b", "seed, unknown code": None}
    seeds = {"other seed": 2, "both": 2, "seed, unknown code": 2**53}
    own = submit(client, seed=1)
    runs = {what: submit(client, seed=seeds.get(what, 1)) for what in codes}
    submit(client, seed=1, agreement=0.1)  # another campaign of the same name
    simulated_by(service, own, "a")
    for what, code in codes.items():
        simulated_by(service, runs[what], code)
    found = listed(client, own)
    differs = {item["id"]: (item["differs"], item["code_known"]) for item in found["runs"]}
    assert differs == {
        runs["same"]: ([], True),
        runs["other code"]: (["code"], True),
        runs["other seed"]: (["seed"], True),
        runs["seed, unknown code"]: (["seed"], False),
    }
    assert found["total"] == 4
    assert [item["id"] for item in found["runs"]] == sorted(differs, reverse=True)
    assert found["runs"][0]["seed"] == 2**53


def test_numbers_only_of_runs_that_are_done(service: Service, client: httpx.Client) -> None:
    own, full, plain, stopped = (submit(client) for _ in range(4))
    service_does = [finish_fully, finish_fully, finish]
    for does in service_does:
        does(service)
    work = Work(service)
    work.nominal()
    work.search(0, 700)  # has a best value in the list of runs, which is not the worst case of a whole search
    client.post(f"/api/v1/runs/{stopped}/cancel")
    found = {item["id"]: item for item in listed(client, own)["runs"]}
    done = found[full]
    assert (done["verdict"], done["worst_cost"], done["quantity"], done["unit"]) == ("cleared", 1.3, "d_min", "m")
    assert done["margin"] == pytest.approx(0.8)
    assert (done["violations"], done["samples"], done["confidence"]) == (0, 3000, 0.95)
    assert done["upper_bound"] == pytest.approx(0.000998, rel=1e-3)
    assert done["bound_source"] == "certify"
    assert (found[plain]["verdict"], found[plain]["samples"], found[plain]["upper_bound"]) == ("violated", None, None)
    assert client.get(f"/api/v1/runs/{stopped}").json()["worst_cost"] is not None
    for name in ("worst_cost", "margin", "upper_bound", "bound_source", "verdict"):
        assert found[stopped][name] is None


def test_removed_runs_are_not_listed_and_the_rest_is_counted(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trends, "MOST", 2)
    own, *others = (submit(client) for _ in range(5))
    finish(service)
    finish(service)
    assert client.delete(f"/api/v1/runs/{others[0]}", params={"reason": "wrong"}).status_code == 200
    found = listed(client, own)
    assert [item["id"] for item in found["runs"]] == [others[3], others[2]]
    assert found["total"] == 3
    assert listed(client, others[0])["total"] == 4  # a removed run still shows the listed ones


def test_what_is_not_there(client: httpx.Client) -> None:
    problem(client.get("/api/v1/runs/R-0099/related"), 404)
    assert listed(client, submit(client)) == {"runs": [], "total": 0, "question": {"none": 1}, "against": ""}


def test_campaigns_apart_from_their_seed() -> None:
    one, other, third = (Campaign.model_validate(campaign(**given)) for given in ({}, {"seed": 2}, {"agreement": 0.1}))
    assert one.digest != other.digest
    assert one.seedless == other.seedless
    assert one.seedless != third.seedless


def test_runs_without_a_stored_question_do_not_count_as_asking_the_same(service: Service, client: httpx.Client) -> None:
    runs = [submit(client), submit(client, name="Another", seed=5)]
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).values(question=None))
    assert listed(client, runs[0])["question"] == {}
    text = client.get(f"/api/v1/runs/{runs[0]}/report.html").text
    assert "not known, because" in text
