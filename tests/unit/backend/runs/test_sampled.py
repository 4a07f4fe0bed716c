"""The sample of a bound where what is stored does not name it."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from backend.runs import sampled
from campaigns.results.verdict import Statistics


@pytest.mark.parametrize("named", ["certify", "search", None])
def test_a_bound_that_names_no_sample_is_older_than_the_certify_stage(named: str | None) -> None:
    """For lists and for the verdict alike: it has the weaker source."""
    stored = {"samples": 1000, "violations": 0, "confidence": 0.95, "upper_bound": 0.003}
    whole = Statistics.model_validate(stored | ({"source": named} if named else {}))
    row = SimpleNamespace(source=named, stated=False)
    assert sampled.bound_source(row, 0.003) == whole.source == (named or "search")
    assert sampled.bound_source(row, None) is None


@pytest.mark.parametrize(
    ("named", "stated", "found"),
    [
        ("certify", False, "certify"),
        ("certify", True, "certify_stated"),
        ("search", False, "search"),
        ("search", True, "search"),
    ],
)
def test_a_stated_seed_is_that_of_the_certify_stage(named: str, stated: bool, found: str) -> None:
    assert sampled.bound_source(SimpleNamespace(source=named, stated=stated), 0.003) == found
