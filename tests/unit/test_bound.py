"""The bound of Clopper and Pearson (1934) against closed forms and tables."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from worker.stages.search import bound


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


def test_the_bound_says_nothing_of_nothing() -> None:
    assert bound(0, 0, 0.95) == bound(5, 5, 0.95) == 1.0
    values = [bound(k, 30, 0.95) for k in range(31)]
    assert np.all(np.diff(values) >= 0)
