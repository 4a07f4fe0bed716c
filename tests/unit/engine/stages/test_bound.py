"""The bound of Clopper and Pearson (1934) against closed forms and tables."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from scipy import stats

from campaigns import CampaignError
from campaigns.asked import sample_bound
from campaigns.asked.load import load_document
from campaigns.asked.values import MAX_COUNTED
from campaigns.claims.spans import values
from tests.given.case_campaigns import searching
from worker.engine.stages.parts.claims import band, bound, confidence_of, needed, order
from worker.engine.stages.parts.sample import Sample
from worker.engine.stages.parts.shape import Ordered
from worker.evidence.audit import recompute


@pytest.mark.parametrize("samples", [1, 2, 10, 100, 1000, 10**6])
@pytest.mark.parametrize("confidence", [0.6, 0.9, 0.95, 0.999])
def test_the_bound_of_no_violation_is_its_closed_form(samples: int, confidence: float) -> None:
    assert bound(0, samples, confidence) == pytest.approx(1 - (1 - confidence) ** (1 / samples), rel=1e-9)


@pytest.mark.parametrize(
    ("violations", "samples", "confidence", "value"),
    [
        (0, 10, 0.975, 0.3085), (1, 10, 0.975, 0.4450), (5, 10, 0.975, 0.8129), (9, 10, 0.975, 0.9975),
        (0, 59, 0.95, 0.0495), (0, 299, 0.95, 0.00997), (0, 1000, 0.95, 0.0029912), (3, 100, 0.95, 0.0757),
    ],
)  # fmt: skip
def test_the_bound_against_tables(violations: int, samples: int, confidence: float, value: float) -> None:
    # Two-sided 95 % intervals are two one-sided 97.5 % ones; 59 and 299 samples are the known sizes for 5 % and 1 %.
    assert bound(violations, samples, confidence) == pytest.approx(value, rel=2e-3)


@pytest.mark.parametrize(("violations", "samples"), [(1, 20), (7, 50), (49, 50), (120, 1000)])
def test_the_bound_is_where_so_few_violations_would_be_improbable(violations: int, samples: int) -> None:
    upper = bound(violations, samples, 0.95)
    assert stats.binom.cdf(violations, samples, upper) == pytest.approx(0.05, rel=1e-9)


def test_the_bound_of_an_empty_sample_is_one() -> None:
    assert bound(0, 0, 0.95) == bound(5, 5, 0.95) == 1.0
    values = [bound(k, 30, 0.95) for k in range(31)]
    assert np.all(np.diff(values) >= 0)


# Wilks


@pytest.mark.parametrize(
    ("share", "confidence", "size"),
    [(0.05, 0.95, 59), (0.01, 0.95, 299), (0.10, 0.90, 22), (0.05, 0.99, 90), (0.01, 0.99, 459), (0.5, 0.95, 5)],
)
def test_the_known_sizes_of_samples(share: float, confidence: float, size: int) -> None:
    # Wilks (1941); 59 and 93 flights are the sizes of first and second order for 95 %/95 % in reactor safety.
    assert needed(share, confidence) == size
    assert order(size, share, confidence) == 1
    assert order(size - 1, share, confidence) == 0
    assert confidence_of(1, size, share) == pytest.approx(1 - (1 - share) ** size)


@pytest.mark.parametrize(("size", "r"), [(59, 1), (93, 2), (124, 3), (153, 4), (181, 5), (208, 6)])
def test_the_sizes_of_higher_orders(size: int, r: int) -> None:
    # One-sided 95 %/95 %: Guba, Makai, Pal, Statistical aspects of best estimate method (2003), table 1.
    assert order(size, 0.05, 0.95) == r
    assert order(size - 1, 0.05, 0.95) == r - 1


@pytest.mark.parametrize("size", [1, 17, 60, 500, 3000, 100_000])
@pytest.mark.parametrize("share", [0.001, 0.05, 0.5, 0.999])
def test_the_order_is_the_highest_that_holds(size: int, share: float) -> None:
    r = order(size, share, 0.95)
    assert 0 <= r <= size
    if r:
        assert confidence_of(r, size, share) >= 0.95
    assert confidence_of(r + 1, size, share) < 0.95
    assert confidence_of(max(r, 1), size, share) == pytest.approx(stats.binom.sf(max(r, 1) - 1, size, share))


def test_what_no_sample_bounds() -> None:
    assert order(0, 0.05, 0.95) == order(1000, 0.0, 0.95) == order(1000, -0.1, 0.95) == 0
    assert confidence_of(0, 10, 0.5) == confidence_of(11, 10, 0.5) == 0.0


FRACTIONS = [5e-324, 1e-300, 1e-20, 1e-17, 1e-12, 1e-9, 1e-6, 0.001, 0.05, 0.5, 0.999, 1 - 2**-53]


@pytest.mark.parametrize("fraction", FRACTIONS)
@pytest.mark.parametrize("confidence", [0.51, 0.75, 0.95, 0.999999, 1 - 1e-9])
def test_every_fraction_has_a_size_or_none_in_engine_and_audit(fraction: float, confidence: float) -> None:
    size = needed(fraction, confidence)
    assert size == recompute._needed(fraction, confidence)
    assert (size is None) == (fraction < 1e-12)
    for samples in (0, 1, 59, 1000):
        r = order(samples, fraction, confidence)
        assert (r > 0) == (size is not None and samples >= size)
        assert r == (recompute._of_quantile(samples, fraction, confidence).order or 0)
    wanted = sample_bound.needed(0, 0, fraction, confidence)
    assert wanted is None or bound(0, wanted, confidence) <= fraction
    assert (wanted is None) == (size is None or sample_bound._rounded(size) > MAX_COUNTED)


@pytest.mark.parametrize("outside", [0.05 - 2**-56, 0.05, 0.06, 1.0])
def test_tails_that_leave_next_to_nothing_of_a_quantile_leave_no_bound_on_it(outside: float) -> None:
    sample = Sample(Ordered(np.arange(100.0)), 0, 0, 0, outside, 0.95)
    found = sample.quantile(0.05, "d_min", "m")
    assert (found.order, found.needed, found.bound) == (None, None, None)
    assert values(found.statement)["share"] == 0.05


@pytest.mark.parametrize("fraction", FRACTIONS)
def test_a_campaign_with_any_fraction_is_read_or_refused_with_a_sentence(fraction: float) -> None:
    document = searching({"method": "monte_carlo", "evaluations": 60}).document()
    sample = {"samples": 10**9, "keep": "lowest", "until": "target"}
    for certify, target in (({"quantile": fraction}, None), (sample, fraction)):
        document |= {"stages": document["stages"] | {"certify": certify}, "target_probability": target}
        refused = fraction < (1e-9 if target is None else 2e-9)
        expected = pytest.raises(CampaignError, match=r"at least 1e-09 |higher target_probability")
        with expected if refused else nullcontext():
            load_document(document, "the test")


def test_the_band_of_the_distribution_function() -> None:
    # Massart: P(sup |F_n - F| > e) <= 2 exp(-2 n e^2).
    assert band(1000, 0.95) == pytest.approx(0.04295, abs=1e-5)
    assert 2 * np.exp(-2 * 1000 * band(1000, 0.95) ** 2) == pytest.approx(0.05)
    assert band(0, 0.95) == 1.0
