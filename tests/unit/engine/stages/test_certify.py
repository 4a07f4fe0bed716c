"""The certify stage on a problem with known probabilities: coverage of its bounds; the grid."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns import CampaignError, check
from campaigns.claims.stages import sample as sentences
from campaigns.results.sample import QuantileBound
from campaigns.results.sample import Sample as Statement
from campaigns.sample_seed import SampleSeed
from campaigns.stages.certify import CertifyResult
from campaigns.stages.plan import plan
from campaigns.stored.records import Columns
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign
from tests.given.sampled_stages import PROBABILITY, THRESHOLD, asked, context, costs, evaluate, quantile
from tests.given.stated_facts import Fact, facts
from worker.engine.search.base import Floats
from worker.engine.stages import certify
from worker.engine.stages.parts.base import stream
from worker.engine.stages.parts.claims import bound
from worker.engine.stages.parts.sample import Sample
from worker.running.catalogue.installed import catalogue

REPETITIONS = 400
HELD = 0.93
"""Share of the repetitions in which a bound with 95 % confidence must hold at the least."""


def ran(stage: dict[str, Any], flown: Any = None, seed: int = 1, **changes: Any) -> CertifyResult:
    return certify.run(context(asked({"certify": stage}, seed=seed, **changes), flown), 0).result


def test_what_a_sample_allows_to_claim() -> None:
    found = ran({"samples": 3000})
    drawn = found.sample
    uniform = stream(1, certify.STREAM).random((3000, 2))
    expected = np.sort(costs(uniform))
    assert drawn.samples == found.evaluations == 3000
    assert drawn.violations == int((expected <= THRESHOLD).sum()) > 0
    assert drawn.upper_bound == bound(drawn.violations, 3000, 0.95)
    told = quantile_of(drawn)
    assert (told.share, told.order, told.needed) == (0.05, 131, 59)
    assert told.bound == expected[130]
    assert told.confidence is not None
    assert told.confidence >= 0.95
    assert facts(told.statement) == [0.05, "d_min", float(f"{expected[130]:.6g}"), 0.95]
    assert facts(drawn.statement)[:2] == [drawn.violations, 3000]


STATED: dict[str, tuple[dict[str, Any], Any, list[Fact], str]] = {
    "the samples and the quantile": (
        {"samples": 3000}, None,
        [51, 3000, 0.0215, 0.95, 0.05, "d_min", 0.596025, 0.95],
        "51 of 3\u202f000 samples drawn from the stated distributions violate the criterion: P(violation) is at "
        "most 2.15 % with 95 % confidence; at most 5 % of all cases have d_min below 0.596025 m, with 95 % "
        "confidence",
    ),
    "failed evaluations": (
        {"samples": 1000}, evaluate(failing=lambda x: x[:, 0] > 0.99),
        [29, 1000, 8, 0.0394, 0.95, 0.05, "d_min", 0.544465, 0.95],
        "29 of 1\u202f000 samples drawn from the stated distributions violate the criterion or failed "
        "(8 failed): P(violation) is at most 3.94 % with 95 % confidence; at most 5 % of all cases have "
        "d_min below 0.544464 m, with 95 % confidence",
    ),
    "a quantile among failed evaluations": (
        {"samples": 200}, evaluate(failing=lambda x: x[:, 0] > 0.8),
        [54, 200, 49, 0.327, 0.95, 0.05],
        "54 of 200 samples drawn from the stated distributions violate the criterion or failed "
        "(49 failed): P(violation) is at most 32.7 % with 95 % confidence; no bound on the 5 % quantile: "
        "the 5th lowest of the sample is a failed evaluation",
    ),
    "too few samples": (
        {"samples": 58}, None,
        [2, 58, 0.105, 0.95, 58, 0.05, 59],
        "2 of 58 samples drawn from the stated distributions violate the criterion: P(violation) is at most"
        " 10.5 % with 95 % confidence; 58 samples are too few for a bound on the 5 % quantile, which needs "
        "59",
    ),
    "a precondition that hardly ever holds": (
        {"samples": 100}, evaluate(excluded=lambda x: x[:, 0] < 0.9),
        [0, 24, 0.118, 0.95, 176, 200, 0.88, 24, 0.05, 59, 24, 100],
        "0 of 24 samples drawn from the stated distributions violate the criterion: P(violation) is at most"
        " 11.8 % with 95 % confidence; it holds only for starts above the threshold: 176 of 200 draws "
        "(88 %) start at or below it and were excluded; 24 samples are too few for a bound on the 5 % "
        "quantile, which needs 59; only 24 of 100 samples were not excluded",
    ),
    "a grid without a value": (
        {"samples": 5, "grid": {"points": 3}}, evaluate(failing=lambda x: x[:, 0] >= 0),
        [5, 5, 5, 1, 0.95, 5, 0.05, 59],
        "5 of 5 samples drawn from the stated distributions violate the criterion or failed "
        "(5 failed): P(violation) is at most 100 % with 95 % confidence; 5 samples are too few for a bound on "
        "the 5 % quantile, which needs 59",
    ),
}  # fmt: skip
"""The stage, what it evaluates, the numbers of its sentence, and its words."""


@pytest.mark.parametrize("name", STATED)
def test_the_sentence_of_a_certificate(name: str) -> None:
    stage, flown, expected, words = STATED[name]
    found = ran(stage, flown)
    assert facts(found.statement) == expected
    assert found.text == words


def test_a_bound_names_a_seed_that_was_not_drawn_at_the_launch() -> None:
    """Of a certify stage one that was stated; of a random search that of the campaign."""
    for stage in ({"samples": 100}, {"samples": 100, "keep": "lowest"}):
        of = context(asked({"certify": stage}))
        assert " seed" not in certify.run(of, 0).result.sample.text
        of = context(asked({"certify": stage}))
        of.store.sample_seed = SampleSeed(1)
        found = certify.run(of, 0).result
        for text in (found.text, found.sample.text):
            assert text.count(sentences.STATED_SEED) == 1


def test_the_distribution_function_is_that_of_the_sample() -> None:
    found = ran({"samples": 3000}).sample.distribution
    assert found is not None
    expected = np.sort(costs(stream(1, certify.STREAM).random((3000, 2))))
    assert found.values[:100] == expected[:100].tolist()
    assert (found.values[-1], found.shares[-1]) == (expected[-1], 1.0)
    assert len(found.values) == len(found.shares) < 600
    for value, share in zip(found.values, found.shares, strict=True):
        assert share == (expected <= value).mean()
    true = np.minimum((np.array(found.values) - THRESHOLD + 0.2) ** 2 / 2, 1)
    below = np.array(found.values) < THRESHOLD + 0.8
    assert np.abs(true - found.shares)[below].max() < found.band == pytest.approx(0.0248, abs=1e-4)


def test_the_bounds_have_their_stated_coverage() -> None:
    held = np.zeros(2)
    for seed in range(REPETITIONS):
        found = ran_quickly(seed)
        lowest = quantile_of(found).bound
        assert found.upper_bound is not None
        assert lowest is not None
        held += [found.upper_bound >= PROBABILITY, lowest <= quantile(0.05)]
    assert (held / REPETITIONS >= HELD).all()
    assert (held / REPETITIONS <= 0.995).all()  # bounds that always hold would be of no use


BASE = asked({"certify": {"samples": 400}})


def ran_quickly(seed: int) -> Statement:
    return certify.run(context(BASE, seed=seed), 0).result.sample


def quantile_of(drawn: Statement) -> QuantileBound:
    assert drawn.quantile is not None
    return drawn.quantile


def test_a_failed_flight_is_a_violation_and_the_lowest_value() -> None:
    found = ran({"samples": 1000}, evaluate(failing=lambda x: x[:, 0] > 0.99))
    uniform = stream(1, certify.STREAM).random((1000, 2))
    failed = int((uniform[:, 0] > 0.99).sum())
    flown = np.sort(costs(uniform[uniform[:, 0] <= 0.99]))
    drawn = found.sample
    assert (drawn.samples, drawn.failed) == (1000, failed)
    assert drawn.violations == failed + int((flown <= THRESHOLD).sum())
    told = quantile_of(drawn)
    assert told.order is not None
    assert told.bound == flown[told.order - 1 - failed]
    assert drawn.distribution is not None
    assert drawn.distribution.shares[0] == pytest.approx((failed + 1) / 1000)
    assert facts(drawn.statement)[:3] == [drawn.violations, 1000, failed]


def test_a_quantile_among_failed_flights_has_no_bound() -> None:
    found = quantile_of(ran({"samples": 200}, evaluate(failing=lambda x: x[:, 0] > 0.8)).sample)
    assert found.bound is None
    assert facts(found.statement) == [0.05]


@pytest.mark.parametrize("samples", [1, 58])
def test_a_sample_that_is_too_small_is_reported_as_such(samples: int) -> None:
    found = ran({"samples": samples})
    assert quantile_of(found.sample).bound is None
    assert facts(quantile_of(found.sample).statement) == [samples, 0.05, 59]
    assert quantile_of(ran({"samples": 59}).sample).order == 1


def test_excluded_draws_are_drawn_again_and_counted() -> None:
    found = ran({"samples": 500}, evaluate(excluded=lambda x: x[:, 0] < 0.3))
    drawn, uniform = found.sample, stream(1, certify.STREAM).random((2000, 2))
    kept = uniform[uniform[:, 0] >= 0.3]
    last = int(np.flatnonzero(uniform[:, 0] >= 0.3)[499])
    assert drawn.samples == 500
    assert drawn.excluded == found.excluded == last + 1 - 500
    assert found.evaluations == last + 1
    assert drawn.lowest == costs(kept[:500]).min()


def test_sampling_stops_where_the_precondition_hardly_ever_holds() -> None:
    found = ran({"samples": 100}, evaluate(excluded=lambda x: x[:, 0] < 0.9))
    assert found.evaluations == 200, "no more than twice the samples are drawn: part of the stated bound"
    assert found.sample.samples < 100
    assert facts(found.statement)[-2:] == [found.sample.samples, 100]
    nothing = ran({"samples": 50}, evaluate(excluded=lambda x: x[:, 0] >= 0))
    assert nothing.sample.upper_bound == 1.0
    assert nothing.sample.lowest is None
    assert nothing.sample.distribution is not None
    assert nothing.sample.distribution.values == []


def test_the_probability_beyond_the_bounds_is_added() -> None:
    normal = {"low": 4, "high": 6, "distribution": {"kind": "normal", "mean": 5, "deviation": 0.4}}
    given: Any = {"uncertain__vehicle.m": normal}
    outside = 0.0124193  # beyond 2.5 deviations
    campaign_of = asked({"certify": {"samples": 1000}}, **given)
    found = certify.run(context(campaign_of, problem=Problem(campaign_of)), 0).result
    drawn = found.sample
    assert drawn.outside == pytest.approx(outside, abs=1e-6)
    assert drawn.upper_bound == pytest.approx(bound(drawn.violations, 1000, 0.95) + outside, abs=1e-6)
    assert facts(drawn.statement)[-1] == 0.0125, "rounded up: correlated parameters have at most this"
    # The quantile is that of a sample of which so many more may lie below.
    order = quantile_of(drawn).order
    assert order is not None
    assert order < 39
    wide = asked({"certify": {"samples": 1000}}, **{"uncertain__vehicle.m": normal | {"distribution": {
        "kind": "normal", "mean": 5, "deviation": 0.6}}})  # fmt: skip
    statement = quantile_of(certify.run(context(wide, problem=Problem(wide)), 0).result.sample)
    assert statement.bound is None
    assert facts(statement.statement) == [0.05, 0.0956]


def test_its_numbers_are_those_of_no_search() -> None:
    draws = {k: tuple(stream(1, k).random(4)) for k in (*range(32), certify.STREAM)}
    assert len(set(draws.values())) == 33


def test_a_longer_sample_begins_as_the_shorter_one() -> None:
    points = []
    for samples in (100, 6000):
        run = context(asked({"certify": {"samples": samples}}))
        certify.run(run, 0)
        columns = run.store.evaluations(0)
        assert columns is not None
        points.append(columns.points)
    assert np.array_equal(points[0], points[1][:100])


# Grid


def test_the_grid_reports_its_lowest_value_and_its_spacing() -> None:
    run = context(asked({"certify": {"samples": 100, "grid": {"points": 11}}}))
    found = certify.run(run, 0).result
    columns = run.store.evaluations(0)
    assert columns is not None
    flown = columns.points[100:]
    axis = np.linspace(0, 1, 11)
    assert sorted(map(tuple, np.round(flown, 12))) == [(a, b) for a in np.round(axis, 12) for b in np.round(axis, 12)]
    grid = found.grid
    assert grid is not None
    assert (grid.points, grid.total, grid.excluded, grid.failed) == (11, 121, 0, 0)
    assert grid.spacing == {"vehicle.m": pytest.approx(0.2), "vehicle.J": pytest.approx(0.002)}
    assert grid.lowest is not None
    assert grid.lowest.cost == pytest.approx(0.3)
    assert grid.lowest.margin == pytest.approx(-0.2)
    assert grid.lowest.parameters == {"vehicle.m": 4.0, "vehicle.J": 0.04}
    assert grid.violations == int((costs(flown) <= THRESHOLD).sum())
    assert "nothing is claimed between these points" in grid.text
    assert found.sample.samples == 100  # no point of the grid is in the sample


def test_a_grid_of_which_every_evaluation_fails() -> None:
    grid = ran({"samples": 5, "grid": {"points": 3}}, evaluate(failing=lambda x: x[:, 0] >= 0)).grid
    assert grid is not None
    assert (grid.lowest, grid.failed, grid.violations) == (None, 9, 9)
    assert facts(grid.statement) == [3, 9, 9, 9]


def test_the_grid_of_a_large_dimension_is_refused() -> None:
    many = {path: {"plus_minus": "1%"} for path in ("vehicle.m", "vehicle.J", *(f"controller.K_p{i}" for i in (1, 2)))}
    (problem,) = check(asked({"certify": {"grid": {"points": 57}}}, uncertain=many), catalogue())
    assert problem.field == "stages.certify.grid.points"
    assert problem.message.endswith("more than 10,000,000 evaluations; at most 56 points per axis")
    assert check(asked({"certify": {"grid": {"points": 56}}}, uncertain=many), catalogue()) == []


# Campaigns


def test_it_is_planned_between_search_and_validation() -> None:
    stages = [(p.kind, p.planned) for p in plan(asked({"certify": {"samples": 70, "grid": {"points": 5}}}))]
    assert [kind for kind, _ in stages] == ["nominal", "search", "certify", "validate"]
    assert dict(stages)["certify"] == 95
    assert "certify" not in [p.kind for p in plan(campaign(stages__certify=None))]


@pytest.mark.parametrize("given", [{"samples": 0}, {"quantile": 0}, {"quantile": 1}, {"grid": {"points": 1}}, {"n": 5}])
def test_settings_that_make_no_sense(given: dict[str, Any]) -> None:
    with pytest.raises(CampaignError, match=r"stages\.certify\."):
        asked({"certify": given})


def test_no_sample_at_all() -> None:
    empty: Floats = np.empty((0, 1))
    columns = Columns(np.empty((0, 2)), empty, np.empty(0, dtype=np.uint8), np.empty(0), {})
    sample = Sample.of(columns, Problem(campaign()), 0.95)
    assert sample.statement().upper_bound == 1.0
    assert sample.quantile(0.05, "d_min", "m").bound is None
