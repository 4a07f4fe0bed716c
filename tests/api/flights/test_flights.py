"""What-if flights of a run: numbers, refusals, superseded requests, drawing in the view."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from backend.db.purge import purge
from backend.scenes.live.live import Live
from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.results.draws import of_draws
from clearance.testing.problems import Problem
from tests import results
from tests.given.finished_runs import Work
from tests.given.openapi_document import DOCUMENT, conforms
from tests.given.problem_documents import problem
from tests.given.runs_with_failures import INSIDE, SPINNING, lose, values
from tests.given.service import Service, until
from tests.given.shipped_runs import shipped
from tests.given.small_catalogue import CATALOGUE, campaign, component
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY, frames_until, steer, viewing

OTHER = "ffffffff-ffff-4fff-bfff-ffffffffffff"
STAND_IN = """
import json, pathlib, sys, time
print(json.dumps({"ready": True}), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    mass = asked["parameters"].get("vehicle.m")
    pathlib.Path(FOLDER, f"{mass}.begun").touch()
    while pathlib.Path(FOLDER, f"{mass}.held").exists(): time.sleep(0.005)
    if asked["parameters"].get("vehicle.m") == 6.0:
        print(json.dumps({"id": asked["id"], "error": "there is no trim"}), flush=True); continue
    columns = [{"name": "t", "symbol": "t", "unit": "s", "group": "time"}]
    columns += [{"name": n, "symbol": n, "unit": "m", "group": "pose"} for n in ("x", "y")]
    data = {"t": [0.0, 1.0], "x": [0.0, 1.0], "y": [0.0, 1.0]}
    meta = {"parameters": asked["parameters"], "status": "ok", "cost": 1.0, "values": {"separation": 1.0}}
    told = {"status": "ok", "reason": "", "cost": 1.0, "margin": 0.5, "columns": columns, "data": data, "meta": meta,
            "identity": {"engine": "0" * 64}}
    print(json.dumps({"id": asked["id"], **told}), flush=True)
"""


def address(run: str) -> str:
    return f"/api/v1/runs/{run}/flights"


def flown(client: httpx.Client, run: str, **asked: Any) -> dict[str, Any]:
    answer = client.post(address(run), json=asked, timeout=120)
    assert answer.status_code == 200, answer.text
    conforms(answer.json(), {"$ref": "#/components/schemas/FlightAnswer"})
    return dict(answer.json())


@pytest.fixture
def held(service: Service, tmp_path: Path) -> Iterator[Path]:
    """A folder: while it contains `5.5.held`, the response for a mass of 5.5 kg is delayed."""
    service.app.state.live.close()
    live = Live((sys.executable, "-c", STAND_IN.replace("FOLDER", repr(str(tmp_path)))), limit=60, first_limit=60)
    service.app.state.live = live
    yield tmp_path
    live.close()


def test_at_the_parameters_of_a_finding_the_cost_is_the_findings(simulating: Service) -> None:
    physics = Problem(load_file(library()["unicycle_static"]))
    worst = physics.named(np.array([0.9713, 0.3331]))
    batch, _ = physics.evaluate(np.array([[0.9713, 0.3331]]))
    cost = float(batch.costs[0, 0])
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "unicycle_static")
        work = Work(simulating)
        work.nominal()
        work.store.begin(2)
        found = results.finding("F1", cost, cost - 0.5, worst)
        work.store.finish(2, results.searched(), 1.0, findings=[found])
        same = flown(client, run, like="F1")
        assert same["cost"] == cost, "bit by bit"
        assert same["parameters"] == worst
        assert (same["status"], same["reason"], same["seed"], same["drawn"]) == ("ok", "", None, None)
        assert same["margin"] == cost - 0.5
        assert (same["threshold"], same["quantity"], same["unit"]) == (0.5, "d_min", "m")
        assert [(one["name"], one["value"]) for one in same["criteria"]] == [("separation", cost)]
        assert same["trace"]["closest"]["value"] == pytest.approx(cost)
        assert (same["data"], same["columns"][0]["name"]) == ({}, "t")
        by_path = flown(client, run, parameters=worst, rows=50)
        assert by_path["cost"] == cost
        lengths = {len(column) for column in by_path["data"].values()}
        assert len(lengths) == 1
        assert 40 <= lengths.pop() <= 50
        changed = flown(
            client, run, like="F1", parameters={"vehicle.m": physics.named(np.array([0.5, 0.5]))["vehicle.m"]}
        )
        assert changed["parameters"]["vehicle.J"] == worst["vehicle.J"]
        assert changed["cost"] != cost
        elsewhere = flown(client, run, parameters={"obstacles.0.position.x": 3.0, "goal.x": 7.0})
        assert elsewhere["parameters"]["obstacles.0.position.x"] == 3.0
        assert elsewhere["cost"] != flown(client, run)["cost"], "no uncertain parameter, and still one of the scenario"


def test_a_finding_keeps_its_noise_and_another_seed_is_another_flight(simulating: Service) -> None:
    guidance = {"period": 0.1}  # a loop that the adversaries compile, too
    document = load_file(library()["unicycle_noise"]).document()
    document["scenario"] |= {"guidance": guidance}
    physics = Problem(load_document(document))
    point = np.array([[0.1, 0.2, 0.4]])
    seed = int(of_draws(physics.campaign.seed, 0, 1)[0])
    own, _ = physics.evaluate(point, seeds=of_draws(physics.campaign.seed, 0, 1))
    cost, worst = float(own.costs[0, 0]), physics.named(point[0])
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "unicycle_noise", guidance=guidance)
        work = Work(simulating)
        work.nominal()
        work.store.begin(2)
        case = results.validation("F1", cost, realisation=seed)
        found = results.finding("F1", cost, 0.1, worst, validation=case)
        work.store.finish(2, results.searched(), 1.0, findings=[found])
        same = flown(client, run, like="F1")
        assert (same["cost"], same["seed"]) == (cost, seed)
        assert same["trace"]["realisation"]["seed"] == seed
        assert flown(client, run, parameters=worst, seed=seed)["cost"] == cost
        assert flown(client, run, like="F1", seed=seed + 1)["cost"] != cost
        assert flown(client, run, parameters=worst)["seed"] is None


def test_what_is_excluded_or_fails_is_answered_with_its_reason(simulating: Service) -> None:
    with simulating.signed_in() as client:
        lost = lose(simulating, client)
        for point, status, row in ((INSIDE[0], "excluded", 0), (SPINNING[0], "failed", 4)):
            answer = flown(client, lost.run, parameters=values(point))
            assert (answer["status"], answer["reason"]) == (status, lost.reasons[row])
            assert (answer["cost"], answer["margin"]) == (None, None)
            assert [one["value"] for one in answer["criteria"]] == [None]


REFUSED: list[tuple[dict[str, Any], str, str]] = [
    ({"parameters": {"vehicle.mass": 5.0}}, "unknown-parameter", "'vehicle.mass'; did you mean"),
    ({"parameters": {"vehicle.m": -5.0}}, "outside-limits", "0.001 to 100000 kg"),
    ({"parameters": {"vehicle.m": "heavy"}}, "invalid-request", "parameters.vehicle.m"),
    ({"parameters": {"vehicle.m": None}}, "invalid-request", "parameters.vehicle.m"),
    ({"parameters": {"vehicle.m": "nan"}}, "invalid-request", "finite number"),
    ({"like": "F9"}, "unknown-finding", "choose one of nominal"),
    ({"like": "worst"}, "invalid-request", "like"),
    ({"seed": -1}, "invalid-request", "seed"),
    ({"view": "mine"}, "invalid-request", "view"),
    ({"rows": 10_000_000}, "invalid-request", "rows"),
    ({"mass": 5.0}, "invalid-request", "mass"),
]


def test_what_cannot_be_asked_for_is_refused(service: Service, client: httpx.Client, held: Path) -> None:
    run = submit(client)
    for asked, kind, statement in REFUSED:
        refused = problem(client.post(address(run), json=asked), 422)
        assert refused["type"] == f"urn:clearance:problem:{kind}", asked
        assert statement in refused["detail"]
    assert not list(held.glob("*.begun")), "nothing was simulated"


def test_numbers_that_json_does_not_have_are_refused(service: Service, client: httpx.Client, held: Path) -> None:
    run = submit(client)
    for number in ("NaN", "Infinity", "1e999"):
        body = f'{{"parameters": {{"vehicle.m": {number}}}}}'
        answer = client.post(address(run), content=body, headers={"Content-Type": "application/json"})
        assert answer.status_code in (400, 422), number
        problem(answer, answer.status_code)


def test_every_wrong_parameter_is_named(service: Service, client: httpx.Client, held: Path) -> None:
    run = submit(client)
    asked = {"parameters": {"vehicle.m": -5.0, "vehicle.J": 1e9, "start.x": 1.0}}
    refused = problem(client.post(address(run), json=asked), 422)
    assert [error["field"] for error in refused["errors"]] == ["parameters.vehicle.m", "parameters.vehicle.J"]


def test_values_that_do_not_go_together_are_refused(simulating: Service) -> None:
    document = CATALOGUE.model_dump(mode="json")
    order = {"low": ["K_p1"], "high": ["K_p2"], "text": "lower the one or raise the other"}
    next(c for c in document["components"] if c["role"] == "controller")["orders"] = [order]
    simulating.publish(document)
    asked = {"parameters": {"controller.K_p1": 2.0, "controller.K_p2": 1.0}}
    with simulating.signed_in() as client:
        refused = problem(client.post(address(submit(client)), json=asked), 422)
    assert refused["type"] == "urn:clearance:problem:outside-limits"
    assert order["text"] in refused["detail"]


def test_who_may_not_ask_and_what_is_not_there(service: Service, client: httpx.Client, held: Path) -> None:
    problem(client.post(address("R-0099"), json={}), 404)
    problem(client.post(address("mine"), json={}), 404)
    run = submit(client)
    with service.visitor() as stranger:
        problem(stranger.post(address(run), json={}), 401)
    refused = problem(client.post(address(run), json={"parameters": {"vehicle.m": 6.0}}), 422)
    assert refused["type"].endswith(":not-flyable")
    assert "there is no trim" in refused["detail"]
    service.app.state.live.close()
    refused = problem(client.post(address(run), json={}), 503)
    assert refused["type"].endswith(":flight-failed")


def test_of_a_purged_run_nothing_is_simulated(service: Service, client: httpx.Client, held: Path) -> None:
    run = submit(client)
    client.post(f"/api/v1/runs/{run}/cancel")
    removed = client.delete(f"/api/v1/runs/{run}", params={"reason": "Of another vehicle."})
    assert removed.is_success, removed.text
    assert flown(client, run)["cost"] == 1.0, "what is removed can still be looked at"
    view = f"/api/v1/runs/{run}/views/{KEY}"
    problem(client.get(view), 404)
    assert purge(service.engine, 1, 0.0, "root")
    problem(client.post(address(run), json={}), 410)
    problem(client.get(view), 410)
    problem(client.patch(view, json={}), 410)


def test_a_run_whose_components_are_not_installed_reports_it(simulating: Service) -> None:
    document = CATALOGUE.model_dump(mode="json")
    odd = component("vehicle", "hovercraft", [], starts=[])
    document["components"] = [*document["components"], odd]
    document["components"] = [
        {**one, "fits": ["hovercraft"]} if one["name"] == "pid_speed" else one for one in document["components"]
    ]
    simulating.publish(document)
    asked = campaign(uncertain={"controller.N": {"low": -1, "high": 2}})
    asked["scenario"]["vehicle"] = {"component": "hovercraft"}
    with simulating.signed_in() as client:
        answer = client.post("/api/v1/runs", json={"campaign": asked})
        assert answer.status_code == 201, answer.text
        refused = problem(client.post(address(answer.json()["id"]), json={}, timeout=120), 422)
    assert refused["type"].endswith(":not-flyable")
    assert "hovercraft" in refused["detail"]
    assert load_document(asked).scenario.vehicle.component == "hovercraft"


class Asking(threading.Thread):
    """A pending request, and its response."""

    def __init__(self, visitor: httpx.Client, run: str, mass: float, **more: Any) -> None:
        super().__init__()
        self._do = lambda: visitor.post(address(run), json={"parameters": {"vehicle.m": mass}, **more}, timeout=60)
        self.response: httpx.Response | None = None
        self.start()

    def run(self) -> None:
        self.response = self._do()

    def answer(self) -> httpx.Response:
        self.join(60)
        assert self.response is not None
        return self.response


def test_of_one_client_the_newest_request_counts(service: Service, client: httpx.Client, held: Path) -> None:
    run = submit(client)
    (held / "5.5.held").touch()
    older = Asking(client, run, 5.5)
    until((held / "5.5.begun").exists)
    other = Asking(client, run, 5.25, client=OTHER)
    newer = Asking(client, run, 5.75)
    refused = problem(older.answer(), 409)
    assert refused["type"] == "urn:clearance:problem:flight-overtaken"
    assert "newer" in refused["detail"]
    (held / "5.5.held").unlink()
    assert newer.answer().json()["parameters"] == {"vehicle.m": 5.75}
    assert other.answer().json()["parameters"] == {"vehicle.m": 5.25}, "another client's is its own"
    until(lambda: service.app.state.capacities.flights.inside == 0)
    assert service.app.state.turns._newest == {}
    assert flown(client, run, parameters={"vehicle.m": 5.5})["cost"] == 1.0, "one after the other both are answered"
    assert flown(client, run, parameters={"vehicle.m": 5.75})["cost"] == 1.0


def test_concurrent_simulations_are_limited(service: Service, client: httpx.Client, held: Path) -> None:
    run = submit(client)
    capacity = service.app.state.capacities.flights
    capacity.waiting = 1
    (held / "5.5.held").touch()
    most = (capacity.at_once + 1) // 2  # of one user
    asking = [Asking(client, run, 5.5, client=OTHER[:-2] + f"{i:02x}") for i in range(most)]
    until(lambda: capacity.inside == most)
    refused = client.post(address(run), json={})
    problem(refused, 503)
    assert refused.headers["Retry-After"] == str(capacity.retry)
    overtaking = Asking(client, run, 5.75, client=OTHER[:-2] + "00")
    problem(asking[0].answer(), 409)
    assert problem(overtaking.answer(), 503)["type"].endswith(":busy"), "what is being simulated keeps its place"
    (held / "5.5.held").unlink()
    assert {one.answer().status_code for one in asking[1:]} == {200}
    until(lambda: capacity.inside == 0)


def test_the_flight_is_drawn_in_the_view_that_is_named(simulating: Service) -> None:
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "unicycle_static")
        work = Work(simulating)
        work.nominal()
        assert flown(client, run, view=KEY)["drawn"] is None, "no such view is open, and the numbers are there"
        with viewing(simulating, client, f"/view/{run}/key/{KEY}") as connection:
            steer(client, run)
            answer = flown(client, run, parameters={"vehicle.J": 0.06}, view=KEY)
            assert answer["drawn"] == KEY
            frames_until(connection, b"/flights/what-if/path", f"What-if {answer['cost']:.4f} m".encode())
            shown = steer(client, run)
            assert (shown["what_if"], shown["what_if_seed"]) == (answer["parameters"], None)
            assert flown(client, run, view=OTHER)["drawn"] is None
            with simulating.visitor(Authorization=f"Bearer {simulating.token('ci')}") as stranger:
                assert flown(stranger, run, view=KEY)["drawn"] is None, "of another visitor"
            assert steer(client, run)["what_if"] == answer["parameters"]


def test_every_status_is_documented() -> None:
    described = DOCUMENT["paths"]["/api/v1/runs/{run}/flights"]["post"]["responses"]
    assert {"200", "400", "401", "403", "404", "409", "410", "413", "414", "422", "429", "500", "503"} <= set(described)
    kinds = {
        kind.rsplit(":", 1)[1] for status in ("409", "422", "503") for kind in described[status]["x-problem-types"]
    }
    assert {"flight-overtaken", "unknown-parameter", "outside-limits", "unknown-finding"} <= kinds
    assert {"not-flyable", "flight-failed", "busy", "invalid-request"} <= kinds
