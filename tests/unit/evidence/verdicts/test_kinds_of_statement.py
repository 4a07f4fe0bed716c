"""Searched, sampled, estimated and proved are stated apart, in every combination; a verdict claims the first two."""

from __future__ import annotations

import itertools

import pytest

from campaigns.asked.load import load_document
from campaigns.claims.spans import Quantity, Spans, words
from campaigns.results.base import Described
from tests.audited import audited
from tests.given.corrupted_records import attracting, in_a_second
from tests.given.sampled_stages import DRAWN
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

BY_DAY = (True, True, True)
EVERY = [
    pytest.param(*kinds, marks=() if kinds == BY_DAY else pytest.mark.nightly)
    for kinds in itertools.product((False, True), repeat=3)
]
BOUND, ESTIMATE, REGION = {"upper_bound"}, {"probability", "low", "high"}, {"fraction", "difference"}
"""Numbers that only such a statement has, by name."""


def named(statement: Spans) -> set[str]:
    return {span.name for span in statement if isinstance(span, Quantity)} & (BOUND | ESTIMATE | REGION)


@pytest.mark.parametrize(("sampled", "estimated", "proved"), EVERY)
def test_a_verdict_says_no_more_than_was_searched_and_sampled(
    monkeypatch: pytest.MonkeyPatch, sampled: bool, estimated: bool, proved: bool
) -> None:
    in_a_second(monkeypatch)
    document = attracting(criterion__threshold=0.955).document()
    document["stages"] |= {
        "certify": {"samples": 60} if sampled else None,
        "estimate": {"evaluations": 1000} if estimated else None,
        "attraction": {} if proved else None,
    }
    campaign, store = load_document(document), MemoryStore(sample_seed=DRAWN)
    verdict = execute(campaign, store, threads=1)
    audited(store, campaign)
    assert verdict.verdict == "violated"
    assert named(verdict.statement) == (BOUND if sampled else set())
    results = [record.result for record in store.stages if record.result is not None]
    stated = {result.stage: named(result.statement) for result in results if isinstance(result, Described)}
    assert stated.get("estimate", set()) == (ESTIMATE if estimated else set())
    assert stated.get("attraction", set()) == (REGION if proved else set())
    assert ("proved" in words(verdict.statement)) is False
