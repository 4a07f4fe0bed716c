"""The coverage of a run by its stored evaluations: all stages, evaluations without a value, many evaluations."""

from __future__ import annotations

import html
import re

import httpx
import numpy as np
import pytest
from pydantic import TypeAdapter
from scipy.spatial import KDTree

from backend.reports import words
from campaigns.claims.coverage import NO_PROOF
from campaigns.claims.spans import Spans
from campaigns.stored.records import Columns
from tests.given.finished_runs import Work, finish, search
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit


@pytest.fixture(scope="module")
def run(still: Service, guest: httpx.Client) -> str:
    """A finished run, which the tests only read."""
    run = submit(guest)
    finish(still)
    return run


def test_all_evaluations_are_counted_and_those_without_a_value_named(guest: httpx.Client, run: str) -> None:
    found = guest.get(f"/api/v1/runs/{run}/coverage").json()
    assert (found["total"], found["used"], found["without_value"]) == (1000, 1000, 100)


def test_the_ball_is_empty_and_about_as_large_as_one_can_be(guest: httpx.Client, run: str) -> None:
    ball = guest.get(f"/api/v1/runs/{run}/coverage").json()["ball"]
    low, width = np.array([4.0, 0.04]), np.array([2.0, 0.02])
    centre = (np.array([ball["centre"]["vehicle.m"], ball["centre"]["vehicle.J"]]) - low) / width
    points = search(0, 1000).points
    assert ball["radius"] <= np.linalg.norm(points - centre, axis=1).min()
    axis = np.linspace(0.0, 1.0, 201)
    every = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    most = np.max(KDTree(points).query(every)[0])
    assert ball["radius"] >= 0.98 * most
    assert ball["diagonal"] == pytest.approx(np.sqrt(2.0))


def test_touched_bins_are_those_of_the_stored_points(guest: httpx.Client, run: str) -> None:
    found = guest.get(f"/api/v1/runs/{run}/coverage").json()
    points = search(0, 1000).points
    bins = {(int(a * 10), int(b * 10)) for a, b in points}
    assert found["bins"] == 100
    assert found["pairs"] == [{"first": "vehicle.m", "second": "vehicle.J", "touched": len(bins)}]


def test_the_slope_is_one_between_evaluations_with_a_value(guest: httpx.Client, run: str) -> None:
    possible = guest.get(f"/api/v1/runs/{run}/coverage").json()["possible"]
    flown = search(0, 1000)
    valued = flown.status == 0
    points, costs = flown.points[valued], flown.costs[valued, 0]
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    slopes = np.abs(costs[:, None] - costs[None])[distance >= 0.01] / distance[distance >= 0.01]
    assert np.abs(slopes - possible["slope"]).min() < 1e-9 * possible["slope"]
    assert possible["slope"] > np.median(slopes)


def test_more_evaluations_than_are_used_are_an_even_choice(service: Service, client: httpx.Client) -> None:
    run, work = submit(client), Work(service)
    points = np.random.default_rng(6).random((25_000, 2))
    for position, rows in ((1, slice(0, 5_000)), (2, slice(5_000, 25_000))):
        work.store.begin(position)
        of, count = points[rows], rows.stop - rows.start
        work.store.append(position, 0, Columns(of, 1.0 + of[:, :1], np.zeros(count, np.uint8), of[:, 0], {}))
    found = client.get(f"/api/v1/runs/{run}/coverage").json()
    assert (found["total"], found["used"]) == (25_000, 20_000)
    assert found["statements"][0][0] == found["statements"][0][0] | {"kind": "quantity", "value": 20_000}
    assert found["possible"]["slope"] == pytest.approx(1.0, rel=1e-3)


def test_report_and_export_state_the_same(guest: httpx.Client, run: str) -> None:
    found = guest.get(f"/api/v1/runs/{run}/coverage").json()
    assert guest.get(f"/api/v1/runs/{run}/exports/run.json").json()["coverage"] == found
    text = html.unescape(re.sub(r"<[^>]+>", "", guest.get(f"/api/v1/runs/{run}/report.html").text))
    for spans in TypeAdapter(list[Spans]).validate_python(found["statements"]):
        assert html.unescape(re.sub(r"<[^>]+>", "", words.drawn(spans))) in text
    assert found["statements"][-1] == [span.model_dump(mode="json") for span in NO_PROOF]


def test_a_run_without_evaluations_has_no_figures(client: httpx.Client) -> None:
    found = client.get(f"/api/v1/runs/{submit(client)}/coverage").json()
    assert (found["total"], found["ball"], found["possible"]) == (0, None, None)


def test_of_a_run_that_does_not_exist_there_is_none(guest: httpx.Client) -> None:
    problem(guest.get("/api/v1/runs/R-9999/coverage"), 404)
