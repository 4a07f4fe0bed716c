"""Sentences on one sample, one evaluation and one violation are in the singular."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from campaigns.checked.best_bound import Best
from campaigns.claims import coverage, likelihood, reweighted
from campaigns.claims.say import amount, say
from campaigns.claims.spans import Spans, words
from campaigns.claims.stages import earlier_run, ends, sample, surroundings
from campaigns.results.validate import SpotChecks, Violations
from worker.engine.search.base import Ended
from worker.engine.stages.parts.ended import spoken
from worker.evidence.scopes.simulators import words_of
from worker.evidence.verdicts import validation

PLURAL = re.compile(
    r"\b1 (random |stored |local |low |later )?"
    r"(samples|evaluations|draws|violations|blocks|findings|rectangles|comparisons|points|iterations|violate|differ)\b"
)
"""A noun or verb that a 1 must not have."""


def _sentences(n: int) -> Iterator[Spans]:
    for failed in (0, n):
        counts = sample.Counts(n, n, failed, n, 0.0, 0.95, sample.WITHOUT)
        yield counts.bound(0.5)
        yield counts.unclaimed("points of a Latin hypercube", "no bound")
        yield counts.quantile(0.05, "d_min", "m", 0, 59, None)
        yield sample.so_far(sample.Drawn(n, n, 0.95, 0.0, failed=failed), 0.5, 3, 0.4)
        yield sample.grid(2, 4, None, n, failed)
    yield sample.counted(n, n, n)
    yield sample.curtailed((), 3, 0.1, 300, n)
    yield sample.certified((), (), n, 300)
    yield ends.skipped(n, 100)
    yield earlier_run.evaluated("R-1", [earlier_run.Case("F1", True, True, "", ())] * n, (1.0, 1.0), "m")
    yield surroundings.possible_gain(n, n, "d_min", 0.1, 0.2, "m")
    yield coverage.used(n, n)
    yield coverage.without_value(n)
    yield reweighted.too_few(0.5, n, 100)
    yield likelihood.most_likely(n, "3:7", -0.1, "m", ())
    found = Violations(stored=n, checked=n, confirmed=n, statement=())
    yield validation._counts(words_of(halved=True), found, None)
    spot = SpotChecks(checked=2 * n, compared=n, violating=n, largest=0.1, median=0.1, at=None, statement=())
    yield validation._compared(words_of(halved=True), spot, "m")
    best = Best("certify", n, 0.95, 0.0, 0.5)
    yield say(best.statement, best.short_of(0.1))
    templates = (ends.BUDGET, ends.SAMPLE, ends.TARGET, ends.GRID)
    yield from (spoken(Ended("x", text, budget=n, flights=n, grid=4)) for text in templates)


@pytest.mark.parametrize("n", [1, 2])
def test_what_there_is_one_of_is_in_the_singular(n: int) -> None:
    found = [words(sentence) for sentence in _sentences(n)]
    plural = [text for text in found if PLURAL.search(re.sub(rf"\b{n}\b", "1", text))]
    assert plural == [] if n == 1 else len(plural) > 0.8 * len(found)


def test_the_template_of_a_method_is_in_the_singular_after_one() -> None:
    assert Ended("x", "completed the {iterations} iterations", iterations=1) == "completed the 1 iteration"
    assert Ended("x", "completed the {iterations} iterations", iterations=11) == "completed the 11 iterations"
    both = Ended("x", "{first}; drew {draws} draws", first=Ended("y", "bred {points} points", points=1), draws=2)
    assert words(spoken(both)) == both == "bred 1 point; drew 2 draws"


def test_an_amount_has_its_number_by_name() -> None:
    assert [words(amount(n, "sample", "samples")) for n in (0, 1, 2)] == ["0 samples", "1 sample", "2 samples"]
