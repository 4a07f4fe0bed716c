"""The attraction stage: the same result twice, and a sentence in place of a region where there is none."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.claims.stages import attraction as sentences
from campaigns.stages.attraction import AttractionResult
from clearance.testing.problems import Problem
from tests.given.corrupted_records import attracting, in_a_second
from tests.given.sampled_stages import context
from worker.engine.stages import attraction
from worker.engine.stages.parts.context import Cancelled, Context


@pytest.fixture(autouse=True)
def _in_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    in_a_second(monkeypatch)


def of(asked: Campaign) -> Context:
    return context(asked, problem=Problem(asked))


def made(asked: Campaign) -> AttractionResult:
    return attraction.run(of(asked), 0).result


@pytest.mark.nightly
def test_it_states_what_is_proved_and_gives_the_same_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """It shows in every round that it moves: it may take minutes, after which a worker would replace the process."""
    result = made(attracting())
    assert result.refused is None
    assert result.proof is not None
    assert (result.degree, result.contradicting, len(result.sections)) == (2, 0, 6)
    assert result.statement == sentences.proved(result.facts())
    assert result.fraction is not None
    assert 0.0 < result.fraction < 1.0
    again, beats = of(attracting()), list[None]()
    monkeypatch.setattr(again.store, "beat", lambda: beats.append(None))
    assert attraction.run(again, 0).result == result
    assert len(beats) >= 3
    assert AttractionResult.model_validate_json(result.model_dump_json()) == result


def test_without_the_solver_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "clarabel", None)
    result = made(attracting())
    assert result.refused is not None
    assert (result.refused.why, result.proof, result.sections) == ("solver", None, [])
    assert result.statement == sentences.refused(sentences.REASONS["solver"])


def test_a_loop_without_an_integral_gain_does_not_return_in_all_its_states() -> None:
    result = made(attracting(scenario__controller__parameters__K_i2=0.0))
    assert result.refused is not None
    assert result.refused.why == "unstable"


def test_it_ends_when_the_run_is_cancelled() -> None:
    one = of(attracting())
    one.cancelled = lambda: True
    with pytest.raises(Cancelled):
        attraction.run(one, 0)


def test_a_campaign_without_it_keeps_its_digest() -> None:
    document: dict[str, Any] = attracting().document()
    del document["stages"]["attraction"]
    without = load_document(document)
    document["stages"]["attraction"] = None
    assert load_document(document).digest == without.digest != attracting().digest
    assert attraction.wrong(Problem(without)) == ()
