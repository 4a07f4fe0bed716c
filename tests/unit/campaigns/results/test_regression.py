"""What has become of the findings of a baseline: every standing, the tolerance, the policy and its exit code."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree as Xml

import pytest
from hypothesis import given as given_
from hypothesis import strategies as st
from scipy.stats import hypergeom

from campaigns import Campaign, rules
from campaigns.asked.load import load_document
from campaigns.asked.problem import CampaignError
from campaigns.asked.regression import CallsThere
from campaigns.asked.spec import seedless
from campaigns.claims.spans import values
from campaigns.documents import canonical
from campaigns.results import Finding, Verdict
from campaigns.results.baselines import CannotCompare, with_baseline
from campaigns.results.finding import HalfStep, Validation
from campaigns.results.regression import FindingChange, Regression, Standing
from campaigns.results.stage import Reevaluated
from campaigns.results.validate import CaseBasin, Downhill, Line
from campaigns.results.verdict import Check, VerdictWord, headline
from campaigns.stages.baseline import BaselineResult
from clearance.cli._ended import EndedRun, by_policy, changes, code, exit_sentence
from clearance.cli._junit import junit
from clearance.cli._markdown import markdown
from clearance.testing.problems import Problem
from tests.given import verdict_evidence as given
from tests.given.case_campaigns import campaign, document
from tests.results import Marks
from worker.engine.stages.parts.repeated import of_values
from worker.evidence.verdicts.regression import regression

AT = {"vehicle.m": 6.0, "vehicle.J": 0.06}


def asked(*costs: float, difference: float = 0.0, there: float = 0.5, **changes: Any) -> Campaign:
    """Case 1 with a baseline whose findings have these costs; there: its threshold. That of this run is 0.5 m."""
    cases = [
        {"label": f"F{i}", "parameters": AT, "cost": cost, "difference": difference} for i, cost in enumerate(costs, 1)
    ]
    baseline = {"run": "R-0001", "digest": "0" * 64, "threshold": there, "cases": cases}
    return campaign(baseline=baseline, **changes)


def compared(
    before: tuple[float, ...],
    again: tuple[float | None, ...],
    now: tuple[float, ...],
    since: tuple[str | None, ...],
    basins: tuple[CaseBasin, ...] = (),
    checks: Sequence[Check] = (),
    nominal: float = given.NOMINAL,
    **changes: Any,
) -> Regression:
    """The comparison; before: costs in the baseline; again: on this model; now: of the findings of this run; since: the
    finding in the basin of each case; basins: what is known of them, nothing as in results of earlier versions;
    checks: of the verdict; nominal: the cost of the nominal case."""
    labels = [case.label for case in asked(*before).baseline.cases]  # type: ignore[union-attr]
    cases = [
        Reevaluated(
            label=label, index=i, parameters=AT, point=[1.0, 1.0], status="ok" if cost is not None else "failed",
            cost=cost, reason="" if cost is not None else "the state diverged",
        )
        for i, (label, cost) in enumerate(zip(labels, again, strict=True))
    ]  # fmt: skip
    found = [given.finding(cost).model_copy(update={"label": f"F{i}"}) for i, cost in enumerate(now, 1)]
    validated = given.validation(since=list(since), basins=list(basins))
    made = given.evidence(
        baseline=BaselineResult(run="R-0001", cases=cases), validation=validated, finding=found[0] if found else None,
        others=found[1:], nominal=given.nominal(nominal),
    )  # fmt: skip
    result = regression(Problem(asked(*before, **changes)), made, checks)
    assert result is not None
    return result


def one(before: float, again: float | None, now: float | None = None, **changes: Any) -> FindingChange:
    """The change of a baseline with one finding, in whose basin this run has a finding of cost `now`."""
    found = compared(
        (before,), (again,), () if now is None else (now,), ("F1" if now is not None else None,), **changes
    )
    (case,) = found.cases
    return case


@pytest.mark.parametrize(
    ("before", "again", "now", "standing", "change"),
    [
        (0.84, 0.84, 0.84, Standing.SAME, 0.0),
        (0.84, 0.80, 0.80, Standing.WORSE, -0.04),
        (0.84, 0.88, 0.88, Standing.BETTER, 0.04),
        (0.84, 0.88, None, Standing.BETTER, 0.04),
        # The same case is better, but its basin has a lower one than before, or as low.
        (0.84, 0.88, 0.80, Standing.WORSE, -0.04),
        (0.84, 0.88, 0.84, Standing.SAME, 0.0),
        # Two searches stop up to 1 % of nominal minus worst apart: 0.001 m of 0.1 m.
        (0.84, 0.84, 0.8395, Standing.SAME, -0.0005),
        (0.84, 0.84, 0.837, Standing.WORSE, -0.003),
        # What was measured needs no such allowance.
        (0.84, 0.8395, 0.8395, Standing.WORSE, -0.0005),
        (0.40, 0.60, 0.60, Standing.FIXED, 0.2),
        (0.40, 0.60, None, Standing.FIXED, 0.2),
        (0.40, 0.60, 0.45, Standing.BETTER, 0.05),
        (0.40, 0.60, 0.40, Standing.SAME, 0.0),
        # Whatever the tolerance, a violation that begins or ends is a change; at the threshold it violates.
        (0.500000001, 0.5, 0.5, Standing.WORSE, -1e-9),
        (0.5, 0.500000001, None, Standing.FIXED, 1e-9),
    ],
)
def test_a_finding_of_the_baseline_has_one_standing(
    before: float, again: float, now: float | None, standing: Standing, change: float
) -> None:
    case = one(before, again, now)
    assert (case.standing, case.before, case.now) == (standing, "F1", "F1" if now is not None else None)
    assert case.change == pytest.approx(change, abs=1e-12)
    assert case.margin_again == pytest.approx(again - 0.5)
    assert case.text.startswith(f"F1 of R-0001 is {'the same' if standing is Standing.SAME else standing}: d_min = ")


def test_nothing_is_fixed_while_its_basin_violates() -> None:
    first, second = compared((0.40, 0.45), (0.42, 0.55), (0.42,), ("F1", "F1")).cases
    assert (first.before, first.standing, second.before, second.standing) == (
        "F1",
        Standing.BETTER,
        "F2",
        Standing.BETTER,
    )
    assert values(second.statement)["lowest"] == 0.42
    clear = compared((0.40, 0.45), (0.52, 0.55), (0.51,), ("F1", "F1")).cases
    assert [case.standing for case in clear] == [Standing.FIXED, Standing.FIXED]


FELL = Downhill(position=3, index=17, cost=0.42)
PASSES = given.case("F1 of R-0001", 0.60)
"""The case of 0.6 m, confirmed by other means."""


def basin(lowest: float | None, **known: Any) -> CaseBasin:
    """What is known of the basin of a case that is confirmed."""
    return CaseBasin(lowest=lowest, **{"confirmed": PASSES, **known})


@pytest.mark.parametrize(
    ("now", "since", "there", "standing", "margin", "known"),
    [
        ((), None, basin(lowest=0.55), Standing.FIXED, 0.05, "0.55 m"),
        ((), None, basin(lowest=0.45), Standing.BETTER, -0.05, "0.45 m"),
        ((), None, basin(lowest=0.40), Standing.SAME, -0.1, "0.4 m"),
        ((), None, basin(lowest=0.30), Standing.WORSE, -0.2, "0.3 m"),
        ((0.55,), "F1", basin(lowest=0.55), Standing.FIXED, 0.05, "F1 "),
        ((0.55,), "F1", basin(lowest=0.55, violation=FELL), Standing.BETTER, 0.05, "17 of stage 3"),
        ((), None, basin(lowest=0.55, violation=FELL), Standing.BETTER, 0.05, "0.42 m"),
        ((0.55,), "F1", basin(lowest=0.55, not_compared=4), Standing.UNRESOLVED, 0.05, "4 stored violations"),
        ((), None, basin(lowest=None), Standing.UNRESOLVED, 0.1, " to descend"),
        ((), None, basin(lowest=None, violation=FELL), Standing.BETTER, 0.1, "0.42 m"),
    ],
)
def test_what_is_known_of_a_basin_decides_whether_it_is_fixed(
    now: tuple[float, ...], since: str | None, there: CaseBasin, standing: Standing, margin: float, known: str
) -> None:
    """Of a case that violated by 0.1 m and is clear by 0.1 m now."""
    found = compared((0.40,), (0.60,), now, (since,), (there,), regression={"fail_on": ["not_compared"]})
    (case,) = found.cases
    assert (case.standing, case.margin) == (standing, pytest.approx(margin))
    assert known in case.text.partition("; ")[2]
    assert case.fails == (standing is Standing.UNRESOLVED)
    told = case.text in " ".join(changes(concluded(found)))
    assert told == (standing is Standing.UNRESOLVED), "what was not examined is stated beside the counts"


def called(*values: float | None) -> Validation:
    """A case of 0.6 m of a simulator that does not repeat, with independent calls of these values."""
    calls = of_values(values, [], 0.5, 0.95)
    violates = calls.violating > 0
    ok = violates or not calls.failed
    return Validation(
        name="F1", step=None, cost=0.6, allowed=None, ok=ok, agrees=ok and not violates, violates=violates,
        repeats=calls,
    )  # fmt: skip


def halved(cost: float | None) -> Validation:
    """A case of 0.6 m that has another value at half the step."""
    half = HalfStep(step=0.0025, cost=cost, difference=None if cost is None else cost - 0.6)
    return given.case(cost=0.6, confirmed=False).model_copy(update={"half_step": half})


@pytest.mark.parametrize(
    ("confirmed", "why"),
    [
        (None, " to confirm"),
        (
            halved(0.45),
            " again it violates",
        ),
        (halved(0.8), " differs by more"),
        (halved(None), " no value"),
        (called(*[0.6] * 9, 0.4), " independent call"),
        (called(*[0.6] * 9, None), " no value"),
    ],
)
@pytest.mark.parametrize("now", [0.55, 0.45])
def test_what_is_not_confirmed_is_neither_fixed_nor_better(now: float, confirmed: Validation | None, why: str) -> None:
    """Whether its basin is clear or has a milder violation; the usual policy fails, as where it is not compared."""
    found = compared((0.40,), (0.60,), (now,), ("F1",), (basin(now, confirmed=confirmed),))
    (case,) = found.cases
    assert (case.standing, case.fails) == (Standing.UNRESOLVED, True)
    assert why in case.text
    accepting = compared(
        (0.40,), (0.60,), (now,), ("F1",), (basin(now, confirmed=confirmed),), regression={"fail_on": ["new"]}
    )
    assert not accepting.cases[0].fails


@pytest.mark.parametrize(
    ("made", "low", "here", "differ"),
    [
        (10, 10, 10, True),
        (10, 4, 10, True),
        (10, 3, 10, False),
        (10, 1, 10, False),
        (10, 0, 10, False),
        (10, 1, 190, True),
        (10, 1, 189, False),
    ],
)
def test_calls_of_both_runs_differ_beyond_chance(made: int, low: int, here: int, differ: bool) -> None:
    """By Fisher's exact test at 5 %; of a violation of 1 in 10 calls, 10 clear ones show nothing."""
    there = CallsThere(made=made, low=[0.4] * low)
    chance = hypergeom(made + here, low, made).sf(low - 1) if low else 1.0
    assert there.differ(here, 0.5) is differ is bool(chance <= 0.05 + 1e-12)
    assert not there.differ(here, 0.3), "by the threshold of this run none violated"


