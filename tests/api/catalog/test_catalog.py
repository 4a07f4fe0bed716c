"""Components, the library of campaigns, and checking a campaign without submitting it."""

from __future__ import annotations

import httpx
import pytest
import yaml

from backend.catalog import service as catalog
from backend.db.queue import Queue
from backend.db.store import RunStore
from campaigns import Campaign, library, load_text
from campaigns.asked.text import to_yaml
from campaigns.results.drawn import library_flights
from campaigns.stored.records import StagePlan
from tests import results
from tests.given.finished_runs import search
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE, campaign, published_by_workers
from tests.given.submissions import WRONG, YAML, submit

CHECK = "/api/v1/campaigns/check"


def test_components_are_the_published_catalogue(guest: httpx.Client) -> None:
    assert guest.get("/api/v1/components").json() == CATALOGUE.model_dump(mode="json")


def test_the_library_is_listed_with_text_and_digest(guest: httpx.Client) -> None:
    found = guest.get("/api/v1/campaigns").json()
    assert [c["id"] for c in found] == list(library())
    for shipped in found:
        assert load_text(shipped["yaml"]).digest == shipped["digest"]
        assert Campaign.model_validate(shipped["document"]).digest == shipped["digest"]
        assert guest.get(f"/api/v1/campaigns/{shipped['id']}").json() == shipped
    problem(guest.get("/api/v1/campaigns/nothing"), 404)
    problem(guest.get("/api/v1/campaigns/..%2f..%2fsecret"), 404)


def test_the_library_has_nominal_flights_unless_a_file_was_changed(
    guest: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    for shipped in guest.get("/api/v1/campaigns").json():
        assert shipped["nominal"]["digest"] == shipped["digest"], shipped["id"]
    changed = {name: flight.model_copy(update={"digest": "0"}) for name, flight in library_flights().items()}
    monkeypatch.setattr(catalog, "library_flights", lambda: changed)
    assert {guest.get(f"/api/v1/campaigns/{name}").json()["nominal"] for name in library()} == {None}


def test_before_a_worker_has_published_the_library_reports_what_is_missing(bare: Service) -> None:
    with bare.signed_in() as client:
        found = client.get("/api/v1/campaigns").json()
        assert "clearance worker" in found[0]["problems"][0]["message"]
        problem(client.post(CHECK, json={"campaign": campaign()}), 503)


@pytest.mark.nightly
def test_the_shipped_campaigns_fit_the_components_that_workers_publish(bare: Service) -> None:
    bare.publish(published_by_workers())
    with bare.signed_in() as client:
        for shipped in client.get("/api/v1/campaigns").json():
            assert shipped["problems"] == []
            answer = client.post(CHECK, content=shipped["yaml"], headers=YAML).json()
            assert (answer["ok"], answer["digest"]) == (True, shipped["digest"])


def test_the_schema_of_a_campaign_is_served(guest: httpx.Client) -> None:
    schema = guest.get("/api/v1/campaigns/schema").json()
    assert {"scenario", "uncertain", "criterion", "stages"} <= set(schema["properties"])


@pytest.mark.parametrize("form", ["json", "yaml"])
def test_a_good_campaign_is_explained(still: Service, guest: httpx.Client, form: str) -> None:
    before = still.rows()
    if form == "json":
        answer = guest.post(CHECK, json={"campaign": campaign()})
    else:
        answer = guest.post(CHECK, content=yaml.safe_dump(campaign()), headers=YAML)
    checked = answer.json()
    asked = Campaign.model_validate(campaign())
    assert (checked["ok"], checked["problems"], checked["digest"]) == (True, [], asked.digest)
    assert checked["document"] == asked.document()
    assert (checked["evaluations"], checked["seconds"]) == (
        (1 + 1)
        + 42
        + 1000
        + (2 * 300 + 300)
        + (1000 + 1000),  # a trace; excluded samples, and all beyond the horizon; validation, and others beyond it
        None,
    )
    by_path = {p["path"]: p for p in checked["parameters"]}
    mass = by_path["vehicle.m"]
    assert (mass["nominal"], mass["low"], mass["high"], mass["entry"]["unit"]) == (5.0, 4.0, 6.0, "kg")
    assert by_path["goal.x"]["low"] is None
    assert load_text(checked["yaml"]).digest == asked.digest
    assert still.rows() == before


@pytest.mark.parametrize("case", WRONG)
def test_errors_are_reported_by_field(guest: httpx.Client, case: str) -> None:
    document, field, message = WRONG[case]
    answer = guest.post(CHECK, json={"campaign": document})
    assert answer.status_code == 200
    checked = answer.json()
    assert not checked["ok"]
    assert any(p["field"] == field and message in p["message"] for p in checked["problems"]), checked["problems"]


def test_what_cannot_be_read_is_a_problem_too(guest: httpx.Client) -> None:
    checked = guest.post(CHECK, content="name: [", headers=YAML).json()
    assert (checked["ok"], checked["digest"], checked["document"]) == (False, None, None)
    assert "YAML" in checked["problems"][0]["message"]
    problem(guest.post(CHECK, content="{", headers={"content-type": "application/json"}), 422)
    problem(guest.post(CHECK, content="x", headers={"content-type": "image/png"}), 415)


def test_time_is_estimated_from_earlier_runs_of_the_same_components(service: Service, client: httpx.Client) -> None:
    submit(client)
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan([StagePlan("search", "direct", 1000)])
    store.append(0, 0, search(0, 1000))
    store.finish(0, results.searched(), 2.0)  # 500 evaluations a second
    store.conclude(results.verdict("cleared", "", 1.0, 1.0))
    same = client.post(CHECK, json={"campaign": campaign()}).json()
    assert same["seconds"] == pytest.approx(3944 / 500)
    longer = campaign()
    longer["scenario"] = {**longer["scenario"], "horizon": 30}
    assert client.post(CHECK, json={"campaign": longer}).json()["seconds"] == pytest.approx(2 * 3944 / 500)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"summary": "Größe: 5 µm", "notes": "two\nlines\n", "tags": ["a", "b"], "seed": 1},
        {"target_probability": 1e-6, "confidence": 0.999, "agreement": 0.1 + 0.2},
        {
            "stages": {
                "sensitivity": None,
                "search": [{"method": "sqp", "evaluations": 7, "starts": [{"vehicle.m": 1e-7}]}],
            }
        },
        {"uncertain": {"vehicle.m": {"low": 4, "high": 6, "distribution": {"kind": "triangular", "mode": 5}}}},
        {"uncertain": {"vehicle.m": {"plus_minus": 1e-5, "distribution": "uniform", "unit": "kg"}}},
    ],
)
def test_a_campaign_as_text_reads_back_the_same(changes: dict[str, object]) -> None:
    asked = Campaign.model_validate(campaign(**changes))
    again = load_text(to_yaml(asked))
    assert (again, again.digest) == (asked, asked.digest)
