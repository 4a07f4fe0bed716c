"""Sweeps: one launch of several runs, all or none, once for each key; never a number that was not computed."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.purge import purge
from backend.db.queue import Queue
from backend.db.tables import Audit, Run
from campaigns import Campaign
from campaigns.claims.lowest_value import unconfirmed
from campaigns.claims.spans import words
from campaigns.results.verdict import headline
from clearance.cli import _sweep
from clearance.cli._following import plain
from clearance.client.answers import Sweep
from tests.given.code_versions import OTHER, VERSIONS
from tests.given.databases import BOTH
from tests.given.finished_runs import Work, finish
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.results import Marks

JSON = {"content-type": "application/json"}


NAME = "Range of the avoider"


def asked(**changes: Any) -> dict[str, Any]:
    given = {"campaign": campaign(), "path": "avoider.d_0", "values": [3.0, 1.0, 2.0], "name": NAME}
    return {**given, **changes}


def launch(client: httpx.Client, **changes: Any) -> dict[str, Any]:
    answer = client.post("/api/v1/sweeps", json=asked(**changes))
    assert answer.status_code == 201, answer.text
    assert answer.headers["location"] == f"/api/v1/sweeps/{answer.json()['id']}"
    return dict(answer.json())


def test_one_run_for_each_value(client: httpx.Client) -> None:
    sweep = launch(client, tags=["range"], priority=3)
    assert (sweep["id"], sweep["runs"], sweep["states"]) == ("S-0001", 3, {"queued": 3})
    assert (sweep["path"], sweep["title"], sweep["nominal"]) == ("avoider.d_0", "D_0", 0.0)
    assert [point["value"] for point in sweep["points"]] == [1.0, 2.0, 3.0]
    assert [point["run"] for point in sweep["points"]] == ["R-0002", "R-0003", "R-0001"]
    for point in sweep["points"]:
        run = client.get(f"/api/v1/runs/{point['run']}").json()
        expected = campaign()
        expected["scenario"]["avoider"] = {"component": "potential_field", "parameters": {"d_0": point["value"]}}
        assert run["campaign"] == Campaign.model_validate(expected).document()
        assert run["name"] == f"{NAME}, avoider.d_0 = {point['value']:g}"
        assert run["tags"] == ["range"]
    assert client.get("/api/v1/sweeps/S-0001").json() == sweep
    (listed,) = client.get("/api/v1/sweeps").json()
    assert listed == {key: value for key, value in sweep.items() if key not in ("nominal", "points")}


PLACES: dict[str, tuple[str, tuple[str | int, ...]]] = {
    "vehicle.m": ("kg", ("scenario", "vehicle", "parameters", "m")),
    "start.theta": ("", ("scenario", "start", "theta")),
    "goal.x": ("m", ("scenario", "goal", "x")),
    "obstacles.0.position.x": ("m", ("scenario", "obstacles", 0, "parameters", "position.x")),
    "obstacles.0.radius": ("m", ("scenario", "obstacles", 0, "parameters", "radius")),
}


def test_parameters_of_every_part(client: httpx.Client) -> None:
    document = campaign(uncertain={"vehicle.J": {"low": 0.04, "high": 0.06}})
    for path, (unit, place) in PLACES.items():
        sweep = launch(client, path=path, values=[0.25, 0.3], campaign=document)
        assert sweep["unit"] == unit
        found = client.get(f"/api/v1/runs/{sweep['points'][0]['run']}").json()["campaign"]
        for step in place:
            found = found[step]
        assert found == 0.25


@BOTH
def test_a_repeated_request_launches_nothing(service: Service, client: httpx.Client) -> None:
    headers = {"Idempotency-Key": "k"}
    first = client.post("/api/v1/sweeps", json=asked(), headers=headers)
    again = client.post("/api/v1/sweeps", json=asked(), headers=headers)
    assert first.status_code == again.status_code == 201
    assert first.json() == again.json()
    assert service.rows()["runs"] == 3
    other = problem(client.post("/api/v1/sweeps", json=asked(values=[1, 2]), headers=headers), 422)
    assert "S-0001" in str(other["detail"])
    assert client.post("/api/v1/sweeps", json=asked()).json()["id"] == "S-0002"


@pytest.mark.parametrize(
    ("changes", "field", "statement"),
    [
        ({"path": "vehicle.m"}, "path", "is uncertain"),
        ({"path": "avoider.d_1"}, "path", "did you mean 'avoider.d_0'?"),
        ({"path": "d_0"}, "path", ""),
        ({"path": "seed.x"}, "path", "no such parameter"),
        ({"values": [1.0]}, "values", "at least 2"),
        ({"values": [1.0, 1]}, "values", "given twice"),
        ({"values": ["1", "much"]}, "values.1", "expected a number"),
        ({"values": [0.0, 2000.0]}, "values.1", "must be within"),
        ({"values": [float(i) for i in range(51)]}, "values", "at most 50"),
        ({"campaign": {"name": "x"}}, "scenario", "required"),
        ({"campaign": campaign(seed=-1)}, "seed", "of at least 0"),
        ({"more": 1}, "more", "not permitted"),
        ({"tags": ["two words"]}, "tags.0", ""),
        ({"name": "\ud800"}, "name", "surrogate"),
    ],
)
def test_of_a_wrong_sweep_no_run_is_stored(
    still: Service, guest: httpx.Client, changes: Any, field: str, statement: str
) -> None:
    body = json.dumps(asked(**changes))  # as ASCII, which can write what is not Unicode text
    answer = problem(guest.post("/api/v1/sweeps", content=body, headers=JSON), 422)
    errors: Any = answer["errors"]
    assert field in [error["field"] for error in errors], errors
    assert statement in str(errors)
    rows = still.rows()
    assert rows["sweeps"] == rows["runs"] == 0


def test_what_is_no_sweep(guest: httpx.Client) -> None:
    problem(guest.post("/api/v1/sweeps", content="path: x", headers={"content-type": "application/yaml"}), 415)
    problem(guest.post("/api/v1/sweeps", content="[", headers=JSON), 422)
    problem(guest.post("/api/v1/sweeps", content="[1]", headers=JSON), 422)
    for address in ("S-0001", "R-0001", "S-99999999999999999999"):
        problem(guest.get(f"/api/v1/sweeps/{address}"), 404)
        problem(guest.get(f"/api/v1/sweeps/{address}/table.csv"), 404)
        problem(guest.post(f"/api/v1/sweeps/{address}/cancel"), 404)


def test_numbers_only_of_runs_that_are_done(service: Service, client: httpx.Client) -> None:
    launch(client, values=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    finish_fully(service, "inconclusive")
    claim = Queue(service.engine).claim("w")
    assert claim is not None
    Queue(service.engine).fail(claim, "the state diverged.")
    work = Work(service)
    work.nominal()
    work.search(0, 700)
    client.post("/api/v1/runs/R-0003/cancel")
    finish(service)
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 4).values(removed=1.0, removed_by="a", removed_reason="b"))
    assert purge(service.engine, 4, 0.0, "a")
    found = client.get("/api/v1/sweeps/S-0001").json()
    assert found["states"] == {"done": 1, "inconclusive": 1, "failed": 1, "cancelling": 1, "queued": 2, "purged": 1}
    (listed,) = client.get("/api/v1/sweeps").json()
    assert sum(found["states"].values()) == found["runs"] + 1, "the verdict is counted beside its state"
    assert (listed["states"], listed["runs"]) == (found["states"], 6)
    points = [point["outcome"] for point in found["points"]]
    assert points[3] is None
    assert points[0]["verdict"] == "inconclusive"
    assert points[0]["margin"] == pytest.approx(0.8)
    assert points[0]["upper_bound"] == pytest.approx(0.000998, rel=1e-3)
    for i in (1, 2, 4, 5):
        assert (points[i]["margin"], points[i]["worst_cost"], points[i]["upper_bound"]) == (None, None, None)
    assert points[1]["error"] == "the state diverged."
    answer = client.get("/api/v1/sweeps/S-0001/table.csv")
    assert answer.headers["content-type"].startswith("text/csv")
    assert "S-0001.csv" in answer.headers["content-disposition"]
    assert len({len(row) for row in csv.reader(io.StringIO(answer.text))}) == 1
    rows = list(csv.DictReader(io.StringIO(answer.text)))
    assert [row["avoider.d_0"] for row in rows] == ["1.0", "2.0", "3.0", "4.0", "5.0", "6.0"]
    assert [row["state"] for row in rows] == ["done", "failed", "cancelling", "purged", "queued", "queued"]
    assert rows[0]["worst d_min [m]"] == "1.3"
    assert [row["margin [m]"] or "" for row in rows[1:]] == [""] * 5
    assert rows[0]["verdict"] == "inconclusive"
    assert [row["P(violation) bound source"] or "" for row in rows] == ["certify", *[""] * 5]
    with changed(service.engine, sa.update(Run).where(Run.id == 1).values(verdict="cleared", summary={})):
        (row, *_) = csv.DictReader(io.StringIO(client.get("/api/v1/sweeps/S-0001/table.csv").text))
    assert row["verdict"] == headline("cleared", Marks(True, True), None, None)


def test_a_removed_run_is_stated_in_the_table(service: Service, client: httpx.Client) -> None:
    launch(client, values=[1.0, 2.0])
    for _ in range(2):
        finish_fully(service)
    assert client.delete("/api/v1/runs/R-0001", params={"reason": "wrong"}).status_code == 200
    rows = list(csv.DictReader(io.StringIO(client.get("/api/v1/sweeps/S-0001/table.csv").text)))
    assert [(row["run"], row["verdict"], row["removed"]) for row in rows] == [
        ("R-0001", "cleared", "yes"), ("R-0002", "cleared", "no"),
    ]  # fmt: skip
    points = client.get("/api/v1/sweeps/S-0001").json()["points"]
    assert [point["outcome"]["removed"] for point in points] == [True, False]


CODES: dict[str, tuple[dict[str, Any], str]] = {
    "the same": ({}, ""),
    "different": ({"flown": {**VERSIONS.model_dump(mode="json"), "code": OTHER.digest}}, "2 codes ran its runs"),
    "not identified": ({"flown": None}, "The code of one run is not identified"),
}
"""What the last run of a sweep has stored of its code, and what is stated of all."""


@BOTH
def test_runs_of_different_code_are_stated_wherever_a_sweep_is(service: Service, client: httpx.Client) -> None:
    launch(client, values=[1.0, 2.0, 3.0])
    for _ in range(2):
        finish_fully(service)
    other = launch(client, values=[1.0, 2.0])["id"]
    for values, statement in CODES.values():
        with changed(service.engine, sa.update(Run).where(Run.id == 2).values(**(values or {"name": "x"}))):
            found = client.get("/api/v1/sweeps/S-0001").json()
            listed = {one["id"]: one["code_warning"] for one in client.get("/api/v1/sweeps").json()}
        assert statement in found["code_warning"]
        assert bool(found["code_warning"]) == bool(statement)
        assert listed == {"S-0001": found["code_warning"], other: ""}
        lines = _sweep._lines(Sweep.model_validate(found))
        assert lines[3:] == ([found["code_warning"]] if statement else [])


def test_a_sweep_is_cancelled_as_a_whole(service: Service, client: httpx.Client) -> None:
    launch(client)
    other = launch(client, values=[7.0, 8.0])
    finish(service)
    Work(service).nominal()
    answer = client.post("/api/v1/sweeps/S-0001/cancel")
    assert answer.status_code == 200
    assert answer.json()["states"] == {"done": 1, "violated": 1, "cancelling": 1, "cancelled": 1}
    assert client.post("/api/v1/sweeps/S-0001/cancel").json() == answer.json()
    assert client.get(f"/api/v1/sweeps/{other['id']}").json()["states"] == {"queued": 2}
    with service.engine.connect() as reader:
        noted = reader.execute(sa.select(Audit.subject, Audit.detail).where(Audit.action == "run.cancelled")).all()
    assert [(row.subject, row.detail["sweep"]) for row in noted] == [("R-0002", "S-0001"), ("R-0003", "S-0001")]


def test_a_long_name_leaves_the_value(client: httpx.Client) -> None:
    sweep = launch(client, name="x" * 120)
    names = [client.get(f"/api/v1/runs/{point['run']}").json()["name"] for point in sweep["points"]]
    assert [len(name) for name in names] == [120] * 3
    assert [name.rpartition(" = ")[2] for name in names] == ["1", "2", "3"]


@pytest.mark.parametrize(("lowest", "found"), [(0.5, True), (0.51, False)])
def test_what_a_run_without_a_verdict_found_is_stated_in_the_table(
    service: Service, client: httpx.Client, lowest: float, found: bool
) -> None:
    launch(client, values=[1.0, 2.0])
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 1).values(state="failed", error="It ended.", worst_cost=lowest))
    rows = csv.DictReader(io.StringIO(client.get("/api/v1/sweeps/S-0001/table.csv").text))
    sweep = Sweep.model_validate(client.get("/api/v1/sweeps/S-0001").json())
    sentence = words(unconfirmed("failed", lowest, 0.5, "m"))
    assert bool(sentence) == found
    assert [row["unconfirmed"] for row in rows] == [sentence, ""]
    lines = [_sweep._line(sweep, point) for point in sweep.points]
    assert lines[0].endswith(f"; It ended. {plain(sentence)}".rstrip())
    assert "lowest" not in lines[1]