@pytest.mark.parametrize(
    ("there", "cost", "standing", "new"),
    [
        (0.3, 0.40, Standing.WORSE, True),  # it violated nothing there, and does now
        (0.3, 0.29, Standing.SAME, False),
        (0.7, 0.60, Standing.SAME, False),  # a lower threshold mends nothing
        (0.7, 0.40, Standing.SAME, False),
    ],
)
def test_a_case_violated_in_the_baseline_by_the_threshold_of_its_run(
    there: float, cost: float, standing: Standing, new: bool
) -> None:
    """The same value in both runs, of which only the thresholds differ."""
    found = compared((cost,), (cost,), (cost,), ("F1",), there=there)
    (case,) = found.cases
    assert (case.standing, case.newly_violating, case.fails) == (standing, new, new)
    assert found.ok != new
    assert not (found.accepted and new)
    assert [f"{limit:g}" in found.text for limit in (there, 0.5)] == [True, True]
    lost = one(cost, None, there=there)
    assert lost.fails == (cost <= max(there, 0.5)), "other bounds hide no violation of either threshold"


@pytest.mark.parametrize(("there", "before", "now"), [(0.3, 0.40, 0.60), (0.7, 0.60, 0.80)])
def test_what_violates_by_one_threshold_only_is_not_fixed(there: float, before: float, now: float) -> None:
    assert one(before, now, now, there=there).standing == Standing.BETTER


