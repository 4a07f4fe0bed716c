"""Re-weighting the stored sample of a run: estimates, what is refused, and who may ask."""

from __future__ import annotations

from typing import Any

import httpx
import numpy as np
import pytest
import sqlalchemy as sa
from scipy import stats

from backend.db.tables import Stage
from backend.likelihood import service
from campaigns.asked.distributions import Normal, Uniform
from campaigns.claims import reweighted as claims
from campaigns.claims.spans import words
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.sample import QuantileBound, Sample
from campaigns.stages.certify import CertifyResult
from campaigns.stored.records import Columns, StagePlan
from tests.given.finished_runs import Work, finish
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.stated_densities import drawn
from tests.given.submissions import submit

COUNT, GRID = 4000, 9
MASS: dict[str, Any] = {"low": 4.0, "high": 6.0, "distribution": {"kind": "normal", "mean": 5.0, "deviation": 0.25}}
UNCERTAIN = {"vehicle.m": MASS, "vehicle.J": {"low": 0.04, "high": 0.06}}
POINTS = drawn(Normal(mean=5.0, deviation=0.25), Uniform(), count=COUNT, seed=2)


def moved(**distribution: Any) -> dict[str, Any]:
    return {"uncertain": {"vehicle.m": MASS | {"distribution": MASS["distribution"] | distribution}}}


@pytest.fixture
def sampled(service: Service, client: httpx.Client) -> str:
    """A run with a sample of 4000, in which masses above 5.7 are excluded and those up to 4.5 violate, and a grid."""
    stages = {
        "search": [{"method": "direct", "evaluations": 1000}],
        "certify": {"samples": COUNT, "grid": {"points": 3}},
    }
    run = submit(client, uncertain=UNCERTAIN, stages=stages, criterion={"threshold": 0.5})
    work = Work(service, [StagePlan("nominal", None, 1), StagePlan("certify", None, COUNT + GRID)])
    work.nominal()
    work.store.begin(1)
    mass = 4.0 + 2.0 * POINTS[:, 0]
    status = np.where(mass > 5.7, EXCLUDED, OK).astype(np.uint8)
    costs = np.append(np.where(status == OK, mass - 4.0, np.nan), np.zeros(GRID))
    points, zeros = np.concatenate([POINTS, np.full((GRID, 2), 0.5)]), np.zeros(GRID, np.uint8)
    work.store.append(1, 0, Columns(points, costs[:, None], np.append(status, zeros), np.arange(len(costs)) * 1e-3, {}))
    excluded = int(np.count_nonzero(status))
    sample = Sample(
        samples=COUNT - excluded, violations=int((mass <= 4.5).sum()), excluded=excluded, confidence=0.95,
        upper_bound=0.05, quantile=QuantileBound(share=0.1),
    )  # fmt: skip
    work.store.finish(1, CertifyResult(sample=sample, grid=None), 1.0)
    return run


def test_the_stated_distributions_give_the_fraction_of_the_sample(client: httpx.Client, sampled: str) -> None:
    found = client.post(f"/api/v1/runs/{sampled}/reweighted", json={}).json()
    kept = POINTS[:, 0] <= 0.85
    violating = int((POINTS[:, 0] <= 0.25).sum())
    assert (found["samples"], found["violations"], found["excluded"]) == (kept.sum(), violating, COUNT - kept.sum())
    assert found["probability"] == pytest.approx(violating / kept.sum())
    assert found["low"] < found["probability"] < found["high"]
    assert found["effective"] == pytest.approx(kept.sum())
    assert [q["share"] for q in found["quantiles"]] == [0.01, 0.05, 0.1, 0.5]


