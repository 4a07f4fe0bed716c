"""Evaluations with several criteria: stored bit-identical, judged by the first one, exported in their own sign."""

from __future__ import annotations

import csv
import io
import re
from types import SimpleNamespace
from typing import Any

import httpx
import numpy as np
import pytest

from backend.catalog.criteria import criteria
from backend.db.rows import as_columns, chunk_rows, lowest
from backend.exports.sheet import Sheet, headings
from backend.results.improvements import Improvements
from campaigns.stored.records import Columns
from tests.given.case_campaigns import campaign
from tests.given.finished_runs import search
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign as small
from worker.running.catalogue.installed import catalogue

COLUMNS = Columns(
    np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]]),
    np.array([[0.9, -3.0, -0.1 - 0.2], [0.8, 0.0, -9.0], [np.nan, np.nan, np.nan]]),
    np.array([0, 0, 1], dtype=np.uint8),
    np.array([0.1, 0.2, 0.3]),
    {2: "it failed"},
)


def row() -> Any:
    """The columns as a row of the table of chunks."""
    return SimpleNamespace(**chunk_rows(1, 0, 0, COLUMNS)[0])


def test_every_column_is_stored_and_found_again() -> None:
    found = as_columns(row())
    assert found.costs.shape == (3, 3)
    assert found.costs.tobytes() == COLUMNS.costs.tobytes()
    assert found.points.tobytes() == COLUMNS.points.tobytes()


def test_the_best_is_that_of_the_criterion_that_decides() -> None:
    assert lowest(COLUMNS) == (0.8, 1)
    improvements = Improvements()
    improvements.add(row())
    assert (improvements.index, improvements.cost) == ([0, 1], [0.9, 0.8])


def test_an_export_has_all_of_them_in_their_own_sign() -> None:
    document = campaign().document()
    document["objectives"] = [{"component": "goal_miss"}, {"component": "peak_command"}]
    told = criteria(document, catalogue())
    turned = [c.worse == "high" for c in told]
    assert turned == [False, True, True]
    sheet = Sheet(1, [], headings(told), turned, [("vehicle.m", "kg")], {"vehicle.m": (5.0, 4.0, 6.0)})
    assert sheet.columns[4:7] == ["d_min [m]", "d_goal [m]", "u_peak"]
    block = sheet._block(0, row())
    rows = np.column_stack([*block.costs, *block.values]).tolist()
    assert str(rows) == str([[0.9, 3.0, 0.1 + 0.2, 4.0], [0.8, 0.0, 9.0, 5.0], [np.nan, np.nan, np.nan, 6.0]])


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """A finished run of two criteria."""
    asked = {"campaign": small(objectives=[{"component": "goal_miss"}])}
    submitted = client.post("/api/v1/runs", json=asked)
    assert submitted.status_code == 201, submitted.text
    finish_fully(service, criteria=2)
    return str(submitted.json()["id"])


def test_a_run_names_its_criteria(client: httpx.Client, run: str) -> None:
    told = client.get(f"/api/v1/runs/{run}").json()["criteria"]
    assert [(c["name"], c["quantity"], c["unit"], c["worse"]) for c in told] == [
        ("separation", "d_min", "m", "low"),
        ("goal_miss", "d_goal", "m", "high"),
    ]
    document = type(campaign()).model_validate(small(objectives=[{"component": "goal_miss"}] * 2)).document()
    again = criteria(document, None)
    assert [(c.name, c.unit) for c in again] == [("separation", ""), ("goal_miss", ""), ("goal_miss#2", "")]


def test_evaluations_have_every_criterion_in_its_own_sign(client: httpx.Client, run: str) -> None:
    answer = client.get(f"/api/v1/runs/{run}/evaluations", params={"max_points": 300}).json()
    assert [c["name"] for c in answer["criteria"]] == ["separation", "goal_miss"]
    (stage,) = answer["stages"]
    flown = search(0, 1000, 2).costs[stage["index"]]
    assert list(stage["further"]) == ["goal_miss"]
    expected = [None if np.isnan(cost) else 0.0 - cost for cost in flown[:, 1].tolist()]
    assert stage["further"]["goal_miss"] == expected
    assert stage["cost"] == [None if np.isnan(cost) else cost for cost in flown[:, 0].tolist()]


def test_findings_and_flights_have_every_criterion(client: httpx.Client, run: str) -> None:
    found = client.get(f"/api/v1/runs/{run}/findings").json()
    flights = {flight["name"]: flight["meta"] for flight in client.get(f"/api/v1/runs/{run}/traces").json()}
    assert [finding["values"] for finding in found] == [flights[label]["values"] for label in ("F1", "F2")]
    assert found[0]["values"]["goal_miss"] == 1.5 - 0.8


def test_files_and_report_have_every_criterion(client: httpx.Client, run: str) -> None:
    text = client.get(f"/api/v1/runs/{run}/exports/findings.csv").text
    head, *rows = csv.reader(io.StringIO(text, newline=""))
    assert head[:4] == ["flight", "d_min [m]", "d_goal [m]", "margin"]
    assert [row[0] for row in rows] == ["nominal", "F1", "F2"]
    assert float(rows[1][2]) == 1.5 - 0.8
    assert dict(zip(head, rows[1], strict=True))["vehicle.m"] == "6.0"
    assert {row[-1] for row in rows} == {"margin [m]; vehicle.m [kg]; vehicle.J [kg m2]"}
    assert head[-1] == "units"
    told = client.get(f"/api/v1/runs/{run}/exports/run.json").json()
    assert told["columns"][4:6] == ["d_min [m]", "d_goal [m]"]
    assert told["findings"][0]["values"]["goal_miss"] == 1.5 - 0.8
    report = re.sub(r"<[^>]+>", " ", client.get(f"/api/v1/runs/{run}/report.html").text)
    assert "more is worse" in report
    assert "Vermillion: the others at the worst case" in report


def test_one_criterion_costs_nothing_more(service: Service, client: httpx.Client) -> None:
    submitted = client.post("/api/v1/runs", json={"campaign": small()}).json()["id"]
    finish_fully(service)
    (stage,) = client.get(f"/api/v1/runs/{submitted}/evaluations").json()["stages"]
    assert stage["further"] == {}
    assert "more is worse" not in client.get(f"/api/v1/runs/{submitted}/report.html").text
