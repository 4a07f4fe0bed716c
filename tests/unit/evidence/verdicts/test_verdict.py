"""Every rule of the verdict, one test each, on evidence written out by hand."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given as given_
from hypothesis import settings
from hypothesis import strategies as st

from campaigns.claims.wording import WORDING
from campaigns.codes import CheckCode
from campaigns.results.base import Status
from campaigns.results.finding import Repeated
from campaigns.results.search import Apart, Member, SearchResult
from campaigns.results.slices import Curve
from campaigns.results.validate import Spread
from campaigns.results.verdict import NominalCost, Provenance, Worst, not_sampled
from tests.given.case_campaigns import campaign
from tests.given.stated_facts import Fact, facts
from tests.given.verdict_evidence import (
    NOMINAL,
    QUANTILE,
    WORST,
    barred,
    certificate,
    changed,
    check_of,
    concluded,
    encountered,
    finding,
    gathered,
    nominal,
    part_apart,
    sample,
    search,
    validation,
    violation,
)
from worker.engine.stages.parts.encounter import influence, no_value


def test_cleared_when_everything_holds() -> None:
    conclusion = concluded()
    assert conclusion.verdict == "cleared"
    assert all(c.ok for c in conclusion.checks)
    assert [c.name for c in conclusion.checks] == [
        "nominal", "search", "no violation", "minimum", "agreement", "validation", "evaluations",
        "closest approach", "motion", "avoidance", "influence", "sample", "probability",
    ]  # fmt: skip


def test_the_sentence_states_bounds_methods_evaluations_margin_bound_and_doubt() -> None:
    statement = concluded().reason
    for part in (
        "vehicle.m: 4 to 6 kg", "vehicle.J: 0.04 to 0.06 kg m2",
        "DIRECT (1\u202f000), SQP multistart (1\u202f000) and Monte",
        "3\u202f343 evaluations", "a margin of +0.34 m", "d_min = 0.84 m", "0 of 1000 violate",
        "A search can miss a worse case", "horizon 15 s, step 0.005 s", "1 obstacle;",
    ):  # fmt: skip
        assert part in statement
    assert concluded().scope in statement


def test_a_verdict_contains_nominal_worst_case_provenance_and_statistics() -> None:
    conclusion = concluded()
    assert conclusion.nominal == NominalCost(cost=NOMINAL, margin=NOMINAL - 0.5)
    assert conclusion.worst == Worst(
        cost=WORST, margin=WORST - 0.5, evaluated=WORST, parameters={"vehicle.m": 6.0}, method="direct", finding="F1"
    )
    assert conclusion.provenance == Provenance(clearance="test", wording=WORDING, digest=campaign().digest, seed=1)
    assert (conclusion.quantity, conclusion.unit) == ("d_min", "m")
    assert conclusion.statistics is not None
    assert conclusion.statistics.upper_bound == pytest.approx(0.00299, abs=1e-5)


def test_violated_when_a_validated_finding_violates() -> None:
    conclusion = concluded(**violation())
    assert conclusion.verdict == "violated"
    assert facts(conclusion.statement)[:5] == ["d_min", 0.5, "d_min", 0.49, -0.01]
    assert facts(check_of("no violation", conclusion).statement) == ["F1", 0.01]


def test_a_violation_that_does_not_repeat_is_reported_as_such() -> None:
    again = Repeated(name="a fresh evaluation", cost=0.45, difference=-0.04)
    apart = {"half_step": None, "integrator": None, "again": again, "agrees": False, "violates": True}
    found = finding(0.49)
    assert found.validation is not None
    conclusion = concluded(**violation(finding=changed(found, validation=changed(found.validation, **apart))))
    assert conclusion.verdict == "violated"
    statement = "Both its evaluations violate the criterion but differ beyond tolerance: 0.49 m, and 0.45 m in a fresh"
    assert f"{statement} evaluation." in conclusion.reason
    agreeing = changed(found.validation, **apart | {"agrees": True})
    assert "apart" not in concluded(**violation(finding=changed(found, validation=agreeing))).reason


COST = st.floats(-0.5, 0.7)


@settings(max_examples=60)
@given_(st.lists(st.tuples(COST, COST, COST, st.booleans()), min_size=1, max_size=4))
def test_what_is_stated_of_a_violation_is_granted_by_every_integration(
    cases: list[tuple[float, float, float, bool]],
) -> None:
    found = []
    for i, (cost, half, other, apart) in enumerate(sorted(cases), 1):
        values = (cost, half, other) if apart else (cost, cost, cost)
        violates, clear = all(v <= 0.5 for v in values), all(v > 0.5 for v in values)
        one = finding(cost, label=f"F{i}")
        assert one.validation is not None
        assert one.validation.half_step is not None
        assert one.validation.integrator is not None
        found.append(changed(one, validation=changed(
            one.validation, violates=violates, agrees=not apart and (violates or clear), ok=violates or not apart,
            half_step=changed(one.validation.half_step, cost=values[1]),
            integrator=changed(one.validation.integrator, cost=values[2]),
        )))  # fmt: skip
    conclusion = concluded(**violation(finding=found[0], others=found[1:]))
    confirmed = [max(v) if apart else v[0] for *v, apart in cases if (max(v) if apart else v[0]) <= 0.5]
    assert (conclusion.verdict == "violated") == bool(confirmed)
    if confirmed:
        assert conclusion.worst is not None
        assert conclusion.worst.cost == conclusion.values["worst"] == min(confirmed)
        assert conclusion.worst.margin == conclusion.values["margin"] <= 0


@pytest.mark.parametrize(("again", "verdict"), [(0, "inconclusive"), (1, "violated"), (76, "violated")])
def test_a_violation_that_no_stored_violation_repeats_is_inconclusive(again: int, verdict: str) -> None:
    counts = changed(validation().violations, stored=76, checked=76, confirmed=again)
    conclusion = concluded(**violation(violating=76, validation=validation(violations=counts)))
    assert conclusion.verdict == verdict
    assert conclusion.worst is not None


def test_a_finding_on_the_threshold_violates() -> None:
    assert concluded(**violation(finding=finding(0.5))).verdict == "violated"


def test_violated_needs_validation() -> None:
    text = "the step-halving check or DOP853 disagrees by more than the tolerance for F1"
    conclusion = concluded(**violation(finding=finding(0.49, False), validation=validation(ok=False, text=text)))
    assert conclusion.verdict == "inconclusive"
    assert conclusion.values["violated_by"] == pytest.approx(0.01)
    assert facts(check_of("no violation", conclusion).statement)[:2] == ["F1", 0.01]
    assert text in conclusion.reason


def test_a_milder_violation_that_was_confirmed_violates_too() -> None:
    text = "the step-halving check or DOP853 disagrees by more than the tolerance for F1"
    milder = finding(0.495, label="F2")
    given = violation(finding=finding(0.49, False), others=[milder], validation=validation(ok=False, text=text))
    conclusion = concluded(**given)
    assert conclusion.verdict == "violated"
    assert [fact for fact in facts(conclusion.statement) if fact in ("F1", "F2", 0.49)] == ["F2", "F1", 0.49]
    harmless = finding(0.6, label="F2")
    assert concluded(**given | {"others": [harmless]}).verdict == "inconclusive"


@pytest.mark.parametrize(
    "changes",
    [
        {"failed": 5},
        {"searches": [search("direct", 0.49), search("ga", 0.9)]},
        {"searches": [search("monte_carlo", 0.49, sample=sample())]},
        {"validation": validation(ok=False, text="half the step disagrees for nominal")},
        {"nominal": nominal(None, "it diverged")},
    ],
)
def test_nothing_that_bars_cleared_bars_a_validated_violation(changes: dict[str, Any]) -> None:
    assert concluded(**violation(**changes)).verdict == "violated"


def test_a_failed_nominal_flight() -> None:
    diverged = "the simulation diverged at t = 3 s"
    conclusion = concluded(nominal=nominal(None, diverged))
    assert conclusion.verdict == "inconclusive"
    assert check_of("nominal", conclusion).text.endswith(f": {diverged}")
    assert check_of("nominal", conclusion).text in conclusion.reason
    assert conclusion.nominal == NominalCost(cost=None, margin=None)
    agreement = check_of("agreement", conclusion)
    assert not agreement.ok
    assert "nominal" in agreement.text, "there is a worst case"


def test_a_nominal_flight_that_violates_unconfirmed() -> None:
    searches = [search("direct", 0.4), search("sqp", 0.4)]
    conclusion = concluded(nominal=nominal(0.45), searches=searches, finding=finding(0.4, False))
    assert conclusion.verdict == "inconclusive"
    assert facts(check_of("nominal", conclusion).statement) == [0.45, -0.05]
    assert check_of("nominal", conclusion).text in conclusion.reason


def test_no_flight_at_all() -> None:
    searches = [search("direct", None), search("sqp", None)]
    conclusion = concluded(nominal=nominal(None, "it diverged"), searches=searches, finding=None, failed=3343)
    assert (conclusion.verdict, conclusion.worst) == ("inconclusive", None)
    assert f": {check_of('nominal', conclusion).text}." in conclusion.reason


ONE_METHOD = "only DIRECT reached the worst case; a method of another family must confirm it"
DISAGREES = "the step-halving check or DOP853 disagrees by more than the tolerance for nominal"
LATE = WORST + 0.05
LATE_WORDS = "the worst case is 0.84 m, but DIRECT stopped 0.05 m above it"
NO_SAMPLE = "the target P(violation) of 5 % needs an independent sample; add a certify stage"
EVEN = sample(upper_bound=None, text="they are no independent sample")
TWO, MOST = [search("direct"), search("sqp")], [search("sqp"), search("monte_carlo", sample=sample())]


BARS: dict[str, tuple[CheckCode, dict[str, Any], list[Fact], str]] = {
    "a search without a value": (
        CheckCode.SEARCH, {"searches": [search("direct"), search("sqp"), search("monte_carlo", None)]},
        ["monte_carlo"], "Monte Carlo evaluated no case successfully",
    ),
    "a search that did not end": (
        CheckCode.SEARCH,
        {"searches": [search("direct"), search("sqp"), search("monte_carlo", 0.85, stop=None, sample=sample())]},
        ["direct", "sqp"],
        "not every search ended: DIRECT used its budget of 1000 evaluations, SQP multistart all starts converged",
    ),
    "a failed evaluation": (CheckCode.EVALUATIONS, {"failed": 1}, [1, 3343], "1 of 3\u202f343 evaluations failed"),
    "a validation that disagrees": (
        CheckCode.VALIDATION, {"validation": validation(ok=False, text=DISAGREES)}, [],
        f"{DISAGREES}; 200 random evaluations differ",
    ),
    "one method alone": (CheckCode.AGREEMENT, {"searches": [search("direct")]}, ["direct"], ONE_METHOD),
    "two stages of one method": (
        CheckCode.AGREEMENT, {"searches": [search("direct"), search("direct", WORST + 0.001)]}, ["direct"], ONE_METHOD,
    ),
    "a search for a front is no second method": (
        CheckCode.AGREEMENT, {"searches": [search("direct"), search("nsga2")]}, ["direct"], ONE_METHOD,
    ),
    "local methods alone": (
        CheckCode.AGREEMENT, {"searches": MOST}, [], "no global method searched; add one, such as DIRECT",
    ),
    "a search for a front is no global method": (
        CheckCode.AGREEMENT, {"searches": [search("sqp"), search("nsga2")]}, [],
        "no global method searched; add one, such as DIRECT",
    ),
    "a global method that stopped short": (
        CheckCode.AGREEMENT, {"searches": [search("ga", WORST + 0.0125), *TWO]}, [0.84, "ga", 0.0125],
        "the worst case is 0.84 m, but Genetic algorithm stopped 0.0125 m above it",
    ),
    "every global method that stopped short": (
        CheckCode.AGREEMENT, {"searches": [search("ga", WORST + 0.0125), search("direct", LATE), search("sqp")]},
        [0.84, "ga", 0.0125, "direct", 0.05],
        "the worst case is 0.84 m, but Genetic algorithm stopped 0.0125 m above it and DIRECT stopped 0.05 m above it",
    ),
    "the first stage of a global method": (
        CheckCode.AGREEMENT, {"searches": [search("direct", LATE), *TWO]}, [0.84, "direct", 0.05], LATE_WORDS,
    ),
    "the second stage of a global method": (
        CheckCode.AGREEMENT, {"searches": [search("direct"), search("direct", LATE), search("sqp")]},
        [0.84, "direct", 0.05], LATE_WORDS,
    ),
    "a sample that found a worse case": (
        CheckCode.AGREEMENT,
        {"searches": [search("direct", LATE), search("sqp", LATE), search("monte_carlo", sample=sample())]},
        [0.84, "direct", 0.05], LATE_WORDS,
    ),
    "a portfolio that stopped short": (
        CheckCode.AGREEMENT, {"searches": [search("portfolio", WORST + 0.03), *TWO]}, [0.84, "portfolio", 0.03],
        "the worst case is 0.84 m, but Portfolio stopped 0.03 m above it",
    ),
    "the best of a method in no basin": (
        CheckCode.AGREEMENT, {"basins": {"direct": None}}, ["direct"],
        "the best of DIRECT is not in the basin of any listed finding",
    ),
    "a second method in no basin": (CheckCode.AGREEMENT, {"basins": {"sqp": None}}, ["direct"], ONE_METHOD),
    "a target that is not met": (
        CheckCode.TARGET, {"target": 0.0029}, [0.003, 0.0029],
        "the bound of 0.3 % does not meet the target of 0.29 %",
    ),
    "a target that the certify stage does not meet": (
        CheckCode.TARGET, {"target": 0.0015, "certificate": certificate(3)}, [0.00259, 0.0015],
        "the bound of 0.259 % does not meet the target of 0.15 %",
    ),
    "a target and no independent sample": (
        CheckCode.TARGET, {"target": 0.5, "certificate": certificate(upper_bound=None)}, [0.05], NO_SAMPLE,
    ),
    "no sample": (
        CheckCode.SAMPLE, {"certificate": None}, [59],
        "not sampled: no independent sample was drawn, which would show what every search missed; add a certify stage "
        "of at least 59",
    ),
    "the sample of a search only": (
        CheckCode.SAMPLE, {"certificate": None, "searches": [*TWO, search("monte_carlo", sample=sample())]}, [59],
        "not sampled: no independent sample was drawn, which would show what every search missed; add a certify stage "
        "of at least 59",
    ),
    "a sample with a chosen seed": (
        CheckCode.SAMPLE, {"certificate": changed(certificate(), drawn_at_launch=False)}, [],
        "the seed of the independent sample was stated before the run, so a sample without a violation could have "
        "been chosen; run the campaign without a stated seed",
    ),
    "fewer samples than the least": (
        CheckCode.SAMPLE, {"certificate": certificate(samples=58, upper_bound=0.01)}, [58, 59],
        "the independent sample has 58, fewer than 59",
    ),
    "a sample that is too small": (
        CheckCode.PROBABILITY, {"certificate": certificate(1, 60)}, [0.0767, 0.05, 60],
        "the bound of 7.67 % on P(violation) is above the required 5 %; draw more than 60 samples",
    ),
    "a sample of which many violate is not advised to be larger": (
        CheckCode.PROBABILITY, {"certificate": certificate(76, 100)}, [0.829, 0.05, 76, 100],
        "the bound of 82.9 % on P(violation) is above the required 5 %; 76 of its 100 samples violate the criterion",
    ),
    "so much beyond the bounds that no sample is large enough": (
        CheckCode.PROBABILITY, {"certificate": certificate(0, 1000, outside=0.123, upper_bound=0.126)},
        [0.126, 0.05, 0.123],
        "the bound of 12.6 % on P(violation) is above the required 5 %; at most 12.3 % of the draws lie outside the "
        "bounds, which the bound counts whatever the sample; widen the bounds",
    ),
    "so much beyond the bounds that with these violations no sample is large enough": (
        CheckCode.PROBABILITY, {"certificate": certificate(20, 1000, outside=0.031, upper_bound=0.06)},
        [0.06, 0.05, 0.031],
        "the bound of 6 % on P(violation) is above the required 5 %; at most 3.1 % of the draws lie outside the "
        "bounds, which the bound counts whatever the sample; widen the bounds",
    ),
    "so much beyond the bounds that a larger sample helps": (
        CheckCode.PROBABILITY, {"certificate": certificate(1, 60, outside=0.03, upper_bound=0.1067)},
        [0.107, 0.05, 60],
        "the bound of 10.7 % on P(violation) is above the required 5 %; draw more than 60 samples",
    ),
    "a target that seems to permit more": (
        CheckCode.TARGET, {"target": 0.9, "certificate": certificate(2, 100)}, [0.0617, 0.05, 0.9],
        "the bound of 6.17 % does not meet the target of 5 %; the target of the campaign, 90 %, is "
        "looser and does not apply",
    ),
    "an evaluation lower than every finding": (
        CheckCode.MINIMUM, {"lowest": WORST - 1e-9}, [0.84],
        "a stored evaluation has 0.84 m, lower than every finding",
    ),
    "findings that were not distinguished": (
        CheckCode.MINIMUM, {"validation": validation(findings=gathered(complete=False, text="used its budget"))}, [],
        "used its budget",
    ),
    "methods that found nothing below nominal": (
        CheckCode.AGREEMENT,
        {
            "searches": [search("direct", NOMINAL), search("ga", NOMINAL)], "finding": finding(NOMINAL),
            "validation": validation(
                encounter=encountered(spread=Spread(evaluations=3343, lowest=NOMINAL, highest=1.3))
            ),
        },
        [],
        "no method found a value below the nominal case, so their agreement shows nothing; widen the bounds, or move "
        "the nominal values away from the worst case",
    ),
}  # fmt: skip
"""What bars cleared: the check, the evidence, the numbers and methods of the sentence, and its words."""


def test_a_sample_of_which_every_draw_was_excluded_is_not_advised_to_be_larger() -> None:
    checks = {c.code: c for c in concluded(certificate=certificate(0, 0, upper_bound=1.0)).checks}
    assert facts(checks[CheckCode.PROBABILITY].statement) == [1.0, 0.05]


@pytest.mark.parametrize("name", BARS)
def test_what_bars_cleared_is_stated_by_one_check(name: str) -> None:
    code, changes, expected, words = BARS[name]
    changes = dict(changes)
    target = changes.pop("target", None)
    check = barred(code, campaign(target_probability=target) if target else None, **changes)
    assert facts(check.statement) == expected
    assert check.text == words


def test_excluded_evaluations_do_not_bar_cleared_but_are_reported() -> None:
    conclusion = concluded(excluded=40)
    assert conclusion.verdict == "cleared"
    assert facts(check_of("evaluations", conclusion).statement) == [3343, 40]
    assert "in all 3\u202f303 evaluations" in conclusion.reason
    assert "40 more were excluded." in conclusion.reason


def test_a_random_sample_is_no_second_method() -> None:
    barred("agreement", searches=[search("direct"), search("monte_carlo", WORST, sample=sample())])


def test_a_second_method_that_stopped_short_is_none() -> None:
    barred("agreement", searches=[search("direct"), search("sqp", WORST + 0.006)])
    assert concluded(searches=[search("direct"), search("sqp", WORST + 0.004)]).verdict == "cleared"


def test_a_global_method_without_a_flight_is_named() -> None:
    conclusion = concluded(searches=[search("ga", None), search("direct"), search("sqp")])
    assert conclusion.verdict == "inconclusive"
    assert facts(check_of("search", conclusion).statement) == ["ga"]
    assert facts(check_of("agreement", conclusion).statement) == [WORST, "ga"]
    assert "inf" not in conclusion.reason


def test_agreement_is_a_fraction_of_nominal_minus_worst() -> None:
    searches = [search("direct"), search("ga", WORST + 0.015)]
    barred("agreement", searches=searches)
    assert concluded(campaign(agreement=0.2), searches=searches).verdict == "cleared"


def test_a_flat_campaign_agrees_up_to_rounding() -> None:
    searches = [search("direct", NOMINAL), search("ga", NOMINAL + 1e-13)]
    level = encountered(spread=Spread(evaluations=3343, lowest=NOMINAL, highest=NOMINAL + 1e-13))
    flat: dict[str, Any] = {
        "searches": searches,
        "finding": finding(NOMINAL),
        "validation": validation(encounter=level),
    }
    assert facts(barred("influence", **flat).statement) == ["d_min"]
    conclusion = concluded(campaign(encounter={"intended": {"influence": "a drill"}}), **flat)
    assert conclusion.verdict == "cleared"
    assert facts(check_of("agreement", conclusion).statement) == ["direct", "ga", 3343]
    assert facts(check_of("influence", conclusion).statement) == ["d_min"]
    assert "a drill." in conclusion.reason


@pytest.mark.parametrize("offset", [0.0, 1.7e9])
@pytest.mark.parametrize("scale", [1e-12, 1e-9, 1.0, 1e9])
def test_agreement_knows_no_scale_and_no_offset(scale: float, offset: float) -> None:
    """What one method missed is no rounding, whatever the unit: 1e-9 of a time since 1970 is more than a second."""
    if offset:
        scale = max(scale, 1e-3)  # below, numbers near the offset have too few digits
    threshold, worst, second = (offset + scale * value for value in (0.05, 0.43, 1.0))
    searches = [search("direct", second), search("ga", worst)]
    level = encountered(spread=Spread(evaluations=3343, lowest=worst, highest=offset + 1.5 * scale))
    conclusion = concluded(
        campaign(criterion__threshold=threshold), nominal=nominal(offset + 1.4 * scale), searches=searches,
        finding=finding(worst, margin=worst - threshold), validation=validation(encounter=level),
    )  # fmt: skip
    agreed = check_of("agreement", conclusion)
    assert not agreed.ok
    assert "direct" in facts(agreed.statement)
    assert check_of("influence", conclusion).ok


def test_only_parameters_with_slices_are_reported_as_without_effect() -> None:
    def curve(path: str, *costs: float | None) -> Curve:
        values = [float(k) for k in range(len(costs))]
        return Curve(path=path, values=values, costs=list(costs), status=["ok"] * len(costs))

    assert influence([]) == {}
    assert influence([curve("a", 1.0), curve("b", None, 2.0)]) == {}
    assert influence([curve("a", 1.0, 3.0, None), curve("a", 2.0, 2.5), curve("b", 4.0, 4.0)]) == {"a": 2.0, "b": 0.0}


def test_what_has_no_value_along_the_slices_of_a_parameter_is_recorded() -> None:
    def curve(path: str, *ends: Status) -> Curve:
        costs = [1.0 if end == Status.OK else None for end in ends]
        return Curve(path=path, values=[float(k) for k in range(len(ends))], costs=costs, status=[*ends])

    ok, failed, excluded = Status.OK, Status.FAILED, Status.EXCLUDED
    every = [curve("a", ok, failed), curve("b", ok, ok), curve("a", excluded, ok), curve("c", excluded)]
    assert no_value(every) == {"a": [excluded, failed], "c": [excluded]}


def test_the_target_is_met() -> None:
    conclusion = concluded(campaign(target_probability=0.003))
    assert conclusion.verdict == "cleared"
    assert conclusion.checks[-1].code == CheckCode.TARGET
    assert facts(conclusion.checks[-1].statement) == [0.003, 0.003]


def test_the_first_sample_of_a_search_is_stated_where_no_stage_draws_one() -> None:
    searches = [
        search("direct"), search("sqp"),
        search("monte_carlo", sample=sample(samples=100)), search("monte_carlo", sample=sample(samples=10_000)),
    ]  # fmt: skip
    found = concluded(campaign(target_probability=0.003), searches=searches, certificate=None)
    assert [check.code for check in found.checks if not check.ok] == [CheckCode.SAMPLE, CheckCode.TARGET]
    assert found.statistics is not None
    assert (found.statistics.samples, found.statistics.source) == (100, "search")


def test_without_a_target_the_bound_is_compared_with_a_ceiling() -> None:
    assert concluded(certificate=certificate(0, 59)).verdict == "cleared"
    barred("probability", certificate=certificate(1, 59))


@given_(st.sampled_from(["cleared", "inconclusive", "violated"]), st.integers(0, 100), st.booleans(), st.booleans())
def test_what_lacks_only_a_sample_is_called_not_sampled(word: str, drawn: int, certified: bool, other: bool) -> None:
    lacking = [*([] if certified else ["sample"]), *(["search"] if other else [])]
    expected = (word == "cleared" and drawn < 59) or lacking == ["sample"]
    assert not_sampled(word, lacking, drawn) == expected


@pytest.mark.parametrize("target", [None, 0.001, 0.05, 0.2, 0.97])
@pytest.mark.parametrize("samples", [2, 58, 59, 300, 3000])
def test_a_target_makes_a_verdict_stricter_never_looser(target: float | None, samples: int) -> None:
    drawn = {"certificate": certificate(0, samples)}
    order = ["inconclusive", "cleared"]
    without, stated = concluded(**drawn), concluded(campaign(target_probability=target), **drawn)
    assert order.index(stated.verdict) <= order.index(without.verdict)


@pytest.mark.parametrize("sampled", [True, False])
@pytest.mark.parametrize(("deviation", "verdict"), [(0.4, "cleared"), (5.0, "inconclusive")])
def test_draws_outside_the_bounds_count_with_and_without_a_sample(
    sampled: bool, deviation: float, verdict: str
) -> None:
    normal = {"kind": "normal", "mean": 5.0, "deviation": deviation}
    uncertain = {"vehicle.m": {"plus_minus": "20%", "distribution": normal}, "vehicle.J": {"plus_minus": "20%"}}
    found = concluded(campaign(uncertain=uncertain), certificate=certificate() if sampled else None, searches=TWO)
    check = next(check for check in found.checks if check.code == CheckCode.OUTSIDE)
    assert check.ok == (verdict == "cleared")
    assert found.verdict == (verdict if sampled else "inconclusive")
    assert check.ok or "outside the bounds" in found.reason


def test_the_certify_stage_replaces_the_sample_of_a_search() -> None:
    stands = concluded(certificate=certificate()).statistics
    assert stands is not None
    assert (stands.samples, stands.source, stands.quantile) == (3000, "certify", QUANTILE)
    before = concluded(certificate=None).statistics
    assert before is not None
    assert (before.samples, before.source, before.quantile) == (1000, "search", None)


def test_what_it_bounds_is_in_the_sentence() -> None:
    conclusion = concluded(certificate=certificate())
    assert f" {certificate().text}. At most 5 % of the flights have d_min below 0.9 m." in conclusion.reason
    assert "0 of 1000 violate" not in conclusion.reason


def test_the_target_is_compared_with_the_certify_stage() -> None:
    target = campaign(target_probability=0.0015)
    assert facts(barred("target", target).statement) == [0.003, 0.0015]
    assert concluded(target, certificate=certificate()).verdict == "cleared"


def test_a_certify_stage_is_not_passed_over_for_a_better_search() -> None:
    barred("target", campaign(target_probability=0.003), certificate=certificate(samples=100))


def test_points_that_are_no_independent_sample_give_no_statement() -> None:
    searches = [search("direct"), search("sqp"), search("monte_carlo", 0.85, sample=EVEN)]
    assert concluded(searches=searches, certificate=None).statistics is None
    both = [*searches, search("monte_carlo", 0.85, sample=sample(samples=200))]
    stated = concluded(searches=both, certificate=None).statistics
    assert stated is not None
    assert stated.samples == 200


def test_a_search_for_a_front_plays_no_part_in_agreement() -> None:
    searches = [search("direct"), search("sqp"), search("nsga2", WORST + 0.2)]
    assert concluded(searches=searches).verdict == "cleared"


def test_a_portfolio_is_a_global_method() -> None:
    assert concluded(searches=[search("portfolio"), search("sqp")]).verdict == "cleared"


@pytest.mark.parametrize(
    ("started", "agreed"),
    [({"vehicle.m": 5.0}, True), ({"vehicle.m": 5.95}, False), ({"vehicle.m": 6.0, "vehicle.J": 0.06}, True)],
    ids=["nominal", "close", "at one parameter of it"],
)
@pytest.mark.parametrize("both", [True, False])
def test_a_search_that_the_campaign_started_at_the_worst_case_does_not_confirm_it(
    started: dict[str, float], agreed: bool, both: bool
) -> None:
    requests = [
        {"method": "genetic", "evaluations": 2000} | ({"starts": [started]} if both else {}),
        {"method": "sqp", "evaluations": 1000, "starts": [{"vehicle.m": 4.5}, started]},
    ]
    found = concluded(
        campaign(stages__search=requests), finding=finding(point=[1.0, 0.5]), searches=[search("direct"), search("sqp")]
    )
    assert check_of("agreement", found).ok is agreed


def sharing(method: str, family: str, **changes: Any) -> SearchResult:
    """A search of a method whose members share what they know, one of which led."""
    led = Member(member=family, title=family, evaluations=900, best=WORST, improvements=9)
    alone = Member(member="contrast_racing", title="racing", evaluations=100, best=1.0, improvements=0, apart=True)
    return search(method, family=family, members=[led, alone], **changes)


@pytest.mark.parametrize("method", ["auto", "portfolio"])
def test_searches_of_one_method_are_not_two_because_other_members_led_them(method: str) -> None:
    two = [sharing(method, "gradients"), sharing(method, "normal distribution")]
    assert not check_of("agreement", concluded(searches=two)).ok
    parts = [part_apart("gradients", "gradients"), part_apart("contrast_racing", "racing of descents", cost=1.0)]
    other = [part_apart("divided", "division"), part_apart("contrast_racing", "racing of descents", cost=1.0)]
    of_parts = [sharing(method, "gradients", apart=parts), sharing(method, "division", apart=other)]
    assert not check_of("agreement", concluded(searches=of_parts)).ok
    witnessed = [of_parts[0], sharing(method, "division", apart=[other[0], changed(other[1], best=WORST)])]
    assert check_of("agreement", concluded(searches=witnessed)).ok
    assert check_of("agreement", concluded(searches=[*two, search("direct", family="division")])).ok


@pytest.mark.parametrize(
    ("member", "family", "confirmed"),
    [("mlsl", "multistart", False), ("multistart", "", False), ("direct", "division", True)],
    ids=["of its family", "of an undeclared family, by name", "of another family"],
)
@pytest.mark.parametrize("parts", [False, True])
def test_a_search_by_the_principle_of_one_that_shares_with_the_leading_member_is_no_second_one(
    member: str, family: str, confirmed: bool, parts: bool
) -> None:
    """Both may have evaluated the same points: the leading member had the rest from the other."""
    apart = [part_apart("sqp", "gradients"), part_apart("contrast_racing", "racing of descents", cost=1.0)]
    several = sharing("portfolio", "gradients", apart=apart if parts else [])
    other = Member(member=member, title=member, evaluations=200, best=1.0, improvements=0, family=family)
    several = changed(several, members=[*several.members, other])
    searches = [several, search("direct", family="multistart")]
    assert check_of("agreement", concluded(searches=searches)).ok is confirmed
    assert check_of("agreement", concluded(searches=searches[::-1])).ok is confirmed


APART = [part_apart("sqp", "gradients"), part_apart("contrast_racing", "racing of descents")]


def test_two_parts_that_were_apart_confirm_each_other() -> None:
    found = concluded(searches=[search("auto", apart=APART)])
    assert found.verdict == "cleared"
    named = [span for span in check_of("agreement", found).statement if span.kind == "reference"]
    assert {span.label for span in named} >= {f"Auto: {one.title}" for one in APART}


@pytest.mark.parametrize(
    "parts",
    [
        [],
        [part_apart("sqp", "gradients"), part_apart("cma_es", "gradients")],
        [APART[0], part_apart("contrast_racing", "racing of descents", WORST + 0.03)],
        [APART[0], part_apart("contrast_racing", "racing of descents", evaluations=49)],
        [part_apart(one.member, one.family, WORST + 0.03) for one in APART],
    ],
    ids=["one part", "of one family", "one stopped short", "one of too few evaluations", "only polishing"],
)
def test_a_search_alone_needs_two_parts_that_reached_the_worst_case(parts: list[Apart]) -> None:
    found = concluded(searches=[search("auto", apart=parts)])
    assert found.verdict == "inconclusive"
    assert not check_of("agreement", found).ok
