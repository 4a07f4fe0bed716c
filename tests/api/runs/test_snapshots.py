"""A run stores its component descriptions: shared by runs, compared with the installed ones, part of the digest."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.db.engine import read
from backend.db.queue import Queue
from backend.db.store import RunStore
from backend.db.tables import CatalogueDocument, CatalogueSnapshot, Run
from backend.runs.waiting import PUT_BACK
from campaigns import Campaign, CampaignError, Catalogue
from campaigns.checked.snapshot import changes, digest_of, snapshot, values_changed
from campaigns.versions import OtherCode
from tests.given.databases import AT_NIGHT, BOTH
from tests.given.finished_runs import search
from tests.given.reported_runs import PLAN, finish_fully, missing
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE, campaign
from tests.given.submissions import submit
from tests.given.waiting_runs import HERE, OLD, arrive
from worker.running.processes import child
from worker.running.runs import begun

ASKED = Campaign.model_validate(campaign())
Change = Callable[[dict[str, Any]], None]


def altered(change: Change) -> Catalogue:
    """The catalogue of another installation."""
    document = CATALOGUE.model_dump(mode="json")
    change(document)
    return Catalogue.model_validate(document)


def entry(document: dict[str, Any], name: str) -> Any:
    return next(e for e in document["components"] + document["methods"] if e["name"] == name)


def heavier(document: dict[str, Any]) -> None:
    """J by default four times as large, other limits and another text, no potential field any more."""
    unicycle = entry(document, "unicycle")
    unicycle["parameters"][1] |= {"default": 0.2, "high": 9.0}
    unicycle["text"] = "Another model."
    document["components"].remove(entry(document, "potential_field"))
    document["version"] = "next"


def install(service: Service, catalogue: Catalogue) -> None:
    """Another worker publishes its components."""
    with service.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=catalogue.model_dump(mode="json")))


def forget(service: Service) -> None:
    """As a run of the time before snapshots."""
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).values(snapshot=None))


@BOTH
def test_runs_of_the_same_components_share_one_snapshot(service: Service, client: httpx.Client) -> None:
    submit(client)
    submit(client, criterion={"threshold": 0.4}, seed=2)
    submit(client, stages={"search": [{"method": "sqp", "evaluations": 100}]})
    assert service.rows()["catalogue_snapshots"] == 2
    first, second, third = (client.get(f"/api/v1/runs/R-000{i}/components").json() for i in (1, 2, 3))
    assert first == second
    assert first["digest"] != third["digest"]
    assert first["digest"] == client.get("/api/v1/runs/R-0001").json()["components_digest"]
    kept = first["catalogue"]
    assert [c["name"] for c in kept["components"]] == [
        "unicycle",
        "pid_speed",
        "potential_field",
        "circle",
        "separation",
    ]
    assert [m["name"] for m in kept["methods"]] == ["direct"]
    assert digest_of(kept) == first["digest"]
    assert first["changes"] == []


@AT_NIGHT
def test_a_later_installation_does_not_change_the_description_of_a_run(service: Service, client: httpx.Client) -> None:
    by_default = {"vehicle.J": {"plus_minus": "20%"}, "vehicle.m": {"low": 4, "high": 6}}
    run = f"/api/v1/runs/{submit(client, uncertain=by_default)}"
    finish_fully(service)
    addresses = [f"{run}/{name}" for name in ("evaluations", "findings", "exports/evaluations.csv", "signoffs")]
    before = [client.get(address).text for address in addresses]
    install(service, altered(heavier))
    assert [client.get(address).text for address in addresses] == before
    told = client.get(f"{run}/components").json()
    assert told["catalogue"] == snapshot(ASKED, CATALOGUE).model_dump(mode="json")
    assert told["changes"] == [
        "The text of the vehicle unicycle (equations, source) is different here.",
        "The default of J of the vehicle unicycle was 0.05 kg m2, here it is 0.2 kg m2.",
        "The limits of J of the vehicle unicycle were 1e-06 to 100000, here they are 1e-06 to 9.",
        "The avoider potential_field is not in this installation.",
    ]
    export = client.get(f"{run}/exports/run.json").json()
    assert export["components"] == told
    report = client.get(f"{run}/report.html").text
    assert "describes them differently" in report
    assert "was 0.05 kg m2, here it is 0.2 kg m2" in report
    assert told["digest"] in report
    assert not {"component", "descriptions"} & missing(report)


def test_a_waiting_run_names_its_criterion_although_it_is_no_longer_installed(
    service: Service, client: httpx.Client
) -> None:
    run = submit(client)
    install(service, altered(lambda document: document["components"].remove(entry(document, "separation"))))
    waiting = client.get(f"/api/v1/runs/{run}").json()
    assert (waiting["state"], waiting["quantity"], waiting["unit"]) == ("queued", "d_min", "m")


def test_a_run_without_snapshot_uses_the_installed_descriptions(service: Service, client: httpx.Client) -> None:
    run = f"/api/v1/runs/{submit(client)}"
    finish_fully(service)
    forget(service)
    told = client.get(f"{run}/components").json()
    assert (told["digest"], told["changes"]) == (None, [])
    assert told["catalogue"] == snapshot(ASKED, CATALOGUE).model_dump(mode="json")
    assert client.get(f"{run}/exports/run.json").json()["components"] is None
    report = client.get(f"{run}/report.html").text
    assert "descriptions" in missing(report)
    assert "component" not in missing(report)
    install(service, altered(heavier))
    assert "component" in missing(client.get(f"{run}/report.html").text)


@AT_NIGHT
def test_the_digest_of_earlier_results_is_what_it_was(service: Service, client: httpx.Client) -> None:
    submit(client, stages=campaign()["stages"] | {"certify": None})

    def digest() -> str:
        with read(service.engine) as reader:
            return results_digest(reader, 1)

    kept = digest()
    with service.engine.begin() as writer:
        writer.execute(sa.update(CatalogueSnapshot).values(document={"version": "another"}))
    assert digest() != kept
    forget(service)
    assert digest() == "3ebf96b5a028133a235db85a1e1ceae24c8a7deba2f44e105eedc23c503e4add"


@AT_NIGHT
def test_the_worker_that_starts_a_run_records_the_meaning_of_its_components(
    service: Service, client: httpx.Client
) -> None:
    submit(client)
    later = altered(lambda d: entry(d, "unicycle")["parameters"][1].update(default=0.055))
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.describe(ASKED, later)
    told = client.get("/api/v1/runs/R-0001/components").json()
    assert told["catalogue"] == snapshot(ASKED, later).model_dump(mode="json")
    store.plan(PLAN)
    store.append(2, 0, search(0, 10))
    with pytest.raises(OtherCode, match=r"vehicle\.J was 0\.055 kg m2, here it is 0\.05"):
        store.describe(ASKED, CATALOGUE)
    store.describe(ASKED, later)
    assert client.get("/api/v1/runs/R-0001/components").json()["digest"] == told["digest"]


def test_a_worker_without_what_the_campaign_was_submitted_with_leaves_it_to_others(
    service: Service, client: httpx.Client
) -> None:
    install(service, altered(lambda d: d.update(version="2.10.0")))
    submit(client)
    before = client.get("/api/v1/runs/R-0001/components").json()
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    earlier = altered(lambda d: d["components"].remove(entry(d, "circle")) or d.update(version="2.9.1"))
    with pytest.raises(OtherCode, match="circle"):
        RunStore(service.engine, claim).describe(ASKED, earlier)
    assert client.get("/api/v1/runs/R-0001/components").json() == before


@pytest.mark.parametrize("name", ["unicycle", "potential_field", "circle", "separation", "direct"])
def test_a_worker_of_the_same_version_without_what_a_run_needs_leaves_it_to_others(
    service: Service, client: httpx.Client, name: str
) -> None:
    run = submit(client)
    before = client.get(f"/api/v1/runs/{run}/components").json()
    fewer = altered(lambda d: d["components" if name != "direct" else "methods"].remove(entry(d, name)))
    queue = Queue(service.engine)
    claim = queue.claim("w1", (), HERE)
    assert claim is not None
    answer = child.perform(lambda campaign, store: pytest.fail("it is executed"), service.engine, fewer, claim)
    assert (answer["outcome"], name in answer["text"]) == ("refused", True)
    queue.refuse(claim, HERE, answer["text"])
    arrive(service, "w1", HERE)
    waits = client.get(f"/api/v1/runs/{run}").json()
    assert (waits["state"], waits["error"], waits["other_code"]) == ("queued", None, None)
    assert name in waits["waits"]
    assert PUT_BACK in waits["waits"]
    assert client.get(f"/api/v1/runs/{run}/components").json() == before
    assert queue.claim("w2", (), OLD) is not None


def test_a_run_without_snapshot_leaves_nothing_to_others(service: Service, client: httpx.Client) -> None:
    """Nothing shows that any worker had the component."""
    submit(client)
    forget(service)
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    RunStore(service.engine, claim).describe(ASKED, altered(lambda d: d["components"].remove(entry(d, "circle"))))


def test_what_the_same_version_cannot_run_fails(service: Service, client: httpx.Client) -> None:
    submit(client)
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    assert not store.of_newer_version(CATALOGUE)
    store.describe(ASKED, altered(lambda d: entry(d, "unicycle")["parameters"][0].update(high=1e-6)))
    document = ASKED.document()
    with pytest.raises(CampaignError, match="novel"):
        begun.readable({**document, "scenario": {**document["scenario"], "novel": 1}}, "run 1", None)


def test_a_campaign_that_the_service_could_read_and_this_version_cannot_is_left_to_others() -> None:
    document = ASKED.document()
    with pytest.raises(OtherCode, match="novel"):
        begun.readable({**document, "scenario": {**document["scenario"], "novel": 1}}, "run 1", None, lambda: True)


OTHERWISE: dict[str, tuple[Change, str | None]] = {
    "nothing": (lambda d: None, None),
    "version alone": (lambda d: d.update(version="next"), None),
    "a component that it does not use": (lambda d: entry(d, "goal_miss").update(text="x"), None),
    "title": (
        lambda d: entry(d, "circle").update(title="Ring"),
        "title of the obstacle circle was “circle”",
    ),
    "unit": (lambda d: entry(d, "unicycle")["parameters"][0].update(unit="g"), "unit of m of the vehicle unicycle was"),
    "start": (
        lambda d: entry(d, "unicycle")["starts"].pop(),
        "has no parameter start state omega in this installation any more",
    ),
    "goal": (
        lambda d: entry(d, "potential_field")["goals"][0].update(default=1.0),
        "the default of goal x of the avoider potential_field was none, here it is 1 m",
    ),
    "one more": (
        lambda d: entry(d, "circle")["parameters"].append(entry(d, "unicycle")["parameters"][0]),
        "has one more parameter here, m",
    ),
    "demands": (lambda d: entry(d, "pid_speed").update(demands=[]), "was force, here it is none"),
    "option": (
        lambda d: entry(d, "direct")["options"]["properties"]["iterations"].update(default=7),
        "the option iterations of the method direct: its default was None, here it is 7",
    ),
    "no option": (lambda d: entry(d, "direct")["options"].clear(), "the method direct has no option iterations here"),
    "no method": (lambda d: d["methods"].clear(), "the method direct is not in this installation"),
}


@pytest.mark.parametrize("case", OTHERWISE)
def test_every_difference_is_reported(case: str) -> None:
    change, text = OTHERWISE[case]
    found = changes(snapshot(ASKED, CATALOGUE), altered(change))
    assert len(found) == (text is not None)
    assert text is None or text in found[0]


def test_what_was_not_recorded_yet_is_no_difference() -> None:
    """Snapshots from before a field of the catalogue was there."""
    kept = snapshot(ASKED, CATALOGUE).model_dump(mode="json")
    now = altered(lambda d: entry(d, "circle").update(reach={"of": ["radius"], "times": 1.0}))
    (change,) = changes(Catalogue(**kept), now)
    assert change.endswith(" 1 times radius")
    for component in kept["components"]:
        del component["reach"]
    assert changes(Catalogue(**kept), now) == []


@pytest.mark.parametrize(
    ("case", "same"),
    [("title", True), ("goal", True), ("one more", True), ("unit", False), ("start", False), ("no method", True)],
)
def test_changes_that_alter_simulations_are_distinguished(case: str, same: bool) -> None:
    """A default is used if the campaign does not give the value; it gives the goal."""
    assert (values_changed(ASKED, snapshot(ASKED, CATALOGUE), altered(OTHERWISE[case][0])) == []) is same
