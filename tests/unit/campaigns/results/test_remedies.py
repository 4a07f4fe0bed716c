"""Remedies: changes of the campaign that a failing check offers for the next run; every one gives a valid campaign."""

from __future__ import annotations

import math
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.sample_bound import bound, needed
from campaigns.catalogue import MethodEntry
from campaigns.claims.say import number, say
from campaigns.codes import CheckCode
from campaigns.results import SearchResult
from campaigns.results.base import Stop
from campaigns.results.remedies import Ran, Remedy, applied, remedies
from campaigns.results.verdict import Check, Statistics, VerdictWord
from campaigns.results.verdicts import described
from tests.given.case_campaigns import campaign
from tests.given.stated_facts import facts
from tests.given.verdict_evidence import WORST, case, concluded, encountered, finding, search, validation
from worker.engine.stages.parts.claims import bound as reference
from worker.running.catalogue.installed import catalogue

DIRECT = {"method": "direct", "evaluations": 1000}
SIMULATED = {
    "name": "A simulator",
    "simulator": {"name": "drop"},
    "uncertain": {"simulator.mass": {"low": 1, "high": 4}},
    "criterion": {"result": "separation", "threshold": 1},
    "stages": {"search": [DIRECT], "certify": None},
}


def failing(code: str, **values: float) -> Check:
    statement = [number(value, "s", name) for name, value in values.items()]
    return Check(code=code, ok=False, statement=say("it does not hold ", *statement))


def ran(asked: Campaign, *results: SearchResult, statistics: Statistics | None = None) -> Ran:
    found = results or tuple(search("direct") for _ in asked.stages.search)
    return Ran(asked, found, statistics, catalogue().methods)


def searching(*searches: dict[str, Any], **changes: Any) -> Campaign:
    return campaign(stages__search=list(searches), **changes)


def only(found: list[Remedy]) -> Remedy:
    (remedy,) = found
    return remedy


def again(asked: Campaign, *found: Remedy) -> Campaign:
    changed = applied(asked, found)
    assert changed is not None
    assert changed.digest != asked.digest
    return changed


def test_disagreeing_integrations_ask_for_half_the_step() -> None:
    asked = campaign(scenario__step=0.02)
    remedy = only(remedies(failing(CheckCode.VALIDATION), ran(asked)))
    assert (remedy.kind, remedy.text) == ("step", "with step 10 ms")
    assert again(asked, remedy).given_scenario.step == 0.01


def test_an_obstacle_that_turns_too_fast_asks_for_a_step_that_follows_it() -> None:
    asked = campaign(scenario__step=0.02)
    remedy = only(remedies(failing(CheckCode.SAMPLING, largest=0.0061), ran(asked)))
    assert again(asked, remedy).given_scenario.step == 0.005


def test_an_encounter_after_the_horizon_asks_for_one_that_holds_it() -> None:
    asked = campaign(scenario__horizon=10.0)
    remedy = only(remedies(failing(CheckCode.CLOSEST_APPROACH, horizon=10.0, after=12.0), ran(asked)))
    assert again(asked, remedy).given_scenario.horizon == pytest.approx(33.0)


def test_an_encounter_cut_off_asks_for_a_longer_horizon_of_whole_periods() -> None:
    asked = campaign(scenario__horizon=15.0, scenario__step=0.005, scenario__guidance={"period": 0.4})
    late = failing(CheckCode.CLOSEST_APPROACH, horizon=15.0)
    asked = campaign(scenario__horizon=14.8, scenario__step=0.005, scenario__guidance={"period": 0.4})
    remedy = only(remedies(late, ran(asked)))
    assert again(asked, remedy).given_scenario.horizon == pytest.approx(22.4)
    assert remedies(failing(CheckCode.CLOSEST_APPROACH), ran(asked)) == [], "it is at the start: no number helps"


def test_a_method_that_used_its_budget_up_asks_for_more() -> None:
    asked = searching({"method": "direct", "evaluations": 1250}, {"method": "ga", "evaluations": 1250})
    found = remedies(failing(CheckCode.AGREEMENT), ran(asked, search("direct"), search("ga")))
    remedy = only(found)
    assert facts(remedy.statement) == [5000, "direct", "ga"]
    assert [each.evaluations for each in again(asked, remedy).stages.search] == [5000, 5000]


