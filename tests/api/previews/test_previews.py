"""Previews of an edited campaign: the real process once, misbehaving stand-ins, waiting and disconnected clients."""

from __future__ import annotations

import asyncio
import sys
import threading
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import CatalogueDocument
from backend.http.errors import RefusedError
from backend.previews import service as previews
from backend.previews.service import LIMIT, Previews
from backend.scenes.live.live import Live
from campaigns import Campaign, library
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.small_catalogue import CATALOGUE, campaign, component, parameter, published_by_workers
from tests.given.stand_in_simulation import STAND_IN
from tests.given.submissions import YAML

PREVIEW = "/api/v1/campaigns/preview"


def stand_in(service: Service, limit: float = 10.0) -> None:
    service.app.state.previews = Previews(Live((sys.executable, "-c", STAND_IN), limit=limit, first_limit=limit))


def test_the_nominal_flight_of_a_shipped_case(bare: Service) -> None:
    bare.publish(published_by_workers())
    text = library()["pioneer_moving"].read_text(encoding="utf-8")
    with bare.signed_in() as client:
        answer = client.post(PREVIEW, content=text, headers=YAML, timeout=LIMIT)
        assert answer.status_code == 200, answer.text
        flown = answer.json()
        edited = client.post(PREVIEW, content=text.replace("threshold: 5.0", "threshold: 6.0"), headers=YAML).json()
    assert (flown["status"], flown["frame"], flown["quantity"], flown["unit"]) == ("ok", "enu", "d_min", "m")
    assert flown["margin"] == pytest.approx(flown["value"] - flown["threshold"])
    assert flown["closest"]["value"] == pytest.approx(flown["value"])
    assert 100 < len(flown["t"]) < 300
    (intruder,) = flown["intruders"]
    assert {len(flown[name]) for name in ("x", "y", "z", "heading")} == {len(flown["t"])} == {len(intruder["x"])}
    assert edited["value"] == flown["value"]
    assert edited["margin"] == pytest.approx(flown["margin"] - 1)
    assert edited["digest"] != flown["digest"]


@pytest.mark.nightly
def test_a_failed_preview_gives_its_reason(service: Service, client: httpx.Client) -> None:
    stand_in(service)
    flown = client.post(PREVIEW, json={"campaign": campaign()}).json()
    assert (flown["status"], flown["reason"], flown["value"], flown["margin"]) == (
        "failed",
        "it overturned",
        None,
        None,
    )
    assert flown["x"] == [0.0, None]
    assert flown["seconds"] > 0


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("name", "status", "statement"),
    [("dies", 503, "ended unexpectedly"), ("slow", 503, "timed out"), ("refused", 422, "there is no trim")],
)
def test_a_process_that_cannot_simulate_is_reported(
    service: Service, client: httpx.Client, name: str, status: int, statement: str
) -> None:
    stand_in(service, limit=1.0)
    refused = problem(client.post(PREVIEW, json={"campaign": campaign(name=name)}), status)
    assert statement in refused["detail"]
    assert client.post(PREVIEW, json={"campaign": campaign()}).status_code == 200


def test_a_campaign_that_cannot_be_run_is_not_simulated(guest: httpx.Client) -> None:
    high = {"component": "circle", "parameters": {"radius": "wide"}}
    scenario = campaign()["scenario"] | {"obstacles": [high]}
    refused = problem(guest.post(PREVIEW, json={"campaign": campaign(scenario=scenario)}), 422)
    assert [error["field"] for error in refused["errors"]] == ["scenario.obstacles.0.parameters.radius"]
    unknown = problem(
        guest.post(PREVIEW, json={"campaign": campaign(criterion={"component": "b", "threshold": 1})}), 422
    )
    assert unknown["errors"][0]["field"] == "criterion.component"
    problem(guest.post(PREVIEW, content=b"{", headers=YAML), 422)
    problem(guest.post(PREVIEW, content=b"", headers={"Content-Type": "text/plain"}), 415)


@pytest.mark.parametrize(
    ("horizon", "step", "seeds", "message"),
    [(1000, 0.0005, [0], "the trace of a preview has at most 0.16 GB"), (100, 0.0002, list(range(64)), "20,000,000")],
)
def test_a_flight_that_is_too_long_to_wait_for_is_refused_at_once(
    service: Service, client: httpx.Client, horizon: float, step: float, seeds: list[int], message: str
) -> None:
    stand_in(service)
    catalogue = CATALOGUE.model_dump(mode="json")
    catalogue["components"].append(component("fault", "noise", [parameter("seed")], path="perception"))
    with service.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=catalogue))
    scenario = campaign()["scenario"] | {"horizon": horizon, "step": step, "realisations": {"seeds": seeds}}
    asked = campaign(scenario=scenario | {"faults": [{"component": "noise"}]})
    assert client.post("/api/v1/campaigns/check", json={"campaign": asked}).json()["problems"] == []
    (refused,) = problem(client.post(PREVIEW, json={"campaign": asked}), 422)["errors"]
    assert refused["field"] == "scenario"
    assert message in refused["message"]


def test_nothing_is_simulated_before_a_worker_has_published(bare: Service) -> None:
    with bare.signed_in() as client:
        problem(client.post(PREVIEW, json={"campaign": campaign()}), 503)


class Held(Live):
    """A process whose first flight lasts until it is let go."""

    def __init__(self) -> None:
        super().__init__()
        self.simulated: list[str] = []
        self.go = threading.Event()

    def simulate(
        self, campaign: Any, digest: str, parameters: Any, rows: int, seed: int | None = None
    ) -> dict[str, Any]:
        self.simulated.append(campaign["name"])
        assert self.go.wait(10)
        return {}


def test_only_the_newest_request_is_simulated_and_the_queue_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(previews, "WAITING", 3)
    live = Held()
    flights = Previews(live)

    async def here() -> bool:
        return False

    async def away() -> bool:
        return True

    async def all_of_them() -> list[Any]:
        names = ("first", "overtaken", "newest")
        asked = [Campaign.model_validate(campaign(name=name)) for name in names]
        gone = (here, away, here)
        tasks = [asyncio.create_task(flights.simulate("", one, left)) for one, left in zip(asked, gone, strict=True)]
        await asyncio.to_thread(until, lambda: live.simulated)
        with pytest.raises(RefusedError) as full:
            await flights.simulate("", asked[0], here)
        assert full.value.kind == "preview-busy"
        live.go.set()
        return await asyncio.gather(*tasks, return_exceptions=True)

    first, overtaken, newest = asyncio.run(all_of_them())
    assert live.simulated == ["first", "newest"]
    assert isinstance(overtaken, RefusedError)
    assert isinstance(first, tuple)
    assert isinstance(newest, tuple)


def test_a_stop_waits_for_no_preview(service: Service) -> None:
    stand_in(service, limit=60.0)
    statement: list[Any] = []

    def ask() -> None:
        with service.signed_in() as client:
            try:
                statement.append(client.post(PREVIEW, json={"campaign": campaign(name="slow")}).status_code)
            except httpx.TransportError as error:
                statement.append(error)

    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    until(lambda: service.app.state.previews.live._child and service.app.state.previews.live._child._open_requests)
    service.stop()
    thread.join(10)
    assert len(statement) == 1