def test_cases_in_one_basin_that_is_not_listed_have_one_representative() -> None:
    basins = (basin(0.35), basin(0.35))
    first, second = compared((0.40, 0.45), (0.60, 0.60), (), (None, None), basins).cases
    assert (first.standing, second.standing) == (Standing.WORSE, Standing.BETTER)


@pytest.mark.nightly
@given_(
    st.lists(st.tuples(st.floats(0.3, 0.7), st.floats(0.3, 0.7), st.booleans()), min_size=1, max_size=5),
    st.floats(0.3, 0.7),
)
def test_fixed_means_that_nothing_known_in_its_basin_violates(
    rows: list[tuple[float, float, bool]], low: float
) -> None:
    """Several findings of the baseline, some of them in the basin of this run's finding, which is its lowest."""
    inside = [again for _, again, there in rows if there]
    now = (min([low, *inside]),) if inside else ()
    since = tuple("F1" if there else None for *_, there in rows)
    found = compared(tuple(b for b, *_ in rows), tuple(a for _, a, _ in rows), now, since)
    for case in found.cases:
        violates = min([*now, 0.7] if case.now else [case.margin_again or 0.0]) <= (0.5 if case.now else 0.0)
        assert case.standing is not Standing.FIXED or not violates, case.text


def test_the_tolerance_is_the_largest_of_what_cannot_be_resolved() -> None:
    assert one(0.84, 0.8395, 0.8395, regression={"tolerance": 0.001}).standing is Standing.SAME
    assert one(0.84, 0.8395, 0.8395, regression={"tolerance": 0.0001}).standing is Standing.WORSE
    floor = one(0.84, 0.84 - 5e-7, 0.84)
    assert (floor.standing, floor.tolerance) == (Standing.SAME, pytest.approx(0.84e-6))
    cases = [Reevaluated(label="F1", index=0, parameters=AT, point=[1.0, 1.0], status="ok", cost=0.83)]
    baseline = BaselineResult(run="R-0001", cases=cases)
    noisy = given.evidence(baseline=baseline, validation=given.validation(since=[None]), finding=None)
    found = regression(Problem(asked(0.84, difference=0.02)), noisy, ())
    assert found is not None
    assert (found.cases[0].standing, found.cases[0].tolerance) == (Standing.SAME, 0.02)


