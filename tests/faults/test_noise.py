"""Simulators that do not repeat: what is measured, what may be claimed, and that none is cleared by luck."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.claims.stages import calls
from campaigns.claims.stages.sample import CALLED
from campaigns.results import ValidateResult, Verdict
from campaigns.results.base import FAILED, FLAKY, OK, TIMEOUT
from campaigns.results.measured import Measured
from campaigns.results.remedies import Ran, remedies
from campaigns.stages.nominal import NominalResult
from clearance.cli import invoke
from tests.given.at_night import nightly_but
from tests.simulators.adversaries import ADVERSARIES, Call, adversary, never
from tests.simulators.noisy import REPEATS, by_auto, campaign, ran
from worker.running.runs.runner import CampaignUnusable, Cancelled, execute
from worker.running.runs.store import MemoryStore


def measured(store: MemoryStore) -> Measured:
    result = store.stages[0].result
    assert isinstance(result, NominalResult)
    assert result.measured is not None
    return result.measured


def check(verdict: Verdict, name: str) -> Any:
    return next(c for c in verdict.checks if c.name == name)


SINGLE = (
    "none",
    "noise",
    "now and then too low",
    "now and then a little low",
    "noise of the process",
    "seeded by time",
    "rarely a violation",
    "violates in a fresh process",
)
"""By day: noise of every call and of every process, and what is seldom seen; the others are more of these."""


@pytest.mark.by_day(1)
@pytest.mark.by_day(3)
@pytest.mark.parametrize("how", nightly_but(SINGLE, ADVERSARIES))
def test_what_does_not_repeat_is_never_cleared_by_single_calls(how: str) -> None:
    with adversary(how):
        verdict, store = ran(campaign())
    if how == "none":
        assert verdict.verdict == "cleared", verdict.reason
        assert measured(store).statement == calls.measured(5, 15, 0, True, True, None, "m")
        assert check(verdict, "noise of calls").ok
        return
    assert verdict.verdict != "cleared", verdict.reason
    assert not check(verdict, "noise of calls").ok
    if verdict.verdict == "inconclusive":
        assert "simulator.repeats to {count: " in verdict.sentence or "does not repeat" in verdict.sentence


CALLS_KNOWN = {
    "none": "cleared",
    "tiny noise": "cleared",
    "a coin": "cleared",
    "noise of the process": "inconclusive",
    "now and then too low": "inconclusive",
    "rarely a violation": "violated",
    "violates in a fresh process": "violated",
}


CALLED_BY_DAY = ("none", "noise of the process", "rarely a violation", "violates in a fresh process")
"""One of every verdict, and the two that violate; what is too low now and then is named below."""


@pytest.mark.by_day(2)
@pytest.mark.parametrize(
    ("how", "word"),
    [
        pytest.param(how, word, marks=[] if how in CALLED_BY_DAY else [pytest.mark.nightly])
        for how, word in CALLS_KNOWN.items()
    ],
)
def test_several_calls_settle_what_one_call_cannot(how: str, word: str) -> None:
    with adversary(how):
        verdict, store = ran(campaign(**REPEATS))
    assert verdict.verdict == word, verdict.reason
    result = store.stages[-1].result
    assert isinstance(result, ValidateResult)
    cases = [result.nominal, *(f.validation for f in store.findings), *(b.validation for b in result.incumbents)]
    repeats = [c.repeats for c in cases if c is not None and c.repeats is not None]
    assert len(repeats) == len(cases)
    assert all(len(r.values) == 10 for r in repeats)
    assert " worst of 5 calls," in verdict.sentence
    violating = max(r.violating for r in repeats)
    if word == "violated":
        assert " of 10 [" in verdict.sentence
        assert 0.0 < verdict.values["low"] < violating / 10 <= verdict.values["high"]
        assert violating == next(f for f in store.findings if f.violates).validation.repeats.violating > 0  # type: ignore[union-attr]
    else:
        assert violating == 0
    if word == "cleared":
        assert " 50 independent calls " in verdict.sentence
        assert CALLED.holds in verdict.sentence


def test_an_incumbent_that_violated_by_luck_is_named() -> None:
    with adversary("now and then too low"):
        verdict, _ = ran(campaign(**REPEATS))
    assert "the best of DIRECT violates with -" in verdict.sentence
    assert "in the search, and in none of its calls" in verdict.sentence


def test_a_simulator_that_declares_noise_is_not_cleared_by_single_calls() -> None:
    with adversary("none", declared=False):
        verdict, store = ran(campaign())
    assert verdict.verdict == "inconclusive"
    assert measured(store).statement == calls.measured(5, 15, 0, True, False, None, "m")


@pytest.mark.parametrize("repeats", [{"combine": "mean"}, {"combine": "quantile", "quantile": 0.1}])
def test_what_can_hide_a_call_never_clears(repeats: dict[str, Any]) -> None:
    with adversary("none"):
        verdict, _ = ran(campaign(repeats=repeats))
    assert verdict.verdict == "inconclusive"
    assert [c.name for c in verdict.checks if not c.ok] == ["noise of calls"]


def test_several_calls_are_not_cleared_without_an_independent_sample() -> None:
    asked = campaign(**REPEATS).document()
    asked["stages"]["certify"] = None
    with adversary("none"):
        verdict, _ = ran(load_document(asked))
    assert not check(verdict, "noise of calls").ok
    assert "add a certify stage, in which every sample is one call" in check(verdict, "noise of calls").text


def test_the_first_stored_evaluation_is_the_nominal_one() -> None:
    """The others of the first stage may be lower."""
    with adversary("none"):
        verdict, store = ran(campaign())
    columns = store.evaluations(0)
    assert columns is not None
    assert len(columns.status) == 15
    assert columns.costs[:, 0].min() < columns.costs[0, 0] == 8.5
    assert verdict.nominal is not None
    assert verdict.nominal.cost == 8.5


def test_an_evaluation_is_the_combination_of_its_calls() -> None:
    with adversary("noise") as made:
        store = MemoryStore()
        execute(campaign(**REPEATS), store, threads=1)
        calls = next(made.world.calls) - 1
    stored = [c for k in range(len(store.stages)) if (c := store.evaluations(k)) is not None]
    assert calls > 5 * (sum(len(c.status) for c in stored) - 120)
    assert np.isfinite(np.concatenate([c.costs for c in stored])).all()


def now_and_then_lost(status: int) -> Any:
    return lambda call: status if call.total % 50 == 0 else OK


@pytest.mark.parametrize("status", [FAILED, TIMEOUT])
def test_a_call_that_succeeds_when_tried_again_is_counted_and_bars_cleared(status: int) -> None:
    with adversary("none", now_and_then_lost(status)):
        verdict, store = ran(campaign(retries=1))
    held = [c for k in range(len(store.stages)) if (c := store.evaluations(k)) is not None]
    flaky = sum(why.startswith(FLAKY) for c in held for why in c.reasons.values())
    assert flaky > 5
    assert verdict.verdict == "inconclusive"
    statement = check(verdict, "retries")
    assert statement.values["flaky"] == flaky
    assert f"{flaky} of " in verdict.sentence
    assert statement.text in verdict.sentence
    assert verdict.values["flaky"] == flaky


def test_without_retries_it_is_a_failed_evaluation() -> None:
    with adversary("none", now_and_then_lost(FAILED)):
        verdict, _ = ran(campaign())
    assert verdict.evaluations is not None
    assert verdict.evaluations.failed > 5
    assert verdict.verdict == "inconclusive"


def test_one_failed_call_makes_the_evaluation_fail_with_its_reason() -> None:
    def third(call: Call) -> int:
        return FAILED if call.total == 3 else OK

    with adversary("none", third):
        _, store = ran(campaign(**REPEATS))
    columns = store.evaluations(0)
    assert columns is not None
    assert columns.status[0] == FAILED
    assert columns.reasons[0].startswith("call 3 of 5: ")
    assert columns.reasons[0].endswith(" exit code 3")


def test_a_simulator_that_always_fails_ends_the_run_at_once() -> None:
    store = MemoryStore()
    with adversary("none", never), pytest.raises(CampaignUnusable, match=" exit code 3") as refused:
        execute(campaign(), store, threads=1)
    columns = store.evaluations(0)
    assert columns is not None
    assert calls.without_value(15, 5, [columns.reasons[0]]) in str(refused.value)
    assert len(columns.status) == 15
    assert store.evaluations(1) is None


def test_a_resumed_run_measures_what_is_missing() -> None:
    """Cancelled in its first stage, it continues from the stored evaluations."""
    store, left = MemoryStore(), iter([False] * 2 + [True] * 10)
    with adversary("none"):
        with pytest.raises(Cancelled):
            execute(campaign(), store, lambda: next(left), threads=1)
        held = store.evaluations(0)
        assert held is not None
        assert 0 < len(held.status) < 15
        execute(campaign(), store, threads=1)
    assert measured(store).identical


def test_a_random_evaluation_that_fails_only_when_made_again_bars_cleared() -> None:
    """Its first processes never fail; of the fresh ones, those that evaluate far from the findings do."""

    def fresh_and_low(call: Call) -> int:
        return FAILED if call.process > 2 and call.a < 0.3 else OK

    with adversary("none", fresh_and_low):
        verdict, _ = ran(campaign(**REPEATS))
    assert verdict.verdict == "inconclusive"
    assert not check(verdict, "noise of calls").ok


LATER: dict[str, Any] = {
    "fails later": lambda call: FAILED if call.total > 450 else OK,
    "fails now and then": lambda call: FAILED if call.total % 50 == 0 else OK,
}


ADVISED = ("none", "noise of the process", "now and then a little low", "violates in a fresh process", "fails later")
"""By day: without a cause, every cause, and what shows late."""


@pytest.mark.by_day(1)
@pytest.mark.by_day(2)
@pytest.mark.parametrize("how", nightly_but(ADVISED, [*ADVERSARIES, *LATER]))
def test_what_does_not_repeat_has_advice_for_its_cause_and_no_chance_of_a_lower_case(how: str) -> None:
    """Whether that shows when it is measured or in any later comparison. Several calls for each evaluation help where
    values differ; where calls fail, an evaluation of several fails more often."""
    with adversary(how if how in ADVERSARIES else "none", LATER.get(how)):
        verdict, _ = ran(by_auto())
    found = check(verdict, "noise of calls")
    assert found.ok == (how == "none")
    assert (verdict.sureness is not None) == found.ok
    assert ("simulator.repeats to {count: " in found.text) == (not found.ok and how in ADVERSARIES)
    assert ("find out why" in found.text) == (how in LATER)
    proposed = remedies(found, Ran(by_auto(), ()))
    assert [remedy.kind for remedy in proposed] == (["calls"] if how in ADVERSARIES and not found.ok else [])


def test_no_chance_of_a_lower_case_is_stated_of_several_calls() -> None:
    with adversary("none"):
        verdict, _ = ran(by_auto(**REPEATS))
    assert check(verdict, "noise of calls").ok
    assert verdict.sureness is None


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("how", "stated"), [("none", True), ("seeded by time", False)])
def test_every_place_states_the_chance_or_none_does(
    how: str, stated: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    campaign, out = tmp_path / "campaign.json", tmp_path / "out"
    campaign.write_text(json.dumps(by_auto().document()), encoding="utf-8")
    files = {kind: tmp_path / f"run.{kind}" for kind in ("junit", "sarif", "summary")}
    options = [word for kind, path in files.items() for word in (f"--{kind}", str(path))]
    with adversary(how):
        invoke(["run", str(campaign), "--out", str(out), *options])
    sentence = "chance that another search of the same budget"
    texts = {kind: path.read_text(encoding="utf-8") for kind, path in files.items()}
    texts["result"] = (out / "result.json").read_text(encoding="utf-8")
    texts["printed"] = " ".join(capsys.readouterr().out.split())
    assert {place: sentence in text for place, text in texts.items()} == dict.fromkeys(texts, stated)


def test_a_clause_on_findings_that_are_not_all_polished_has_a_subject() -> None:
    """The simulator fails before they are: validation uses its budget."""
    asked = by_auto().document()
    asked["stages"] |= {"validate": {"neighbours": 20}, "findings": {}}
    asked["stages"]["search"][0]["evaluations"] = 1000
    with adversary("none", lambda call: FAILED if call.total > 1000 else OK):
        verdict, _ = ran(load_document(asked))
    assert ": validation used its " in check(verdict, "minimum").text
