"""Searched, sampled, estimated and proved are stated apart, in every combination; a verdict claims the first two."""

from __future__ import annotations

import itertools

import pytest

from campaigns.asked.load import load_document
from campaigns.claims.spans import words
from tests.audited import audited
from tests.given.corrupted_records import attracting
from tests.given.sampled_stages import DRAWN
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

BY_DAY = (True, True, True)
EVERY = [
    pytest.param(*kinds, marks=() if kinds == BY_DAY else pytest.mark.nightly)
    for kinds in itertools.product((False, True), repeat=3)
]
BOUND, ESTIMATE, PROOF = "P(violation) is at most", "P(violation) is about", "proved"


@pytest.mark.parametrize(("sampled", "estimated", "proved"), EVERY)
def test_a_verdict_says_no_more_than_was_searched_and_sampled(sampled: bool, estimated: bool, proved: bool) -> None:
    document = attracting(criterion__threshold=0.955).document()
    document["stages"] |= {
        "certify": {"samples": 60} if sampled else None,
        "estimate": {"evaluations": 1000} if estimated else None,
        "attraction": {} if proved else None,
    }
    campaign, store = load_document(document), MemoryStore(sample_seed=DRAWN)
    verdict = execute(campaign, store, threads=1)
    audited(store, campaign)
    told = words(verdict.statement)
    assert verdict.verdict == "violated"
    assert (BOUND in told, ESTIMATE in told, PROOF in told) == (sampled, False, False)
    results = [record.result for record in store.stages if record.result is not None]
    stated = {result.stage: words(getattr(result, "statement", ())) for result in results}
    assert (ESTIMATE in stated.get("estimate", ""), "not a bound" in stated.get("estimate", "")) == (estimated,) * 2
    assert (PROOF in stated.get("attraction", ""), "not for the loop as flown" in stated.get("attraction", "")) == (
        (proved,) * 2
    )
    assert BOUND not in stated.get("estimate", "") + stated.get("attraction", "")
