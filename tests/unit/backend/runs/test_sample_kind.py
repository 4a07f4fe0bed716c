"""The sample of a bound where what is stored does not name it."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from backend.runs import sample_kind
from campaigns.results.verdict import Statistics


def sampled(
    named: str | None, stated: bool, bound: float | None = 0.003, excluded: int | None = None
) -> sample_kind.Sampled:
    row = SimpleNamespace(
        source=named,
        stated=stated,
        upper_bound=bound,
        samples=1000,
        excluded_draws=excluded,
        state="done",
        verdict="cleared",
        checks=None,
    )
    return sample_kind.of(row)


def source(named: str | None, stated: bool, bound: float | None = 0.003) -> str | None:
    return sampled(named, stated, bound).bound_source


@pytest.mark.parametrize(("excluded", "fraction"), [(None, None), (0, 0.0), (3000, 0.75)])
def test_a_bound_names_the_draws_that_it_leaves_out(excluded: int | None, fraction: float | None) -> None:
    found = sampled("certify", False, excluded=excluded)
    assert (found.excluded_samples, found.excluded_fraction) == (excluded, fraction)
    without = sampled("certify", False, None, excluded)
    assert (without.excluded_samples, without.excluded_fraction) == (None, None)


@pytest.mark.parametrize("named", ["certify", "search", None])
def test_a_bound_that_names_no_sample_is_older_than_the_certify_stage(named: str | None) -> None:
    """For lists and for the verdict alike: it has the weaker source."""
    stored = {"samples": 1000, "violations": 0, "confidence": 0.95, "upper_bound": 0.003}
    whole = Statistics.model_validate(stored | ({"source": named} if named else {}))
    assert source(named, stated=False) == whole.source == (named or "search")
    assert source(named, stated=False, bound=None) is None


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
    assert source(named, stated) == found