@pytest.mark.parametrize("nominal", [given.NOMINAL, 10.0, 1e6, 1e12])
@pytest.mark.parametrize(
    ("before", "again", "now", "standing"),
    [
        (0.84, 0.55, 0.55, Standing.WORSE),
        (0.84, 0.84 - 1e-5, 0.84 - 1e-5, Standing.WORSE),
        (0.84, 0.84, 0.80, Standing.WORSE),
        (0.45, 0.35, 0.35, Standing.WORSE),
        (0.45, 0.55, None, Standing.FIXED),
        (0.84, 0.84 - 5e-7, 0.84 - 5e-7, Standing.SAME),
        # A margin of 1 um: what is rounding for 0.5 m is half of it.
        (0.500001, 0.5000006, 0.5000006, Standing.WORSE),
        (0.500001, 0.500001, 0.5000006, Standing.WORSE),
        (0.499999, 0.4999986, 0.4999986, Standing.WORSE),
    ],
)
def test_no_change_is_hidden_by_what_the_nominal_case_returns(
    before: float, again: float, now: float | None, standing: Standing, nominal: float
) -> None:
    """A simulator may return a large value where nothing is met."""
    assert one(before, again, now, nominal=nominal).standing is standing


@pytest.mark.parametrize("nominal", [given.NOMINAL, 1e6])
def test_a_ridge_separates_a_violation_from_a_known_one_whatever_the_nominal_case_returns(nominal: float) -> None:
    line = Line(end=[1.0, 1.0], highest=0.5 + 1e-3)
    basin = CaseBasin(lowest=0.4, line=line)
    found = compared((0.4,), (0.4,), (0.4,), ("F1",), (basin,), nominal=nominal)
    assert {case.standing for case in found.cases} == {Standing.SAME, Standing.NEW}
    assert not found.accepted


