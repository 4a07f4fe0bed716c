"""The estimate stage where P(violation) is known: numbers, refusals, alarms, the same bits when it is resumed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import stats

from campaigns.asked.load import load_document
from campaigns.claims.spans import values
from campaigns.claims.stages import estimate as sentences
from campaigns.results.stage import StageResult
from campaigns.sample_seed import SampleSeed
from campaigns.stages.estimate import EstimateResult
from campaigns.stored.records import StagePlan
from clearance.testing.problems import Problem
from tests.given.sampled_stages import PROBABILITY, THRESHOLD, asked, context, costs, evaluate
from worker.engine.search.base import Batch, Floats
from worker.engine.stages import estimate
from worker.engine.stages.parts.base import drive, once
from worker.engine.stages.parts.context import Cancelled, Context

BUDGET = 3000
VIOLATING = np.array([[0.5, 0.5], [0.02, 0.1], [0.01, 0.05]])


def after_a_search(points: Floats = VIOLATING, flown: Any = None, seed: int = 1, budget: int = BUDGET) -> Context:
    """A run of which a search has evaluated these points, before its estimate."""
    of = context(asked({"certify": None, "estimate": {"evaluations": budget}}), flown, seed=seed)
    of.plan = [StagePlan("search", "direct", len(points)), StagePlan("estimate", None, budget)]
    of.store.plan(of.plan)
    drive(of, 0, once(points, "a search"), len(points) + 1)
    return of


def made(of: Context) -> EstimateResult:
    result: StageResult = estimate.run(of, 1).result
    assert isinstance(result, EstimateResult)
    return result


def test_the_interval_holds_the_known_probability() -> None:
    holds = 0
    for seed in range(8):
        result = made(after_a_search(seed=seed))
        assert result.low is not None
        assert result.high is not None
        holds += result.low <= PROBABILITY <= result.high
    assert holds >= 7


PAIR = [{"between": ["vehicle.m", "vehicle.J"], "value": 0.5}]
BEYOND = 6.0 / np.sqrt(3.0)
"""Of the sum of the two correlated normals of `correlated`, of which the variance is 3, in its standard deviations."""


def correlated(bounds: float, violation: Callable[[Floats], Floats], seed: int) -> EstimateResult:
    """An estimate for two correlated normal parameters with bounds at so many deviations; violation: by how much
    deviations (m, 2) violate, above zero."""
    uncertain = {
        path: {
            "low": middle * (1.0 - 0.04 * bounds),
            "high": middle * (1.0 + 0.04 * bounds),
            "distribution": {"kind": "normal", "mean": middle, "deviation": 0.04 * middle},
        }
        for path, middle in (("vehicle.m", 5.0), ("vehicle.J", 0.05))
    }
    stages = {"certify": None, "estimate": {"evaluations": BUDGET}}
    campaign = asked(stages, uncertain=uncertain, correlations=PAIR)

    def flown(points: Floats) -> tuple[Batch, dict[int, str]]:
        by = violation((2.0 * points - 1.0) * bounds)
        return Batch((THRESHOLD - 0.1 * by)[:, None], np.zeros(len(points), dtype=np.uint8)), {}

    of = context(campaign, flown, Problem(campaign), seed)
    of.plan = [StagePlan("search", "direct", 2), StagePlan("estimate", None, BUDGET)]
    of.store.plan(of.plan)
    drive(of, 0, once(np.array([[1.0, 0.99], [0.5, 0.5]]), "a search"), 3)
    return made(of)


@pytest.mark.nightly
def test_of_correlated_normals_the_interval_holds_the_known_probability() -> None:
    holds = 0
    for seed in range(8):
        result = correlated(5.0, lambda z: z.sum(axis=1) - 6.0, seed)
        assert result.low is not None
        assert result.high is not None
        holds += result.low <= stats.norm.sf(BEYOND) <= result.high
        assert result.high < 1.5 * stats.norm.sf(BEYOND)
    assert holds >= 7


@pytest.mark.nightly
def test_a_draw_beyond_the_bounds_of_a_correlated_normal_is_no_violation_of_the_estimate_but_in_its_upper_end() -> None:
    """Beyond 2.5 deviations are at most 2.5 %; what is put on the bound violates, and nothing else does."""
    result = correlated(2.5, lambda z: np.where(np.abs(z).max(axis=1) >= 2.4999, 1.0, -1.0), 1)
    assert result.outside == pytest.approx(4.0 * stats.norm.sf(2.5))
    assert result.probability is not None
    assert result.probability < 0.001
    cut = correlated(2.5, lambda z: z.sum(axis=1) - 4.0, 1)
    assert cut.low is not None
    assert cut.high is not None
    assert cut.probability is not None
    draws = np.random.default_rng(1).multivariate_normal([0, 0], [[1.0, 0.5], [0.5, 1.0]], 1_000_000)
    inside = float(np.mean((draws.sum(axis=1) > 4.0) & (np.abs(draws) < 2.5).all(axis=1)))
    assert cut.low <= inside <= cut.high - cut.outside
    assert cut.low <= stats.norm.sf(4.0 / np.sqrt(3.0)) <= cut.high


@pytest.mark.parametrize("outside", [0.0, 1e-6, 0.02, 0.3, 1.0])
@pytest.mark.parametrize(("kept", "drawn"), [(60, 60), (55, 60), (6, 60), (1, 60), (0, 60)])
@pytest.mark.parametrize("probability", [0.0, 1e-5, 0.1, 1.0])
def test_the_ends_hold_whatever_violates_or_is_excluded_beyond_the_bounds(
    outside: float, kept: int, drawn: int, probability: float
) -> None:
    beyond = estimate._beyond(outside, kept, drawn)
    inside = (1.0 - outside) * kept / drawn
    for violating, counted in ((0.0, 0.0), (0.0, outside), (outside, outside)):
        if inside + counted > 0.0:
            true = (inside * probability + violating) / (inside + counted)
            assert probability * (1.0 - beyond) - 1e-12 <= true <= min(1.0, probability + beyond) + 1e-12


def test_the_mode_leads_back_to_the_violations_of_the_search() -> None:
    result = made(after_a_search())
    (mode,) = result.modes
    assert mode.share == pytest.approx(1.0)
    assert {(origin.position, origin.index) for origin in mode.origins} <= {(0, 1), (0, 2)}
    assert mode.origins
    assert sentences.OPEN in result.text


def test_every_evaluation_is_stored_and_the_last_are_the_draws() -> None:
    of = after_a_search()
    result = made(of)
    assert result.final is not None
    stored = of.store.evaluations(1)
    assert stored is not None
    assert result.final.first + result.final.count == len(stored.status) == BUDGET
    assert result.draws == result.final.count


def test_without_a_violation_it_states_so_and_evaluates_nothing() -> None:
    of = after_a_search(np.array([[0.5, 0.5]]))
    result = made(of)
    assert result.refused is not None
    assert (result.refused.why, result.probability, result.low) == ("no_violation", None, None)
    assert of.store.evaluations(1) is None
    assert result.statement == sentences.refused(sentences.NO_VIOLATION)


def test_failed_evaluations_alone_are_no_violations_to_estimate_from() -> None:
    """Neither where they were stored, nor where the violation that was stored fails here."""
    failing = evaluate(failing=lambda p: p[:, 0] + 2 * p[:, 1] < 0.5)
    of = after_a_search(flown=failing)
    result = made(of)
    assert result.refused is not None
    assert (result.refused.why, result.probability, result.modes) == ("no_violation", None, [])
    assert of.store.evaluations(1) is None
    of = after_a_search()
    of.evaluate = failing
    result = made(of)
    assert result.refused is not None
    assert (result.refused.why, result.probability, result.modes) == ("no_violation", None, [])


def test_its_sentence_names_failed_evaluations_where_its_modes_may_be_of_them() -> None:
    one, other = (made(after_a_search(flown=flown)).text for flown in (None, evaluate(failing=lambda p: p[:, 0] > 0.9)))
    assert sentences.MODES_OF[True] not in one
    assert sentences.MODES_OF[True] in other


def test_failed_evaluations_count_as_violations_in_its_upper_end_only() -> None:
    none, some = (
        made(after_a_search(flown=evaluate(failing=lambda p, part=part: p[:, 0] + 2 * p[:, 1] < part)))
        for part in (0.0, 0.15)
    )
    assert some.failed_draws > 0 == none.failed_draws
    assert some.probability == pytest.approx(none.probability, rel=0.15)
    assert some.low is not None
    assert none.low is not None
    assert some.low < none.low
    assert f"{some.failed_draws} failed" in some.text


def test_its_sentence_states_what_is_excluded_and_that_the_seed_was_stated() -> None:
    """Of a tenth of the cube that is excluded nothing is claimed."""
    of = after_a_search(flown=evaluate(excluded=lambda p: p[:, 0] > 0.9))
    assert 0 < values(made(of).statement)["excluded"] < values(made(of).statement)["sampled"]
    assert "excluded" not in values(made(after_a_search()).statement)
    assert sentences.SEED_STATED not in made(after_a_search()).text
    of = after_a_search()
    of.store.sample_seed = SampleSeed(1)
    assert sentences.SEED_STATED in made(of).text


def test_if_every_independent_draw_is_excluded_there_is_no_interval() -> None:
    points = np.array([[0.0002, 0.05], [0.0001, 0.1]])
    result = made(after_a_search(points, evaluate(excluded=lambda p: p[:, 0] > 0.0003)))
    assert [alarm.why for alarm in result.alarms]
    assert (result.low, result.high) == (None, None)


def test_with_an_alarm_it_has_no_interval() -> None:
    """Most of the box violates: the budget does not suffice to find a mode for every violation."""

    def low(points: Floats) -> tuple[Batch, dict[int, str]]:
        return Batch((costs(points) - 0.8)[:, None], np.zeros(len(points), dtype=np.uint8)), {}

    result = made(after_a_search(np.array([[0.1, 0.1], [0.6, 0.1]]), low, budget=1000))
    assert result.alarms
    assert (result.low, result.high) == (None, None)
    assert result.statement == sentences.alarmed([alarm.statement for alarm in result.alarms])


def test_resumed_in_the_middle_it_has_the_same_bits() -> None:
    whole, calls = after_a_search(), 0
    expected = made(whole)

    def stopping() -> bool:
        nonlocal calls
        calls += 1
        return calls > 12

    of = after_a_search()
    of.cancelled = stopping
    with pytest.raises(Cancelled):
        estimate.run(of, 1)
    begun = of.store.evaluations(1)
    assert begun is not None
    assert 0 < len(begun.status) < BUDGET
    of.cancelled = lambda: False
    assert made(of) == expected
    stored, again = whole.store.evaluations(1), of.store.evaluations(1)
    assert stored is not None
    assert again is not None
    assert np.array_equal(stored.points, again.points)


def test_a_campaign_without_it_keeps_its_digest() -> None:
    before = asked({})
    assert "estimate" not in before.document()["stages"]
    document = before.document()
    document["stages"]["estimate"] = None
    assert load_document(document).digest == before.digest
    document["stages"]["estimate"] = {"evaluations": 5000}
    assert load_document(document).digest != before.digest