def test_methods_that_ended_by_their_own_rule_ask_for_another_method() -> None:
    asked = searching(DIRECT, {"method": "ga", "evaluations": 2000})
    done = Stop(kind="rule", text="no box is left")
    found = remedies(failing(CheckCode.AGREEMENT), ran(asked, search("direct", stop=done), search("ga", stop=done)))
    added = again(asked, *found).stages.search
    assert [each.method for each in added] == ["direct", "ga", "auto"]
    assert added[2].evaluations == 2000


def test_a_single_global_method_asks_for_evaluations_and_for_a_second_one() -> None:
    asked = searching(DIRECT)
    found = remedies(failing(CheckCode.AGREEMENT), ran(asked, search("direct")))
    assert [each.kind for each in found] == ["evaluations", "method"]
    both = again(asked, *found)
    assert [(each.method, each.evaluations) for each in both.stages.search] == [("direct", 4000), ("auto", 1000)]


@pytest.mark.parametrize("entry", [m for m in catalogue().methods if m.confirms], ids=lambda entry: entry.name)
@pytest.mark.parametrize("evaluations", [1, 30, 60, 200])
def test_a_method_whose_parts_confirm_each_other_has_what_they_need(entry: MethodEntry, evaluations: int) -> None:
    """As a search that is repeated, by itself or with another one, and as the only global one."""
    alone = {"method": entry.name, "evaluations": evaluations}
    for others in ([], [{"method": "ga", "evaluations": 1000}], [{"method": "sqp", "evaluations": evaluations}]):
        asked = searching(alone, *others)
        results = [search(each.method, evaluations=each.evaluations) for each in asked.stages.search]
        found = remedies(failing(CheckCode.AGREEMENT), ran(asked, *results))
        least = entry.confirms * len(asked.uncertain)
        wanted = again(asked, *found).stages.search[0].evaluations
        assert wanted == max(4 * evaluations, least)
        changed = {change.value for change in found[0].changes}
        stated = {value for value in facts(found[0].statement) if not isinstance(value, str)}
        assert stated == (changed if len(changed) == 1 else set())
        assert ("4 times" in found[0].text) == (len(changed) > 1 and wanted == 4 * evaluations)
    local = searching({"method": "sqp", "evaluations": evaluations})
    added = again(local, *remedies(failing(CheckCode.AGREEMENT), ran(local, search("sqp"))))
    assert added.stages.search[-1].method == entry.name
    assert added.stages.search[-1].evaluations >= entry.confirms * len(local.uncertain)


def test_no_global_method_asks_for_one() -> None:
    asked = searching({"method": "sqp", "evaluations": 300})
    found = remedies(failing(CheckCode.AGREEMENT), ran(asked, search("sqp")))
    assert [each.method for each in again(asked, *found).stages.search] == ["sqp", "auto"]


def test_a_bound_above_the_target_asks_for_the_sample_that_would_meet_it() -> None:
    asked = campaign(target_probability=0.002, stages__certify={"samples": 1000})
    upper = bound(0, 1000, 0.95)
    stated = Statistics(source="certify", samples=1000, violations=0, confidence=0.95, upper_bound=upper)
    remedy = only(remedies(failing(CheckCode.TARGET), ran(asked, statistics=stated)))
    assert remedy.text == "with 1\u202f500 samples"
    certify = again(asked, remedy).stages.certify
    assert certify is not None
    assert bound(0, certify.samples, 0.95) <= 0.002


def test_no_sample_meets_a_target_below_the_observed_fraction() -> None:
    asked = campaign(target_probability=0.002, stages__certify={"samples": 1000})
    stated = Statistics(
        source="certify", samples=1000, violations=900, confidence=0.95, upper_bound=bound(900, 1000, 0.95)
    )
    assert remedies(failing(CheckCode.TARGET), ran(asked, statistics=stated)) == []
    tails = Statistics(
        source="certify", samples=1000, violations=0, confidence=0.95, upper_bound=0.003 + bound(0, 1000, 0.95)
    )
    assert remedies(failing(CheckCode.TARGET), ran(asked, statistics=tails)) == [], "the tails alone exceed it"


