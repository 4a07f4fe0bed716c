"""The bound of a counted sample while it is drawn: with what normal distributions have beyond the bounds."""

from __future__ import annotations

import math
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import CatalogueDocument, Run, Stage
from campaigns.asked.sample_bound import bound
from campaigns.claims.spans import words
from campaigns.claims.stages import sample as claims
from campaigns.runs import StageState
from campaigns.stored.records import StagePlan
from tests.given.finished_runs import PLAN, Work
from tests.given.service import Service
from tests.given.submissions import submit

SAMPLES, DRAWN, VIOLATIONS = 200_000, 50_000, 2
UNCERTAIN = {
    "vehicle.m": {"low": 4.0, "high": 6.0, "distribution": {"kind": "normal", "mean": 5.0, "deviation": 0.25}},
    "vehicle.J": {"low": 0.04, "high": 0.06},
}
TAILS = math.erfc(4.0 / math.sqrt(2.0))


def sentence(outside: float | None, whole: int = SAMPLES, excluded: int = 0, failed: int = 0) -> str:
    now, end = (bound(VIOLATIONS, size, 0.95) + (outside or 0.0) for size in (DRAWN, whole))
    drawn = claims.Drawn(VIOLATIONS, DRAWN, 0.95, outside, excluded, failed=failed)
    return words(claims.so_far(drawn, now, whole - DRAWN, end))


def drawing(service: Service, client: httpx.Client, excluded: int = 0, failed: int = 0, **campaign: Any) -> Any:
    """What a run shows of a sample that is being drawn."""
    return running(service, client, excluded, failed, **campaign)["stages"][-1]["so_far"]


def running(service: Service, client: httpx.Client, excluded: int = 0, failed: int = 0, **campaign: Any) -> Any:
    """A run that draws its sample."""
    stages = {
        "sensitivity": None,
        "search": [{"method": "direct", "evaluations": 100}],
        "certify": {"samples": SAMPLES, "keep": "lowest"},
    }
    run = submit(client, stages=stages, **campaign)
    Work(service, [*PLAN, StagePlan("certify", None, SAMPLES)]).store.begin(len(PLAN))
    values = {"state": StageState.RUNNING, "counted": DRAWN + excluded, "violations": VIOLATIONS}
    values |= {"excluded": excluded, "failed": failed}
    with service.engine.begin() as connection:
        connection.execute(sa.update(Stage).where(Stage.kind == "certify").values(values))
    shown = client.get(f"/api/v1/runs/{run}").json()
    shown["stages"].sort(key=lambda stage: stage["kind"] == "certify")
    return shown


def test_the_bound_counts_what_is_beyond_the_bounds(service: Service, client: httpx.Client) -> None:
    found = drawing(service, client, uncertain=UNCERTAIN)
    assert found["upper_bound"] == pytest.approx(bound(VIOLATIONS, DRAWN, 0.95) + TAILS, rel=1e-9)
    assert found["at_end"] == pytest.approx(bound(VIOLATIONS, SAMPLES, 0.95) + TAILS, rel=1e-9)
    assert found["text"] == sentence(TAILS)
    assert not found["within_bounds"]


def test_without_tails_nothing_is_added(service: Service, client: httpx.Client) -> None:
    found = drawing(service, client)
    assert found["upper_bound"] == bound(VIOLATIONS, DRAWN, 0.95)
    assert found["text"] == sentence(0.0)


@pytest.mark.parametrize(("excluded", "whole"), [(DRAWN // 2, SAMPLES), (3 * DRAWN, SAMPLES // 2)])
def test_no_more_is_promised_than_the_draws_can_give(
    service: Service, client: httpx.Client, excluded: int, whole: int
) -> None:
    """A sample ends at twice its draws, whatever is excluded of them."""
    found = drawing(service, client, excluded)
    assert found["samples"] == DRAWN
    assert found["at_end"] == bound(VIOLATIONS, whole, 0.95)
    assert found["text"] == sentence(0.0, whole, excluded)


def test_where_the_bounds_are_not_known_the_sentence_says_so(service: Service, client: httpx.Client) -> None:
    shares = {**UNCERTAIN, "vehicle.m": {"plus_minus": "20%", "distribution": UNCERTAIN["vehicle.m"]["distribution"]}}
    whole = drawing(service, client, uncertain=shares)
    assert whole["text"] == sentence(TAILS)
    with service.engine.begin() as connection:
        connection.execute(sa.update(Run).values(snapshot=None))
        connection.execute(sa.delete(CatalogueDocument))
    (stage,) = (s for s in client.get("/api/v1/runs/R-0001").json()["stages"] if s["kind"] == "certify")
    assert stage["so_far"]["upper_bound"] == bound(VIOLATIONS, DRAWN, 0.95)
    assert stage["so_far"]["text"] == sentence(None)
    assert stage["so_far"]["within_bounds"], "as the sentence has it, the strip of the page has it"


@pytest.mark.parametrize("seed", [{"sample_seed_stated": True}, {"sample_seed": None, "sample_seed_stated": False}])
def test_a_seed_that_somebody_stated_is_named(service: Service, client: httpx.Client, seed: dict[str, Any]) -> None:
    """A run without a seed of its own is of an earlier version, and has that of the campaign."""
    assert claims.STATED_SEED not in drawing(service, client)["text"]
    with service.engine.begin() as connection:
        connection.execute(sa.update(Run).values(seed))
    (stage,) = (s for s in client.get("/api/v1/runs/R-0001").json()["stages"] if s["kind"] == "certify")
    assert claims.STATED_SEED in stage["so_far"]["text"]


def test_what_failed_is_no_violation_of_the_criterion(service: Service, client: httpx.Client) -> None:
    found = drawing(service, client, failed=1)
    assert (found["violations"], found["failed"]) == (VIOLATIONS, 1)
    assert found["text"] == sentence(0.0, failed=1)
    assert found["text"] != sentence(0.0)


@pytest.mark.parametrize("excluded", [0, DRAWN, 2 * DRAWN])
def test_the_time_left_counts_the_draws_in_place_of_excluded_ones(
    service: Service, client: httpx.Client, excluded: int
) -> None:
    """Of as many excluded ones among the others as so far, but no more draws than a sample makes."""
    run = running(service, client, excluded)
    (stage,) = (stage for stage in run["stages"] if stage["kind"] == "certify")
    assert stage["left"] == {0: 150_000, DRAWN: 300_000, 2 * DRAWN: 2 * SAMPLES - 3 * DRAWN}[excluded]