def test_moved_distributions_give_their_own_probability(client: httpx.Client, sampled: str) -> None:
    found = client.post(f"/api/v1/runs/{sampled}/reweighted", json=moved(mean=4.9)).json()
    exact = stats.norm.cdf(-1.6) / stats.norm.cdf(3.2)
    assert found["low"] < exact < found["high"]
    assert found["probability"] == pytest.approx(exact, rel=0.15)
    assert found["effective"] < COUNT
    assert found["outside"] == pytest.approx(stats.norm.cdf(-3.6) + stats.norm.sf(4.4))
    box = {"uncertain": {"vehicle.J": {"low": 0.05, "high": 0.06}}}
    half = client.post(f"/api/v1/runs/{sampled}/reweighted", json=box).json()
    inside = (POINTS[:, 1] >= 0.5) & (POINTS[:, 0] <= 0.85)
    assert half["probability"] == pytest.approx((POINTS[inside, 0] <= 0.25).mean())


def test_an_estimate_that_cannot_be_made_has_a_reason_in_place_of_numbers(client: httpx.Client, sampled: str) -> None:
    for body in (moved(mean=4.3), moved(deviation=0.004), {"uncertain": {"vehicle.J": {"low": 0.03, "high": 0.06}}}):
        found = client.post(f"/api/v1/runs/{sampled}/reweighted", json=body).json()
        assert [found[name] for name in ("probability", "low", "high", "quantiles")] == [None, None, None, []]
        assert found["text"].startswith("no estimate: ")


def test_what_is_no_distribution_is_refused(client: httpx.Client, sampled: str) -> None:
    at = f"/api/v1/runs/{sampled}/reweighted"
    problem(client.post(at, json={"uncertain": {"vehicle.x": {"low": 0, "high": 1}}}), 422)
    (error,) = problem(client.post(at, json=moved(mean=7.0)), 422)["errors"]
    assert error["field"] == "uncertain.vehicle.m.distribution.mean"
    problem(client.post(at, json=moved(deviation=0)), 422)
    problem(client.post(at, json={"uncertain": {"vehicle.m": {"plus_minus": "1e-300%"}}}), 422)
    assert client.post(at, json=moved(deviation=5e-324)).json()["effective"] < 1e-100
    problem(client.post(at, json={"uncertain": {"vehicle.m": {"low": 6, "high": 4}}}), 422)


def test_without_an_independent_sample_there_is_nothing_to_re_weight(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    found = client.post(f"/api/v1/runs/{run}/reweighted", json={}).json()
    assert (found["probability"], found["samples"], found["text"]) == (None, 0, words(claims.NO_SAMPLE))
    problem(client.post("/api/v1/runs/R-0999/reweighted", json={}), 404)


def test_a_sample_that_is_not_stored_whole_is_not_re_weighted(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish_fully(service)
    found = client.post(f"/api/v1/runs/{run}/reweighted", json={}).json()
    assert (found["probability"], found["text"]) == (None, words(claims.NOT_WHOLE))


def test_a_sample_that_ended_early_is_not_re_weighted(service: Service, client: httpx.Client, sampled: str) -> None:
    with service.engine.begin() as connection:
        early = sa.update(Stage).where(Stage.kind == "certify")
        result = connection.scalar(sa.select(Stage.result).where(Stage.kind == "certify"))
        stated = result | {"sample": result["sample"] | {"bound_samples": COUNT - 500}}
        connection.execute(early.values(result=stated))
    found = client.post(f"/api/v1/runs/{sampled}/reweighted", json={}).json()
    assert (found["probability"], found["text"]) == (None, words(claims.ENDED_EARLY))


def test_of_a_large_sample_the_first_draws_count(
    client: httpx.Client, sampled: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(service, "MOST", 1500)
    found = client.post(f"/api/v1/runs/{sampled}/reweighted", json={}).json()
    mass = 4.0 + 2.0 * POINTS[:1500, 0]
    excluded = int(np.count_nonzero(mass > 5.7))
    assert (found["samples"], found["excluded"]) == (1500 - excluded, excluded)
    assert found["violations"] == np.count_nonzero(mass <= 4.5)
    assert found["probability"] == pytest.approx(found["violations"] / found["samples"])