def test_a_new_finding_and_one_without_a_value_are_named() -> None:
    found = compared((0.84, 0.9), (0.84, None), (0.80, 0.84), ("F2", None))
    assert [(c.before, c.now, c.standing) for c in found.cases] == [
        (None, "F1", Standing.NEW),
        ("F1", "F2", Standing.SAME),
        ("F2", None, Standing.NOT_COMPARED),
    ]
    assert [found.cases[0].text, found.cases[2].text, found.text] == [
        "F1 is new: no finding of R-0001 is in its basin; d_min = 0.8 m, a margin of +0.3 m",
        "F2 of R-0001 is not compared: the state diverged",
        "Changes of the findings since R-0001: 1 new, 1 same, 1 not compared. No change fails the policy of "
        "the campaign.",
    ]
    assert found.counts() == {Standing.NEW: 1, Standing.SAME: 1, Standing.NOT_COMPARED: 1}


@pytest.mark.parametrize(
    ("before", "fail_on", "fails"),
    [
        (0.40, None, True),
        (0.50, None, True),
        (0.84, None, False),
        (0.40, ["new_violation", "new", "worse"], False),
        (0.84, ["not_compared"], True),
        (0.40, ["violation"], True),
    ],
)
def test_what_is_not_compared_does_not_hide_a_known_violation(
    before: float, fail_on: list[str] | None, fails: bool
) -> None:
    """The author of a change may otherwise exclude the worst case by other bounds."""
    policy = {} if fail_on is None else {"regression": {"fail_on": fail_on}}
    found = compared((before, 0.9), (None, 0.9), (0.9,), (None, "F1"), **policy)
    assert [(c.before, c.standing, c.fails) for c in found.cases if c.standing is Standing.NOT_COMPARED] == [
        ("F1", Standing.NOT_COMPARED, fails)
    ]
    assert found.ok is not fails


def test_of_several_findings_of_the_baseline_in_one_basin_the_lowest_represents_it() -> None:
    same = compared((0.40, 0.84), (0.40, 0.84), (0.40,), ("F1", "F1"))
    assert [(c.before, c.standing, c.newly_violating) for c in same.cases] == [
        ("F1", Standing.SAME, False),
        ("F2", Standing.SAME, False),
    ]
    lower = compared((0.80, 0.84), (0.80, 0.84), (0.70,), ("F1", "F1"))
    assert [(c.before, c.standing) for c in lower.cases] == [("F1", Standing.WORSE), ("F2", Standing.SAME)]
    measured = compared((0.80, 0.84), (0.80, 0.70), (0.70,), ("F1", "F1"))
    assert {c.before: c.standing for c in measured.cases} == {"F1": Standing.WORSE, "F2": Standing.WORSE}


POLICIES = {
    "violation": {"fail_on": ["violation"]},
    "usual": {},
    "new": {"fail_on": ["violation", "new"]},
    "worse": {"fail_on": ["violation", "worse"]},
    "known violations": {"fail_on": ["new_violation"]},
    "nothing": {"fail_on": []},
}


@pytest.mark.parametrize(
    ("policy", "word", "before", "again", "now", "since", "exits"),
    [
        ("usual", "cleared", (0.84,), (0.84,), (0.84,), ("F1",), 0),
        ("usual", "cleared", (0.84,), (0.80,), (0.80,), ("F1",), 0),
        ("worse", "cleared", (0.84,), (0.80,), (0.80,), ("F1",), 1),
        ("worse", "inconclusive", (0.84,), (0.80,), (0.80,), ("F1",), 1),
        ("worse", "inconclusive", (0.84,), (0.84,), (0.84,), ("F1",), 2),
        ("new", "cleared", (0.84,), (0.84,), (0.80, 0.84), ("F2",), 1),
        ("usual", "cleared", (0.84,), (0.84,), (0.80, 0.84), ("F2",), 0),
        # A new violation that validation did not confirm: the verdict is inconclusive, the policy fails.
        ("usual", "inconclusive", (0.84,), (0.84,), (0.40, 0.84), ("F2",), 1),
        ("violation", "inconclusive", (0.84,), (0.84,), (0.40, 0.84), ("F2",), 2),
        ("usual", "violated", (0.40,), (0.40,), (0.40,), ("F1",), 1),
        ("known violations", "violated", (0.40,), (0.40,), (0.40,), ("F1",), 0),
        ("known violations", "violated", (0.84,), (0.40,), (0.40,), ("F1",), 1),
        ("known violations", "violated", (0.84,), (0.84,), (0.40, 0.84), ("F2",), 1),
        # A violation that nobody knew is not accepted, whatever the policy leaves out.
        ("nothing", "violated", (0.84,), (0.84,), (0.40, 0.84), ("F2",), 1),
        ("nothing", "violated", (0.40,), (0.40,), (0.40,), ("F1",), 0),
        # The verdict is violated by what no finding represents: nobody has compared it.
        ("known violations", "violated", (0.84,), (0.84,), (0.84,), ("F1",), 1),
    ],
)
def test_the_exit_code_is_that_of_the_verdict_and_the_policy(
    policy: str, word: str, before: Any, again: Any, now: Any, since: Any, exits: int
) -> None:
    found = compared(before, again, now, since, regression=POLICIES[policy])
    verdict = concluded(found, word)
    assert code(verdict) == exits
    usual = {"cleared": 0, "violated": 1, "inconclusive": 2}[word]
    assert bool(exit_sentence(verdict)) == (exits != usual)
    assert found.ok == (not found.failing)
    if exits == 0 and word == "violated":
        assert " R-0001, " in exit_sentence(verdict)


