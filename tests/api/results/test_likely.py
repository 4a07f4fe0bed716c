"""How likely findings are under the stated distributions, and the most likely violation: on every door of a service."""

from __future__ import annotations

import csv
import io
import re

import httpx
import numpy as np
import pytest
import sqlalchemy as sa

from backend.db.rows import MOST_ROWS
from backend.exports.formats.findings_csv import LIKELY
from campaigns.claims import likelihood as claims
from campaigns.claims.spans import words
from tests import results
from tests.given.finished_runs import Work, finish, search
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit

NORMAL = {"kind": "normal", "mean": 5.0, "deviation": 0.25}
UNCERTAIN = {
    "vehicle.m": {"low": 4.0, "high": 6.0, "distribution": NORMAL},
    "vehicle.J": {"low": 0.04, "high": 0.06},
}


@pytest.fixture
def normal(service: Service, client: httpx.Client) -> str:
    """A finished run, many of whose evaluations violate; its mass is normally distributed."""
    run = submit(client, uncertain=UNCERTAIN, criterion={"threshold": 1.01})
    finish(service)
    return run


def test_a_finding_has_its_likelihood_on_every_door(client: httpx.Client, normal: str) -> None:
    (found,) = client.get(f"/api/v1/runs/{normal}/findings").json()
    likely = found["likelihood"]
    assert (likely["distance"], likely["parameters"]) == (pytest.approx(4.0), 1)
    assert likely["density"] == pytest.approx(np.exp(-8.0))
    text = client.get(f"/api/v1/runs/{normal}/exports/findings.csv").text
    (nominal, row) = csv.DictReader(io.StringIO(text, newline=""))
    assert [float(row[name]) for name in LIKELY] == [likely[name] for name in ("distance", "density", "tail")]
    assert nominal[LIKELY[0]] == ""
    written = client.get(f"/api/v1/runs/{normal}/exports/run.json").json()
    assert written["findings"][0]["likelihood"] == likely
    most = client.get(f"/api/v1/runs/{normal}/most-likely-violation").json()
    assert written["most_likely_violation"] == most
    report = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", "", client.get(f"/api/v1/runs/{normal}/report.html").text))
    assert "F1: 4 standard deviations" in report.replace("\u202f", " ")
    assert "not validated; " in report


def test_the_most_likely_violation_is_that_of_all_evaluations(client: httpx.Client, normal: str) -> None:
    answer = client.get(f"/api/v1/runs/{normal}/most-likely-violation").json()
    flown = search(0, 1000)
    violating = np.flatnonzero(flown.costs[:, 0] <= 1.01)
    nearest = violating[np.argmin(np.abs(flown.points[violating, 0] - 0.5))]
    assert answer["violations"] == len(violating) > 10
    case = answer["case"]
    assert (case["position"], case["index"], case["cost"]) == (2, nearest, flown.costs[nearest, 0])
    assert case["parameters"]["vehicle.m"] == 4.0 + 2.0 * flown.points[nearest, 0]
    assert case["likelihood"]["distance"] == pytest.approx(abs(flown.points[nearest, 0] - 0.5) * 2.0 / 0.25)
    assert f"evaluation 2:{nearest}" in answer["text"]


def test_it_is_found_in_any_of_many_chunks(service: Service, client: httpx.Client) -> None:
    run = submit(client, uncertain=UNCERTAIN, criterion={"threshold": 1.0005})
    work = Work(service)
    work.nominal()
    work.search(0, 5 * MOST_ROWS)
    costs, points = search(0, 5 * MOST_ROWS).costs[:, 0], search(0, 5 * MOST_ROWS).points[:, 0]
    work.store.finish(2, results.searched(), 1.0)
    answer = client.get(f"/api/v1/runs/{run}/most-likely-violation").json()
    violating = np.flatnonzero(costs <= 1.0005)
    assert violating.min() > MOST_ROWS
    assert answer["case"]["index"] == violating[np.argmin(np.abs(points[violating] - 0.5))]


def test_in_a_box_no_violation_is_more_likely(service: Service, client: httpx.Client) -> None:
    run = submit(client, criterion={"threshold": 1.01})
    finish(service)
    (found,) = client.get(f"/api/v1/runs/{run}/findings").json()
    assert (found["likelihood"]["density"], found["likelihood"]["text"]) == (None, words(claims.UNIFORM))
    answer = client.get(f"/api/v1/runs/{run}/most-likely-violation").json()
    assert (answer["case"], answer["text"]) == (None, words(claims.UNIFORM))
    report = client.get(f"/api/v1/runs/{run}/report.html").text
    assert report.count("equally likely") == 1


def test_of_a_box_no_point_is_read(service: Service, client: httpx.Client) -> None:
    run = submit(client, criterion={"threshold": 1.01})
    finish(service)
    asked: list[str] = []
    sa.event.listen(service.engine, "before_cursor_execute", lambda *given: asked.append(given[2]))
    answer = client.get(f"/api/v1/runs/{run}/most-likely-violation").json()
    assert answer["violations"] == np.count_nonzero(search(0, 1000).costs[:, 0] <= 1.01)
    read = [statement for statement in asked if "evaluation_chunks.costs" in statement]
    assert len(read) == 1, "the search, once"
    assert "evaluation_chunks.points" not in read[0]


def test_a_run_that_is_not_there(client: httpx.Client) -> None:
    problem(client.get("/api/v1/runs/R-0999/most-likely-violation"), 404)
