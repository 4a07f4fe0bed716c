"""A sample of which only a part is stored: it claims what the whole would, continues, can be made again."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from campaigns.asked.problem import CampaignError
from campaigns.claims.spans import values as told_in
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.results.draws import uniform
from campaigns.results.sample import FAILURES, FIRST, KEPT
from campaigns.sample_seed import SampleSeed
from campaigns.stages.certify import CertifyResult
from campaigns.stored.blocks import Counted, Kept, Scale, counted, packed, size, unpacked
from tests.given.at_night import nightly_but, rows_nightly_but
from tests.given.corrupted_records import NORMAL
from tests.given.corrupted_records import counting as campaign_counting
from tests.given.sampled_stages import THRESHOLD, asked, context, costs, evaluate
from worker.engine.search.base import Batch, Floats
from worker.engine.stages import certify
from worker.engine.stages.parts import claims, counting
from worker.engine.stages.parts.context import Cancelled, Context
from worker.engine.stages.parts.counting import STREAM
from worker.engine.stages.parts.sample import Sample
from worker.engine.stages.parts.shape import Binned, Ordered
from worker.engine.systems.base import CampaignUnusable
from worker.evidence.audit.parts import written
from worker.evidence.audit.recompute import histogram
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

SAMPLES = 20_000


def ran(samples: int = SAMPLES, flown: Any = None) -> tuple[Context, CertifyResult]:
    of = context(asked({"certify": {"samples": samples, "keep": "lowest"}}, seed=1), flown)
    return of, certify.run(of, 0).result


def expected(samples: int = SAMPLES) -> Floats:
    return costs(uniform(1, STREAM, 0, samples, 2))


@pytest.mark.nightly
def test_it_claims_what_all_flights_claim() -> None:
    _, found = ran()
    values = np.sort(expected())
    whole = Sample(Ordered(values), int((values <= THRESHOLD).sum()), 0, 0, 0.0, 0.95).statement()
    part = found.sample
    assert (part.samples, part.violations, part.upper_bound) == (SAMPLES, whole.violations, whole.upper_bound)
    assert whole.violations > 300
    assert part.text == whole.text
    assert part.lowest == whole.lowest
    assert part.mean == pytest.approx(whole.mean, rel=1e-12)
    assert part.deviation == pytest.approx(whole.deviation, rel=1e-9)
    assert part.histogram is not None
    assert part.histogram.counts == np.histogram(values, part.histogram.edges)[0].tolist()
    assert sum(part.histogram.counts) == SAMPLES


@pytest.mark.parametrize("share", [0.01, 0.05, 0.5, 0.99])
def test_a_quantile_is_never_bounded_above_that_of_all_flights(share: float) -> None:
    values, scale = expected(), Scale.over(np.array([0.4, 2.0]), THRESHOLD)
    block = counted(0, values[:, None], values[:, None], np.zeros(SAMPLES, np.uint8), {}, scale, THRESHOLD)
    exact, binned = (
        Sample(shape, 0, 0, 0, 0.0, 0.95).quantile(share, "d_min", "m").bound
        for shape in (Ordered(np.sort(values)), Binned(Counted.of([block], scale)))
    )
    assert exact is not None
    assert binned is not None
    assert 0.0 <= exact - binned <= (0.0 if share * SAMPLES < 0.9 * KEPT else scale.width * (1 + 1e-9))


@pytest.mark.nightly
def test_its_distribution_function_is_that_of_all_flights() -> None:
    _, found = ran()
    curve, values = found.sample.distribution, expected()
    assert curve is not None
    assert 200 < len(curve.values) < 600
    assert curve.shares == [(values <= value).mean() for value in curve.values]


@pytest.mark.parametrize("interrupted", nightly_but((2,), [1, 2, 5, 19]))
def test_an_interrupted_sample_goes_on_to_the_same_bits(interrupted: int, monkeypatch: pytest.MonkeyPatch) -> None:
    _, whole = ran()
    monkeypatch.setattr(counting, "SAVED", 0.0)  # a block at a time
    of = context(asked({"certify": {"samples": SAMPLES, "keep": "lowest"}}, seed=1))
    calls, evaluating = 0, of.evaluate

    def until(points: Floats, *own: Any) -> tuple[Batch, dict[int, str]]:
        nonlocal calls
        calls += 1
        return evaluating(points, *own)

    of.evaluate, of.cancelled = until, lambda: calls >= interrupted
    with pytest.raises(Cancelled):
        certify.run(of, 0)
    blocks = of.store.blocks(0)
    assert whole.blocks is not None
    assert 0 < len(blocks) < len(whole.blocks.draws)
    of.cancelled = lambda: False
    again = certify.run(of, 0).result
    untimed = {"seconds": 0.0}
    assert again.model_copy(update=untimed) == whole.model_copy(update=untimed)


@pytest.mark.nightly
def test_the_stored_flights_are_the_lowest_and_the_first_and_can_be_made_again() -> None:
    of, found = ran()
    columns, values = of.store.evaluations(0), expected()
    assert columns is not None
    assert found.flights is not None
    lowest = np.argsort(values, kind="stable")[:KEPT]
    assert found.flights == np.union1d(lowest, np.arange(FIRST)).tolist()
    assert found.blocks is not None
    beside = found.blocks.beside
    assert (beside.evaluations, beside.failed, beside.excluded) == (SAMPLES - len(found.flights), 0, 0)
    assert beside.violating == (np.delete(values, found.flights) <= THRESHOLD).sum()
    assert columns.costs[:, 0].tolist() == values[found.flights].tolist()
    assert columns.points.tolist() == uniform(1, STREAM, 0, SAMPLES, 2)[found.flights].tolist()


@pytest.mark.nightly
def test_what_fails_is_a_violation_and_is_kept_with_its_reason() -> None:
    def flown(points: Floats) -> tuple[Batch, dict[int, str]]:
        batch, _ = evaluate(failing=lambda x: x[:, 0] > 0.999)(points)
        return batch, {int(row): "the wing broke" for row in np.flatnonzero(batch.status == FAILED)}

    of, found = ran(flown=flown)
    points = uniform(1, STREAM, 0, SAMPLES, 2)
    failing = np.flatnonzero(points[:, 0] > 0.999)
    clear = (points[:, 0] <= 0.999) & (costs(points) > THRESHOLD)
    assert (found.failed, found.sample.failed, found.sample.violations) == (len(failing), len(failing), (~clear).sum())
    assert found.flights is not None
    columns = of.store.evaluations(0)
    assert columns is not None
    kept = [index for index, status in zip(found.flights, columns.status, strict=True) if status == FAILED]
    assert kept == failing.tolist()
    assert set(columns.reasons.values()) == {"the wing broke"}
    assert sorted(columns.reasons) == np.flatnonzero(columns.status == FAILED).tolist()


@pytest.mark.nightly
def test_excluded_draws_are_drawn_again_until_the_sample_is_whole() -> None:
    _, found = ran(5000, evaluate(excluded=lambda x: x[:, 0] < 0.3))
    assert found.sample.samples == 5000
    drawn = uniform(1, STREAM, 0, found.evaluations, 2)
    left = drawn[drawn[:, 0] >= 0.3]
    assert (found.excluded, len(left)) == (found.evaluations - 5000, 5000)
    assert found.sample.violations == (costs(left) <= THRESHOLD).sum()


@pytest.mark.nightly
def test_a_sample_that_excludes_nearly_all_ends_at_twice_its_draws() -> None:
    _, found = ran(1000, evaluate(excluded=lambda x: x[:, 0] < 0.9))
    assert found.evaluations == 2000
    assert found.sample.samples == 2000 - found.excluded < 1000
    assert "only" in found.text


def ending(low: float, samples: int = 30_000) -> tuple[Context, CertifyResult]:
    """Until a target of 0.001, with a flight that is lower than the threshold with this probability."""

    def flown(points: Floats) -> tuple[Batch, dict[int, str]]:
        batch, reasons = evaluate()(points)
        return batch._replace(costs=np.where(points[:, :1] < low, THRESHOLD - 0.1, THRESHOLD + 1.0)), reasons

    requested = {"samples": samples, "keep": "lowest", "until": "target"}
    of = context(asked({"certify": requested}, target_probability=0.001), flown, seed=1)
    return of, certify.run(of, 0).result


def test_a_sample_ends_with_the_block_that_has_more_violations_than_its_target_allows() -> None:
    _, found = ending(0.01)
    allowed = claims.allowed(30_000, 0.001, 0.95)
    assert claims.bound(allowed, 30_000, 0.95) <= 0.001 < claims.bound(allowed + 1, 30_000, 0.95)
    assert found.blocks is not None
    *before, last = found.blocks.violations
    assert sum(before) <= allowed < sum(before) + last
    bounding = sum(found.blocks.draws[:-1])
    assert (found.sample.bound_samples, found.sample.quantile, found.sample.distribution) == (bounding, None, None)
    assert found.sample.upper_bound == claims.bound(found.sample.violations, bounding, 0.95)
    told = {"allowed": allowed, "requested": 30_000, "bound_samples": bounding, "target": 0.001}
    assert told_in(found.statement).items() >= told.items()


@pytest.mark.nightly
def test_a_sample_that_meets_its_target_is_whole() -> None:
    _, found = ending(0.0005)
    violations = int(np.sum(uniform(1, STREAM, 0, 30_000, 2)[:, 0] < 0.0005))
    assert (found.evaluations, found.sample.violations, found.sample.bound_samples) == (30_000, violations, None)
    assert found.sample.upper_bound is not None
    assert found.sample.upper_bound <= 0.001
    assert found.sample.quantile is not None


@pytest.mark.nightly
def test_a_sample_with_too_many_violations_only_with_its_last_block_is_whole() -> None:
    """All of it was drawn, so that its bound counts all; where draws were left, it ended early."""
    samples, allowed = 30_000, claims.allowed(30_000, 0.001, 0.95)
    drawn = uniform(1, STREAM, 0, samples, 2)[:, 0]
    for last, whole in ((samples - 1, True), (samples - 1000, False)):
        violating = drawn[[*range(allowed), last]]

        def flown(points: Floats, violating: Floats = violating) -> tuple[Batch, dict[int, str]]:
            low = np.isin(points[:, :1], violating)
            return Batch(np.where(low, THRESHOLD - 0.1, THRESHOLD + 1.0), np.zeros(len(points), dtype=np.uint8)), {}

        requested = {"samples": samples, "keep": "lowest", "until": "target"}
        found = certify.run(context(asked({"certify": requested}, target_probability=0.001), flown, seed=1), 0).result
        assert found.sample.violations == allowed + 1
        assert (found.sample.bound_samples is None, found.evaluations == samples) == (whole, whole)
        assert ("ended early" in found.text, found.sample.quantile is None) == (not whole, not whole)
        if whole:
            assert found.sample.upper_bound == claims.bound(allowed + 1, samples, 0.95) > 0.001


@pytest.mark.parametrize(
    ("chance", "allowed"),
    rows_nightly_but([(0.002, 0), (0.004, 3), (0.02, 20)], [(0.002, 0), (0.004, 0), (0.004, 3), (0.02, 20), (0.1, 20)]),
)
def test_a_bound_holds_where_a_sample_ends_early(chance: float, allowed: int) -> None:
    """As often as stated, whether it ends early or not: of 4,000 samples of 2,016 in blocks of 32."""
    random, missed, samples, each = np.random.default_rng(allowed), 0, 2016, 32
    for _ in range(4000):
        violations = np.cumsum(random.binomial(each, chance, samples // each))
        beyond = np.flatnonzero(violations > allowed)
        last = int(beyond[0]) if len(beyond) else len(violations) - 1
        bounding = last * each if last < len(violations) - 1 else samples
        missed += claims.bound(int(violations[last]), bounding, 0.95) < chance
    assert missed / 4000 < 0.05 + 3 * math.sqrt(0.05 * 0.95 / 4000)


def test_a_target_needs_enough_samples() -> None:
    few = {"certify": {"samples": 2994, "keep": "lowest", "until": "target"}}
    with pytest.raises(CampaignError, match="2,995"):
        asked(few, target_probability=0.001)
    with pytest.raises(CampaignError, match="target_probability"):
        asked(few)


@pytest.mark.parametrize("samples", [1, 63, 64, 65, 65_536, 65_537, 3_000_000, 10**9])
def test_the_number_of_blocks_is_bounded(samples: int) -> None:
    each = size(samples)
    assert each & (each - 1) == 0
    assert samples / each <= 1024
    assert each == 1 or samples / each > 512


def test_blocks_of_any_division_show_the_same() -> None:
    values, scale = expected(), Scale.over(np.empty(0), THRESHOLD)
    status = np.where(np.arange(SAMPLES) % 97 == 0, FAILED, OK).astype(np.uint8)
    status[5::211] = EXCLUDED
    one, many = (
        Counted.of(
            [
                counted(a, values[a : a + n, None], values[a : a + n, None], status[a : a + n], {}, scale, THRESHOLD)
                for a in range(0, SAMPLES, n)
            ],
            scale,
        )
        for n in (SAMPLES, 64)
    )
    for name in ("draws", "evaluated", "failed", "excluded", "violations", "exclusions"):
        assert getattr(one, name) == getattr(many, name), name
    assert one.kept.indices.tolist() == many.kept.indices.tolist()
    assert one.bins.tolist() == many.bins.tolist()


def test_a_missing_block_is_refused() -> None:
    scale = Scale.over(np.empty(0), THRESHOLD)
    blocks = [
        counted(a, np.ones((64, 1)), np.ones((64, 1)), np.zeros(64, np.uint8), {}, scale, THRESHOLD) for a in (0, 128)
    ]
    with pytest.raises(ValueError, match=r"draw 64 .*draw 128"):
        Counted.of(blocks, scale)


def test_those_without_a_result_are_kept_beside_the_lowest() -> None:
    at, low = np.arange(4), np.array([[3.0], [np.nan], [1.0], [0.5]])
    kept = Kept.chosen(at, low, low, np.array([OK, FAILED, OK, EXCLUDED], np.uint8), {1: "broke", 3: "away"})
    assert kept.indices.tolist() == [0, 1, 2]
    assert kept.lowest.tolist() == [1.0, 3.0]
    assert kept.reasons == {1: "broke"}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("each", [64, 1024, 4096])
def test_what_is_kept_of_blocks_is_what_is_kept_of_all(each: int) -> None:
    """Whatever was left out of a block as those before it showed."""
    random = np.random.default_rng(each)
    values = random.random((30_000, 1))
    status = random.choice(np.array([OK, FAILED, EXCLUDED], np.uint8), len(values), p=[0.8, 0.1, 0.1])
    scale, known, blocks = Scale.over(np.empty(0), 0.1), None, []
    for at in range(0, len(values), each):
        rows = slice(at, at + each)
        block = counted(at, values[rows], values[rows], status[rows], {}, scale, 0.1)
        known = block.kept if known is None else Kept.joined([known, block.kept])
        blocks.append(unpacked(packed(block.without(known.last))))
    whole = Kept.chosen(np.arange(len(values)), values, values, status, {})
    kept = Counted.of(blocks, scale).kept
    assert kept.indices.tolist() == whole.indices.tolist()
    assert kept.lowest.tolist() == np.sort(values[status == OK, 0])[:KEPT].tolist()
    assert np.setdiff1d(np.flatnonzero(status[:FIRST] != EXCLUDED), kept.indices).size == 0
    assert sum(len(block.kept.indices) for block in blocks) < 15_000


@pytest.mark.nightly
def test_many_failures_displace_no_violation() -> None:
    of, found = ran(flown=evaluate(failing=lambda x: x[:, 0] > 0.9))
    columns, points = of.store.evaluations(0), uniform(1, STREAM, 0, SAMPLES, 2)
    assert columns is not None
    ok = costs(points[points[:, 0] <= 0.9])
    assert found.sample.lowest == ok.min() == columns.costs[columns.status == OK, 0].min()
    first = points[:FIRST, 0] <= 0.9
    kept = np.union1d(np.flatnonzero(first), np.flatnonzero(np.isin(costs(points), np.sort(ok)[:KEPT])))
    assert found.flights is not None
    assert [i for i, state in zip(found.flights, columns.status, strict=True) if state == OK] == kept.tolist()
    assert (columns.status == FAILED).sum() == FAILURES


def test_a_target_below_what_lies_outside_the_bounds_is_refused_before_anything_is_flown() -> None:
    store = MemoryStore(sample_seed=SampleSeed(1, stated=False))
    with pytest.raises(CampaignUnusable) as refused:
        execute(campaign_counting(3_000_000, "target", target_probability=1e-6, uncertain=NORMAL), store)
    assert [problem.field for problem in refused.value.problems] == ["stages.certify.samples"]
    assert store.stages == []


@pytest.mark.parametrize("values", [[1.0, 1.0 + 2e-16], [1e17, 1e17], [-1e308, 1e308], [2.0, 2.0], []])
def test_a_histogram_of_any_values_has_them_all(values: list[float]) -> None:
    found = Ordered(np.array(values)).histogram()
    assert sum(found.counts) == len(values)
    assert all(found.edges[0] <= value <= found.edges[-1] for value in values)
    assert written(histogram(np.array(values))) == found.model_dump(), "as the audit has it"