@pytest.mark.parametrize("rule", rules.RULES, ids=lambda rule: rule.code)
def test_known_violations_are_accepted_only_where_no_other_check_fails(rule: rules.Rule) -> None:
    checks = [Check(code=rule.code, ok=False, statement=())]
    found = compared((0.4,), (0.4,), (0.4,), ("F1",), checks=checks, regression=POLICIES["nothing"])
    verdict = concluded(found, "violated")
    # Of its sample none violates, and a closed loop makes no calls: violations are not why these fail.
    accepted = rule.of_violations and rule.code not in ("probability", "target", "noise of calls")
    assert code(verdict) == (0 if accepted else 1)
    assert (f"({rule.title})" in found.text) == (not accepted)


def test_where_all_listed_findings_violate_none_is_accepted_because_there_may_be_more() -> None:
    for most, accepted in ((3, False), (4, True)):
        stages = {"stages__findings": {"at_most": most}}
        asked = (0.4, 0.41, 0.42), (0.4, 0.41, 0.42), (0.4, 0.41, 0.42), ("F1", "F2", "F3")
        found = compared(*asked, regression=POLICIES["nothing"], **stages)
        assert found.accepted == accepted
        assert (f"{most} findings" in found.text) == (not accepted)


def concluded(found: Regression | None, word: str = "cleared") -> Verdict:
    made = given.concluded()
    return made.model_copy(update={"verdict": VerdictWord(word), "regression": found})


def test_without_a_baseline_nothing_is_stored_and_the_digests_stay() -> None:
    verdict = given.concluded()
    assert verdict.regression is None
    assert "regression" not in verdict.model_dump()
    assert not {"regression", "baseline"} & campaign().document().keys()
    assert campaign(regression={}).digest == campaign().digest
    assert campaign(regression={"fail_on": ["violation", "new_violation"]}).digest == campaign().digest
    changed = campaign(regression={"fail_on": ["worse"]})
    assert changed.digest != campaign().digest
    assert load_document(json.loads(canonical(changed.document()))) == changed
    assert seedless(asked(0.84).document()) != seedless(campaign().document()), "it evaluates something else"


@pytest.mark.parametrize(
    ("policy", "statement"),
    [
        ({"fail_on": ["worst"]}, "'violation', 'new_violation', 'new', 'worse' or 'not_compared'"),
        ({"tolerance": -1}, "of at least 0"),
        ({"tolerance": "5 %"}, "expected a number"),
        ({"fail": ["new"]}, "unknown key"),
    ],
)
def test_a_bad_policy_is_named(policy: dict[str, Any], statement: str) -> None:
    with pytest.raises(CampaignError) as refused:
        campaign(regression=policy)
    assert statement in str(refused.value)
    assert "regression" in refused.value.problems[0].field


@pytest.mark.parametrize(
    ("change", "statement"),
    [
        ({"cases": []}, "at least 1 entry"),
        ({"cases": [{"label": "F1", "parameters": {}, "cost": 1.0}]}, "at least 1 entry"),
        ({"cases": [{"label": "nominal", "parameters": AT, "cost": 1.0}]}, "text of the form"),
        ({"cases": [{"label": "F1", "parameters": AT, "cost": float("nan")}]}, "finite"),
        ({"cases": [{"label": "F1", "parameters": AT, "cost": 1.0, "realisation": 2**64}]}, "realisation"),
        ({"cases": [{"label": "F1", "parameters": AT, "cost": 1.0, "point": [2.0]}]}, "at most 1"),
        ({"cases": [{"label": "F1", "parameters": AT, "cost": 1.0}] * 2}, "F1 is given twice"),
        ({"digest": "main"}, "text of the form"),
        ({"run": "R-0001\n"}, "one line of readable text"),
        ({"colour": "x"}, "unknown key"),
    ],
)
def test_a_hostile_baseline_is_refused_by_field(change: dict[str, Any], statement: str) -> None:
    given_baseline = document(baseline=asked(0.84).document()["baseline"] | change)
    with pytest.raises(CampaignError) as refused:
        load_document(given_baseline)
    assert refused.value.problems[0].field.startswith("baseline")
    assert statement in str(refused.value)


