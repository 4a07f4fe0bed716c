"""Noise realisations drawn with the evaluations of a sample: independent, determined by their index."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from campaigns.asked.spec import MAX_SEED
from campaigns.claims.stages.sample import DRAWN
from campaigns.results import Verdict
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.results.draws import of_draws
from campaigns.stages.certify import CertifyResult
from clearance.testing.problems import Problem
from tests.audited import audited
from tests.given.case_campaigns import searching
from tests.given.sampled_stages import DRAWN as AS_DRAWN
from worker.engine.stages.parts import offered, seeds
from worker.engine.stages.parts.context import Context
from worker.engine.systems.closed_loop.realisations import Realisations
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

NOISE: list[dict[str, Any]] = [{"component": "sensor_noise", "parameters": {"sigma": 0.15}}]


def noisy(**changes: Any) -> Any:
    return searching(
        {"method": "direct", "evaluations": 60}, {"method": "sqp", "evaluations": 40, "starts": [{}]},
        scenario__faults=NOISE, scenario__guidance={"period": 0.1}, scenario__realisations={"seeds": [1]},
        scenario__horizon=8.0, criterion__threshold=0.888,
    )  # fmt: skip


def test_draws_are_numbers_of_their_index() -> None:
    drawn = of_draws(7, 0, 1000)
    assert np.array_equal(drawn[250:400], of_draws(7, 250, 150))
    assert (drawn >= 0).all()
    assert (drawn < MAX_SEED).all()
    assert not np.array_equal(drawn, of_draws(8, 0, 1000))


def test_draws_are_spread_evenly_and_do_not_follow_each_other() -> None:
    drawn = of_draws(1, 0, 100_000) / MAX_SEED
    counts, _ = np.histogram(drawn, bins=20, range=(0.0, 1.0))
    assert np.abs(counts - 5000).max() < 5 * np.sqrt(5000)
    assert abs(np.corrcoef(drawn[1:], drawn[:-1])[0, 1]) < 0.02
    other = of_draws(2, 0, 100_000) / MAX_SEED
    assert abs(np.corrcoef(drawn, other)[0, 1]) < 0.02


@cache
def ran() -> tuple[MemoryStore, Verdict, Problem]:
    fixed = noisy()
    document = fixed.document()
    document["stages"]["certify"] = {"samples": 120}
    campaign = type(fixed).model_validate(document)
    store = MemoryStore(sample_seed=AS_DRAWN)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(offered, "SPOT_CHECKS", 5)
        patch.setattr(offered, "AT_MOST", 5)
        conclusion = execute(campaign, store, threads=1)
        audited(store, campaign)
        return store, conclusion, Problem(campaign)


def certified() -> tuple[int, CertifyResult]:
    store = ran()[0]
    (position,) = (i for i, r in enumerate(store.stages) if r.plan.kind == "certify")
    result = store.stages[position].result
    assert isinstance(result, CertifyResult)
    return position, result


def test_the_sample_draws_a_realisation_with_every_flight() -> None:
    store, _, problem = ran()
    position, result = certified()
    columns = store.evaluations(position)
    assert columns is not None
    assert result.drawn_realisations == len(columns.status) == 120
    assert result.sample.noise == "drawn"
    assert DRAWN.drawn in result.sample.text
    own = of_draws(problem.campaign.seed, 0, 120)
    again = problem.evaluate(columns.points, own)[0]
    assert np.array_equal(again.costs, columns.costs, equal_nan=True)
    stated = problem.evaluate(columns.points)[0]
    assert not np.array_equal(stated.costs, columns.costs)
    one = problem.under(int(own[3])).evaluate(columns.points[3:4])[0]
    assert one.costs[0, 0] == columns.costs[3, 0]


def test_what_one_mild_realisation_hides_the_sample_shows() -> None:
    store, conclusion, _ = ran()
    _, result = certified()
    assert result.sample.violations > 20
    assert conclusion.verdict == "violated"
    assert f" seed {store.findings[0].realisation}" in conclusion.reason


def test_a_finding_under_its_own_noise_has_its_seed_and_its_flight() -> None:
    store, _, _problem = ran()
    own = [f for f in store.findings if f.realisation is not None]
    assert own
    for finding in own:
        trace = store.traces[finding.label]
        assert trace.meta.cost == finding.cost
        assert trace.meta.realisation is not None
        assert finding.validation is not None
        assert trace.meta.realisation.seed == finding.validation.realisation
        assert finding.validation.cost == finding.cost


def test_evaluations_under_their_own_noise_are_apart_from_those_under_the_stated() -> None:
    store, _, problem = ran()
    position, result = certified()
    context = Context(problem.campaign, problem, problem.evaluate, store)
    context.results[position] = result
    stages = range(len(store.stages))
    assert position not in [at for at, _ in seeds.stated(context, stages)]
    ((at, columns, own),) = seeds.drawn(context, stages)
    assert (at, len(columns.status), len(own)) == (position, 120, 120)


def test_the_realisation_that_counts_is_the_first_failed_one_or_the_lowest() -> None:
    realisations = Realisations((7, 8, 9), "worst", True, (0,))
    random = np.random.default_rng(4)
    status = random.choice(np.array([OK, FAILED, EXCLUDED], dtype=np.uint8), (3, 200), p=[0.7, 0.2, 0.1])
    costs = random.integers(0, 3, (3, 200)).astype(float)  # with ties: the first of them
    costs[status != OK] = np.nan
    found = realisations.counting(costs.reshape(-1, 1), status.reshape(-1))
    for column, seed in enumerate(found):
        failed = [k for k in range(3) if status[k, column] == FAILED]
        ok = [k for k in range(3) if status[k, column] == OK]
        row = failed[0] if failed else min(ok, key=lambda k: costs[k, column]) if ok else 0
        assert seed == realisations.seeds[row]
        assert realisations.worst(costs[:, column : column + 1], status[:, column]) == row
    assert Realisations((5,), "worst", False, ()).counting(costs[0, :, None], status[0]) == [5] * 200