@pytest.mark.parametrize(("violations", "samples"), [(0, 10), (1, 59), (30, 3000), (2999, 3000), (5, 5), (0, 0)])
def test_the_bound_is_that_of_the_worker(violations: int, samples: int) -> None:
    assert bound(violations, samples, 0.95) == pytest.approx(reference(violations, samples, 0.95), rel=1e-9)


def test_a_bound_of_many_violations_sums_few_terms(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the largest term is too small for a number."""
    calls, lgamma = 0, math.lgamma

    def counted(value: float) -> float:
        nonlocal calls
        calls += 1
        return lgamma(value)

    monkeypatch.setattr(math, "lgamma", counted)
    assert bound(100_000, 1_000_000, 0.95) == pytest.approx(reference(100_000, 1_000_000, 0.95), rel=1e-6)
    assert calls < 1_000_000


def test_a_needed_sample_has_the_bound_and_is_not_far_beyond_it() -> None:
    assert needed(0, 0, 0.05, 0.95) == 59
    for violations, samples, goal in ((3, 100, 0.05), (30, 3000, 0.011), (0, 3000, 1e-4)):
        size = needed(violations, samples, goal, 0.95)
        assert size is not None
        assert bound(-(-violations * size // max(samples, 1)), size, 0.95) <= goal
    assert needed(0, 3000, 1e-9, 0.95) is None
    assert needed(0, 3000, 0.0, 0.95) is None


def test_a_target_without_a_sample_asks_for_one() -> None:
    asked = campaign(target_probability=0.01, stages__certify=None)
    remedy = only(remedies(failing(CheckCode.TARGET), ran(asked)))
    assert facts(remedy.statement) == [300]


def test_noise_asks_for_the_worst_realisation_or_a_sample() -> None:
    mean = campaign(scenario__realisations={"seeds": [0, 1], "combine": "mean"}, stages__certify=None)
    assert again(mean, *remedies(failing(CheckCode.NOISE), ran(mean))).given_scenario.realisations.combine == "worst"
    stated = campaign(stages__certify=None)
    assert again(stated, *remedies(failing(CheckCode.NOISE), ran(stated))).stages.certify is not None


def test_a_simulator_that_does_not_repeat_asks_for_several_calls() -> None:
    asked = Campaign.model_validate(SIMULATED)
    remedy = only(remedies(failing(CheckCode.CALLS, repeats=5), ran(asked)))
    changed = again(asked, remedy)
    assert changed.simulator is not None
    assert (changed.simulator.calls, changed.simulator.combine) == (5, "worst")
    assert only(remedies(failing(CheckCode.CALLS), ran(changed))).kind == "sample"


@pytest.mark.parametrize("code", [code for code in CheckCode if code not in ("agreement", "validation")])
def test_a_check_that_holds_has_no_remedy(code: CheckCode) -> None:
    assert remedies(Check(code=code, ok=True, statement=say("it holds")), ran(campaign())) == []


@pytest.mark.parametrize("code", ["nominal", "motion", "distances", "exclusions", "evaluations", "of another package"])
def test_what_no_number_settles_has_no_remedy(code: str) -> None:
    assert remedies(failing(code), ran(campaign())) == []


def test_a_change_that_would_not_be_valid_is_not_offered() -> None:
    finest = campaign(scenario__horizon=15.0, scenario__step=15.0 / 2_000_000)
    assert remedies(failing(CheckCode.VALIDATION), ran(finest)) == []


def test_the_checks_of_a_real_verdict_carry_them() -> None:
    """Sentences as the worker writes them, read by their codes and names."""
    asked = campaign()
    late = encountered(closest={"time": 15.0, "at": "end", "obstacle": 0})
    wrong = validation(encounter=late, ok=False, nominal=case("nominal", 0.94, confirmed=False))
    stated = concluded(validation=wrong, searches=[search("direct"), search("sqp", WORST)], finding=finding())
    assert stated.verdict is VerdictWord.INCONCLUSIVE
    results = Ran(asked, [search("direct") for _ in asked.stages.search], stated.statistics, catalogue().methods)
    found = {check.name: check.remedies for check in described(stated.checks, 0, results)}
    assert only(found["validation"]).kind == "step"
    assert only(found["closest approach"]).kind == "horizon"
    assert found["motion"] == []
    assert all(check.remedies == [] for check in described(stated.checks, 0))