def test_a_baseline_point_of_another_dimension_is_not_used() -> None:
    """The parameters count; the point only saves the last bit where the bounds are the same."""
    baseline = asked(0.84).document()["baseline"]
    baseline["cases"][0]["point"] = [0.5]
    assert campaign(baseline=baseline).baseline is not None


def findings() -> list[Finding]:
    return [given.finding(0.84, parameters=AT, point=[1.0, 1.0])]


def test_a_baseline_has_the_findings_of_the_run_to_the_bit() -> None:
    (found,) = findings()
    found = found.model_copy(update={"cost": 0.1 + 0.2 + 1e-17, "parameters": {"vehicle.m": 4.1 + 1e-15}})
    made = with_baseline(campaign(), "R-0001", campaign(), [found])
    again = load_document(json.loads(canonical(made.document())))
    assert again.baseline is not None
    (case,) = again.baseline.cases
    assert (case.cost, case.parameters, case.point) == (found.cost, found.parameters, [1.0, 1.0])
    assert again.baseline.digest == campaign().digest


OTHER_CRITERION = {"criterion": {"component": "goal_miss", "threshold": 0.5}}


@pytest.mark.parametrize(
    ("other", "found", "statement"),
    [
        (OTHER_CRITERION, 1, "its criterion is goal_miss, here it is separation; a comparison needs the same"),
        ({"uncertain": {"start.x": {"low": 0.0, "high": 1.0}}}, 1, "it varies none of the parameters of this campaign"),
        ({}, 0, "it has no findings to compare with; give another run"),
    ],
)
def test_a_run_that_cannot_be_a_baseline_is_refused(other: dict[str, Any], found: int, statement: str) -> None:
    with pytest.raises(CannotCompare) as refused:
        with_baseline(campaign(), "R-0001", campaign(**other), findings()[:found])
    assert str(refused.value).startswith("R-0001 ")
    assert statement in str(refused.value)


def test_a_run_of_a_simulator_is_foreign_to_one_of_a_scenario() -> None:
    simulated = document()
    del simulated["scenario"]
    simulated |= {"simulator": {"name": "drop"}, "criterion": {"result": "d_min", "threshold": 0.5}}
    with pytest.raises(CannotCompare, match=r"^R-0001 .* a simulator, .* a scenario"):
        with_baseline(campaign(), "R-0001", load_document(simulated), findings())


def test_another_threshold_and_other_bounds_are_what_is_compared() -> None:
    other = campaign(criterion__threshold=0.4, uncertain={"vehicle.m": {"low": 4.0, "high": 5.0}})
    made = with_baseline(campaign(), "R-0001", other, findings())
    assert made.baseline is not None
    assert made.baseline.threshold == 0.4


def ended(found: Regression | None, word: str = "cleared", **changes: Any) -> EndedRun:
    known = {"run": "R-0007", "campaign": "Case <1> & more", "state": "done", "verdict": concluded(found, word)}
    known |= {"link": "http://127.0.0.1:8000/runs/R-0007", "replay": "clearance replay R-0007"}
    return EndedRun(**(known | {"labels": {"branch": "feature|x"}} | changes))


def test_a_failure_in_junit_has_parameters_link_and_replay_command() -> None:
    found = compared((0.84, 0.9), (0.80, None), (0.70, 0.80), ("F2", None), regression={"fail_on": ["new", "worse"]})
    suite = Xml.fromstring(junit(ended(found)))[0]
    assert {k: suite.get(k) for k in ("tests", "failures", "errors", "skipped")} == {
        "tests": "18", "failures": "2", "errors": "0", "skipped": "1",
    }  # fmt: skip
    cases = {case.get("name"): case for case in suite.findall("testcase")}
    others = [name for name in cases if ":" not in str(name)]
    assert others == ["verdict", "new finding F1", "F1 of the baseline", "F2 of the baseline"]
    worse = cases["F1 of the baseline"].find("failure")
    assert worse is not None
    assert worse.get("type") == "worse"
    assert worse.get("message") == next(case.text for case in found.cases if case.standing is Standing.WORSE)
    assert str(worse.text).splitlines()[1:] == [
        "vehicle.m = 6.0",
        "vehicle.J = 0.06",
        "http://127.0.0.1:8000/runs/R-0007",
        "clearance replay R-0007 1:0",
    ]
    new = cases["new finding F1"].find("failure")
    assert new is not None
    assert str(new.text).splitlines()[-1] == "clearance replay R-0007 F1"
    lost = cases["F2 of the baseline"].find("skipped")
    assert lost is not None
    assert lost.get("message") == next(c.text for c in found.cases if c.standing is Standing.NOT_COMPARED)
    properties = {p.get("name"): p.get("value") for p in suite.iter("property")}
    assert properties["label.branch"] == "feature|x"


@pytest.mark.parametrize(
    ("changes", "tag", "statement"),
    [
        (
            {"state": "failed", "verdict": None, "error": "a\x00b\ud800 <c>"},
            "error",
            "no verdict: failed: a\ufffdb\ufffd <c>",
        ),
        ({"state": "cancelled", "verdict": None}, "error", "no verdict: cancelled"),
        ({"compared": False, "notes": ("No baseline: none.",)}, "skipped", "No baseline: none."),
    ],
)
def test_junit_reports_what_is_missing(changes: dict[str, Any], tag: str, statement: str) -> None:
    (found,) = Xml.fromstring(junit(ended(None, **changes))).iter(tag)
    assert found.get("message") == statement


@pytest.mark.parametrize("word", ["violated", "inconclusive"])
def test_junit_fails_by_the_verdict(word: str) -> None:
    suite = Xml.fromstring(junit(ended(None, word)))[0]
    failure = next(case for case in suite if case.get("name") == "verdict")[0]
    assert (failure.tag, failure.get("type")) == ("failure", word)
    assert str(failure.text).endswith("clearance replay R-0007 F1")


def test_the_summary_is_markdown_in_which_no_text_is_markup() -> None:
    found = compared((0.84,), (0.80,), (0.80,), ("F1",), regression={"fail_on": ["worse"]})
    text = markdown(ended(found, notes=("<img src=x> [a](b) | `c`",)))
    first, _, second = text.splitlines()[:3]
    assert first == f"## ❌ Case \\<1\\> &amp; more: exit code 1: {by_policy(concluded(found, 'cleared'))}"
    assert second.startswith(f"**{headline('Cleared', Marks(), 'fails', None)}**, ")
    assert "\\<img src=x\\> \\[a\\](b) \\| \\`c\\`" in text
    assert "branch = feature\\|x" in text
    (row,) = [line for line in text.splitlines() if line.startswith("| F1 of")]
    assert row == "| F1 of R-0001 | **worse** | +0.34 | +0.3 | +0.3 | \u22120.04 | `clearance replay R-0007 1:0` |"


def test_junit_has_a_case_for_the_criterion_each_requirement_and_each_check() -> None:
    stated = {"quantity": "separation", "requirements": ("REQ-1", "SYS 2")}

    def cases(word: str, found: Regression | None = None, **changes: Any) -> dict[str, list[str]]:
        suite = Xml.fromstring(junit(ended(found, word, **(stated | changes))))[0]
        return {str(case.get("name")): [child.tag for child in case] for case in suite}

    names = ["criterion: separation", "requirement: REQ-1", "requirement: SYS 2"]
    for word, tags in (
        ("cleared", ["system-out"] * 3),
        ("violated", ["failure"] * 3),
        ("inconclusive", ["skipped", "failure", "failure"]),
    ):
        found = cases(word)
        assert [found[name] for name in names] == [[tag] for tag in tags], word
    missing = cases("cleared", verdict=None, state="failed")
    assert [missing.get(name) for name in names] == [None, ["error"], ["error"]]
    known = compared((0.3,), (0.3,), (0.3,), ("F1",), regression={"fail_on": ["new_violation"]})
    assert known.accepted
    accepted = cases("violated", known)
    assert [accepted[name] for name in names] == [["skipped"]] * 3, "accepted, and not met"
