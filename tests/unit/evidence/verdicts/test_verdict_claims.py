"""Attacks on a verdict with hand-written evidence: none may be cleared."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from campaigns.results.base import Stop
from campaigns.results.finding import ClosestApproach, HalfStep, ReferenceCost
from campaigns.results.slices import Curve, Slices
from campaigns.results.validate import Beyond, Later, Spread, Unseen, Violations
from campaigns.stages.certify import CertifyResult
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign, document
from tests.given.stated_facts import facts
from tests.given.verdict_evidence import (
    NOMINAL,
    VERSIONS,
    WORST,
    barred,
    case,
    certificate,
    changed,
    check_of,
    concluded,
    encountered,
    evidence,
    finding,
    nominal,
    sample,
    search,
    spot_checks,
    validation,
    violation,
)
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts import encounter
from worker.evidence.verdicts.conclude import conclude

STOPPED = Stop(kind="budget", text="used its budget")


def test_a_stored_violation_that_no_finding_shows_bars_cleared() -> None:
    text = "135 stored evaluations violate the criterion"
    offered = Violations(stored=135, checked=135, confirmed=0, text=text)
    conclusion = concluded(violating=135, lowest=0.3, validation=validation(violations=offered))
    assert conclusion.verdict == "inconclusive"
    assert check_of("no violation", conclusion).text == text
    assert check_of("minimum", conclusion).values == {"lowest": 0.3}


def test_cleared_with_a_stored_violation_is_impossible_whatever_the_checks_say(monkeypatch: pytest.MonkeyPatch) -> None:
    from worker.evidence.verdicts import conclude as module

    monkeypatch.setattr(module, "checks", lambda problem, evidence: [])
    with pytest.raises(AssertionError, match="although a stored evaluation has"):
        concluded(violating=1)


@pytest.mark.parametrize("method", ["direct", "sqp"])
def test_a_method_that_hardly_evaluated_anything_did_not_search(method: str) -> None:
    least = {"direct": 50, "sqp": 6}[method]
    others = {"direct": search("ga"), "sqp": search("direct")}

    def given(evaluations: int) -> dict[str, Any]:
        return {"searches": [others[method], search(method, evaluations=evaluations)]}

    assert concluded(**given(least)).verdict == "cleared"
    check = barred("agreement", **given(least - 1))
    assert facts(check.statement) == (["direct"] if method == "sqp" else ["direct", least - 1, least])


def test_a_local_search_that_spent_its_budget_confirms_nothing() -> None:
    check = barred("agreement", searches=[search("direct"), search("sqp", stop=STOPPED)])
    assert facts(check.statement) == ["direct"]


def test_agreement_requires_the_same_point_as_well_as_the_same_cost() -> None:
    assert concluded(basins={"sqp": "F2"}).verdict == "cleared", "mirrored worst cases agree"


def test_agreement_is_capped() -> None:
    searches = [search("direct"), search("ga", WORST + 0.03)]
    check = barred("agreement", campaign(agreement=1.0), searches=searches)
    assert facts(check.statement) == [0.84, "ga", 0.03]


def met(**changes: Any) -> dict[str, Any]:
    return {"validation": validation(encounter=encountered(**changes))}


def nearest(**closest: Any) -> dict[str, Any]:
    return {"finding": finding(closest=ClosestApproach(**closest))}


def later(**changes: Any) -> Later:
    """An approach after the horizon."""
    made = Later(name="F1", value=0.69, time=1.2, obstacle=0, distance=1.5, closing=0.998, simulated=True)
    return changed(made, **changes)


def unseen(cost: float | None, reason: str = "") -> Unseen:
    return Unseen(cost=cost, status="failed" if cost is None else "ok", reason=reason, deviation=0.7)


@pytest.mark.parametrize(
    ("given", "name", "statement"),
    [
        (nearest(time=15.0, at="end"), "closest approach", "of F1 is at the end of the horizon"),
        (nearest(time=0.0, at="start"), "closest approach", "of F1 is at the start"),
        (met(closest=ClosestApproach(time=15.0, at="end")), "closest approach", "of nominal is at the end of the"),
        (
            met(beyond=Beyond(times=2.0, flights=302, closer=300, lowest=later())), "closest approach",
            "300 of 302 flights come closer beyond the horizon than any evaluation: F1 is 1.5 m from obstacle 1 "
            "(Circle) at the last sample, closing at 0.998 m/s, and d_min falls to 0.69 m after another 1.2 s; len",
        ),
        (
            met(
                beyond=Beyond(
                    times=2.0, flights=302, closer=1,
                    lowest=later(name="evaluation 7 of the sample", closing=-0.5, simulated=False),
                )
            ),
            "closest approach",
            "1 of 302 flights comes closer beyond the horizon than any evaluation: evaluation 7 of the sample is 1.5 m "
            "from obstacle 1 (Circle) at the last sample, moving away at 0.5 m/s, and d_min would fall to 0.69 m after",
        ),
        (nearest(), "closest approach", "is known for F1"),
        ({"finding": finding(closest=None)}, "closest approach", "is known for F1"),
        (
            met(beyond=Beyond(times=2.0, flights=302, closer=0, lowest=None, unknown=later(simulated=False))),
            "closest approach",
            "it is not known how obstacle 1 (Circle) moves after 30 s: F1 is 1.5 m from obstacle 1 (Circle) at the "
            "last sample, closing at 0.998 m/s; along straight lines d_min would be 0.69 m after another 1.2 s; len",
        ),
        (
            met(
                beyond=Beyond(
                    times=2.0, flights=302, closer=0, lowest=None, unknown=later(simulated=False, vehicle=True)
                )
            ),
            "closest approach",
            "it is not known how the vehicle moves on after 30 s: F1 is 1.5 m from obstacle 1 (Circle) at the "
            "last sample, closing at 0.998 m/s; d_min could be 0.69 m after another 1.2 s; len",
        ),
        (
            met(
                beyond=Beyond(
                    times=2.0, flights=302, closer=0, lowest=None, unknown=later(simulated=False, closing=-0.5)
                )
            ),
            "closest approach",
            "last sample, moving away at 0.5 m/s; d_min could be 0.69 m after another 1.2 s; len",
        ),
        (
            met(beyond=Beyond(times=2.0, flights=302, cut_short=1, closer=300, lowest=later())), "closest approach",
            "300 of 302 flights come closer beyond the horizon (1 of them fails after it, before 30 s) than any eval",
        ),
        (
            met(
                beyond=Beyond(
                    times=2.0, flights=302, cut_short=9, closer=0, lowest=None,
                    unknown=later(simulated=False, until=21.5),
                )
            ),
            "closest approach",
            "it is not known how obstacle 1 (Circle) moves after 21.5 s, when the flight fails: F1 is",
        ),
        (met(moved=0.0), "motion", "the vehicle moves 0 m in the nominal case; place the goal"),
        (met(moved=None), "motion", "has no trace"),
        (met(unseen=unseen(NOMINAL)), "avoidance", "the avoidance makes no difference"),
        (met(unseen=unseen(NOMINAL + 0.1)), "avoidance", "the avoidance makes no difference"),
        (met(unseen=unseen(None, "a stall")), "avoidance", "without it the nominal case fails (a stall)"),
    ],
)  # fmt: skip
def test_an_encounter_that_did_not_occur_bars_cleared(given: dict[str, Any], name: str, statement: str) -> None:
    assert statement in barred(name, **given).text


def none_closer(cut_short: int | None) -> dict[str, Any]:
    return met(beyond=Beyond(times=2.0, flights=302, cut_short=cut_short, closer=0, lowest=None))


def diverged(without: Unseen, moved: float | None = 9.2) -> dict[str, Any]:
    """A nominal case that fails."""
    shown = met(closest=ClosestApproach(), moved=moved, unseen=without)
    return {"nominal": nominal(None, "it diverged"), **shown}


def along(changes: dict[str, float], **no_value: list[str]) -> dict[str, Any]:
    """What slices through the worst case show, each of two values."""
    by = {f"vehicle.{name}": change for name, change in changes.items()}
    curves = [slice_of(path, WORST, WORST + change) for path, change in by.items()]
    ended = {f"vehicle.{name}": statuses for name, statuses in no_value.items()}
    return met(influence=by, no_value=ended) | {"finding": finding(slices=Slices(curves=curves))}


def slice_of(path: str, *costs: float) -> Curve:
    return Curve(path=path, values=[*map(float, range(len(costs)))], costs=[*costs], status=["ok"] * len(costs))


def over(highest: float, *curves: Curve) -> dict[str, Any]:
    """Slices of a criterion that has values up to this."""
    spread = Spread(evaluations=3343, lowest=WORST, highest=highest)
    return met(spread=spread) | {"finding": finding(slices=Slices(curves=[*curves]))}


M, J = "vehicle.m", "vehicle.J"


FLAT = Spread(evaluations=3343, lowest=NOMINAL, highest=NOMINAL)
EXCLUDED = Unseen(cost=None, status="excluded", reason="too close", deviation=None)


ON = "when simulated on to 30 s"


@pytest.mark.parametrize(
    ("name", "ok", "given", "statement"),
    [
        ("closest approach", True, none_closer(None), f"comes closer beyond it {ON} and extrapolated from there"),
        ("closest approach", True, none_closer(0), f"comes closer beyond it {ON} and extrapolated from there"),
        (
            "closest approach", True, none_closer(1),
            "to 30 s, or until it fails, and extrapolated from there; 1 of them fails after it, before 30 s",
        ),
        ("closest approach", True, none_closer(301), "from there; 301 of them fail after it, before 30 s"),
        ("closest approach", False, diverged(unseen(0.38)), "no closest approach is known for nominal"),
        (
            "motion", False, diverged(unseen(0.38)),
            "the vehicle moves 9.2 m in the nominal case, which has no closest approach to compare this with",
        ),
        ("motion", False, diverged(unseen(0.38), None), "motion is unknown: the nominal case has no trace"),
        (
            "avoidance", False, diverged(unseen(0.38)),
            "with it the nominal case fails (it diverged), without it d_min is 0.38 m; choose a nominal case that the "
            "vehicle completes",
        ),
        (
            "avoidance", False, diverged(unseen(None, "a stall")),
            "the nominal case fails (it diverged), and without avoidance it fails (a stall); choose a nominal case "
            "that the vehicle completes",
        ),
        (
            "avoidance", False, diverged(EXCLUDED),
            "and without avoidance it is excluded (too close); choose a nominal case that the vehicle completes",
        ),
        (
            "influence", True, along({"m": 0.1, "J": 0.0}),
            "; varying these alone has no effect at the 2 values of each curve: vehicle.J",
        ),
        (
            "influence", True, over(1e6, slice_of(M, 1e6, 1e6, 1e6), slice_of(J, 5.0, 5.0), slice_of(J, 5.0, 5.0, 5.0)),
            "; varying these alone has no effect at the 2 or more values of each curve: vehicle.m and vehicle.J",
        ),
        (
            "influence", True, along({"m": 0.1, "J": 0.0}, J=["failed"], m=["failed"]),
            "over the evaluations; varying vehicle.J alone changes no value, but evaluations along it fail",
        ),
        (
            "influence", True, along({"m": 0.1, "J": 0.0}, J=["excluded"]),
            "varying vehicle.J alone changes no value, but evaluations along it are excluded",
        ),
        (
            "influence", True, along({"m": 0.1, "J": 0.0}, J=["excluded", "timeout"]),
            "varying vehicle.J alone changes no value, but evaluations along it fail or are excluded",
        ),
        (
            "influence", True, along({"m": 0.1}, J=["failed"]),
            "over the evaluations; varying vehicle.J alone has no known effect: evaluations along it fail",
        ),
        (
            "influence", True, met(begins={"vehicle": (3.0, 40.0)}),
            "; vehicle (unicycle) first changes at 40 s with some values, when no flight lasts as long",
        ),
        (
            "influence", False, met(begins={"vehicle": (30.0, 40.0)}),
            "vehicle (unicycle) first changes at 30 s to 40 s, and flights last 15 s; begin it earlier, or remove it",
        ),
        (
            "influence", False, met(begins={"vehicle": (15.0, 15.0)}),
            "vehicle (unicycle) first changes at 15 s, and flights last 15 s; begin it earlier, or remove it",
        ),
        (
            "influence", True, met(whole={"vehicle": (15.0, 40.0)}),
            "; vehicle (unicycle) has its whole effect at 40 s with some values, when no flight lasts as long",
        ),
        (
            "influence", True, met(begins={"vehicle": (3.0, 40.0)}, whole={"vehicle": (4.0, 41.0)}),
            "over the evaluations; vehicle (unicycle) first changes at 40 s with some values, when no flight lasts as "
            "long",
        ),
        (
            "influence", False, met(begins={"vehicle": (3.0, 40.0)}, whole={"vehicle": (16.0, 41.0)}),
            "vehicle (unicycle) has its whole effect only at 16 s to 41 s, and flights last 15 s; let it build up "
            "sooner, or state the part of it that flights meet",
        ),
        (
            "influence", False, met(idle={"vehicle": 117}),
            "changes none of 117 flights over the bounds; remove it, or give it values that have an effect",
        ),
        (
            "influence", False, met(spread=FLAT),
            "no uncertain parameter changes d_min; choose parameters that the encounter depends on",
        ),
        (
            "influence", False, met(spread=FLAT) | {"failed": 12, "excluded": 1},
            "changes d_min, but 13 of 3\u202f343 evaluations fail or are excluded; choose parameters that the "
            "encounter depends on",
        ),
        (
            "influence", False, met(spread=changed(FLAT, one_point=True)) | {"failed": 12},
            "is not known: only one point has a value; choose bounds within which evaluations succeed",
        ),
        (
            "influence", False, met(spread=Spread(evaluations=0, lowest=None, highest=None)) | {"failed": 3343},
            "the effect of the uncertain parameters is not known: no evaluation has a value",
        ),
    ],
)  # fmt: skip
def test_of_an_encounter_only_what_is_known_is_stated(
    name: str, ok: bool, given: dict[str, Any], statement: str
) -> None:
    found = check_of(name, concluded(**given))
    assert found.ok is ok
    assert found.text.endswith(statement)


def late(value: float = 0.69, simulated: bool = True, closer: int = 302) -> dict[str, Any]:
    """Flights come closer after the horizon."""
    return met(beyond=Beyond(times=2.0, flights=302, closer=closer, lowest=later(value=value, simulated=simulated)))


UNKNOWN = met(beyond=Beyond(times=2.0, flights=302, closer=0, lowest=None, unknown=later(simulated=False)))


def under_way(value: float) -> dict[str, Any]:
    """Flights come closer after the horizon, and the vehicle would come to a value if it went on."""
    further = later(value=value, simulated=False, vehicle=True)
    return met(beyond=Beyond(times=2.0, flights=302, closer=302, lowest=later(), unknown=further))


@pytest.mark.parametrize(
    ("given", "name", "waived"),
    [
        (nearest(time=15.0, at="end"), "closest_approach", True),
        (nearest(time=0.0, at="start"), "closest_approach", True),
        (late(), "closest_approach", True),
        (late(simulated=False, closer=1), "closest_approach", True),
        (nearest(), "closest_approach", False),
        ({"finding": finding(closest=None)}, "closest_approach", False),
        (UNKNOWN, "closest_approach", False),
        (under_way(0.2), "closest_approach", False),
        (under_way(0.6), "closest_approach", False),
        (late(0.4), "closest_approach", False),
        (late(0.5, closer=1), "closest_approach", False),
        (nearest(time=15.0, at="end") | late(0.5, simulated=False), "closest_approach", False),
        (met(moved=0.0), "motion", True),
        (met(moved=None), "motion", True),
        (met(unseen=unseen(NOMINAL)), "avoidance", True),
        (met(unseen=unseen(None, "a stall")), "avoidance", True),
    ],
)
def test_an_author_can_state_a_condition_but_no_violation_beyond_the_horizon(
    given: dict[str, Any], name: str, waived: bool
) -> None:
    conclusion = concluded(campaign(encounter={"intended": {name: "a baseline"}}), **given)
    assert conclusion.verdict == ("cleared" if waived else "inconclusive")
    assert check_of(name.replace("_", " "), conclusion).ok is waived
    assert ("a baseline." in conclusion.reason) is waived


@pytest.mark.parametrize(("value", "stated"), [(0.2, 0.2), (0.6, 0.6), (0.8, 0.69)])
def test_no_value_is_stated_as_the_lowest_where_a_lower_one_may_come(value: float, stated: float) -> None:
    found = check_of("closest approach", concluded(**under_way(value)))
    assert not found.ok
    assert found.values["later"] == stated
    assert ("known" in found.values) is (value == stated)


def test_flights_that_come_no_closer_beyond_the_horizon_are_counted() -> None:
    far = Beyond(times=2.0, flights=302, closer=0, lowest=later(value=1.2, simulated=False))
    conclusion = concluded(**met(beyond=far))
    assert conclusion.verdict == "cleared"
    holds = (
        "the closest approach of nominal and F1 is inside the horizon, and none of 302 flights comes closer beyond it "
        "when simulated on to 30 s and extrapolated from there"
    )
    assert check_of("closest approach", conclusion).text == holds


@pytest.mark.parametrize("cut_short", [0, 1])
def test_of_a_criterion_without_distances_nothing_is_stated_beyond_what_is_simulated(
    cut_short: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(encounter, "terms", lambda system: replace(terms(system), followed=False))
    found = check_of("closest approach", concluded(**none_closer(cut_short)))
    assert found.ok
    assert "nothing is known" in found.text
    assert "extrapolated" not in found.text
    assert ("1 of them" in found.text) == bool(cut_short)


ORBIT = {"centre": {"x": 40.0, "y": 40.0}, "way": 5.0, "phase": 0.0, "speed": 100.0, "radius": 0.1}


@pytest.mark.parametrize(
    ("bounds", "statement"),
    [
        ({}, ""),
        (
            {"way": {"low": 0.5, "high": 6.0}},
            "turns at up to 200 rad/s, which is 1 rad in a step of 0.005 s; use a step of at most 0.003927 s",
        ),
        ({"speed": {"low": -900.0, "high": 100.0}}, "turns at up to 180 rad/s, which is 0.9 rad in a step of 0.005 s"),
    ],
)  # fmt: skip
def test_an_obstacle_that_turns_too_far_within_a_step_bars_cleared(bounds: dict[str, Any], statement: str) -> None:
    obstacles = [*document()["scenario"]["obstacles"], {"component": "orbiting_circle", "parameters": ORBIT}]
    mass = document()["uncertain"]
    asked = campaign(scenario__obstacles=obstacles, uncertain=mass | {f"obstacles.1.{k}": v for k, v in bounds.items()})
    if not statement:
        assert concluded(asked).verdict == "cleared"
    else:
        assert f"obstacle 2 (Circle, circular path) {statement}" in barred("sampling", asked).text


def test_an_intention_without_need_is_not_mentioned() -> None:
    assert "intended" not in concluded(campaign(encounter={"intended": {"motion": "a baseline"}})).reason


def test_random_evaluations_on_the_other_side_of_the_threshold_bar_cleared() -> None:
    for spot in (
        spot_checks(violating=1, text="1 of them violates there and not here"),
        spot_checks(compared=0, text="none could be compared"),
        spot_checks(compared=199, text="1 more could not be compared"),
    ):
        assert spot.text in barred("validation", validation=validation(spot_checks=spot)).text


def noisy(**changes: Any) -> Problem:
    faults = [{"component": "sensor_noise", "parameters": {"sigma": 0.01}}]
    return Problem(campaign(scenario__faults=faults, **changes))


def drawn(**changes: Any) -> CertifyResult:
    return certificate(noise="drawn", **changes)


def test_a_noisy_scenario_needs_a_sample_that_draws_its_noise() -> None:
    searches = [search("direct"), search("sqp"), search("monte_carlo", 0.85, sample=sample(noise="stated"))]
    conclusion = conclude(noisy(), evidence(searches=searches, certificate=None), VERSIONS)
    assert conclusion.verdict == "inconclusive"
    assert (
        "only the noise realisations with seeds 0 were simulated; add a certify stage"
        in check_of("noise", conclusion).text
    )
    assert conclude(noisy(), evidence(certificate=drawn()), VERSIONS).verdict == "cleared"


def test_a_target_is_not_met_by_stated_realisations() -> None:
    searches = [search("direct"), search("sqp"), search("monte_carlo", sample=sample(noise="stated"))]
    conclusion = conclude(noisy(target_probability=0.1), evidence(searches=searches, certificate=None), VERSIONS)
    assert "holds only for the stated noise realisations" in check_of("target", conclusion).text
    assert conclusion.verdict == "inconclusive"


def test_a_mean_over_realisations_never_clears() -> None:
    mean = noisy(scenario__realisations={"seeds": [1, 2], "combine": "mean"})
    conclusion = conclude(mean, evidence(certificate=drawn()), VERSIONS)
    assert conclusion.verdict == "inconclusive"
    assert "set combine to worst" in check_of("noise", conclusion).text


def test_much_that_is_excluded_bars_cleared() -> None:
    assert concluded(certificate=drawn(excluded_fraction=0.1), excluded=300).verdict == "cleared"
    sampled = barred("exclusions", certificate=drawn(excluded_fraction=0.9), excluded=300)
    assert facts(sampled.statement)[0] == 0.9
    assert round(float(facts(barred("exclusions", excluded=400).statement)[0]), 2) == 0.12
    near = barred("exclusions", certificate=drawn(excluded_fraction=0.10004), excluded=300)
    assert near.text.startswith("10.004 %"), "not as the limit that it exceeds"


def test_a_violation_is_confirmed_by_every_integration_and_by_nothing_less() -> None:
    close = finding(0.49, validation=case(cost=0.49, violates=False))
    assert concluded(**violation(finding=close, violating=1)).verdict == "inconclusive"
    apart = finding(0.49, validation=case(cost=0.49, agrees=False))
    assert concluded(**violation(finding=apart, violating=1)).verdict == "violated"


def test_a_violation_whose_integrations_differ_states_by_how_much() -> None:
    half = HalfStep(step=0.0025, cost=0.48, difference=0.17)
    other = ReferenceCost(name="DOP853", cost=0.49, difference=0.18)
    apart = finding(0.31, validation=case(cost=0.31, agrees=False, half_step=half, integrator=other))
    stated = facts(concluded(**violation(finding=apart, violating=1)).statement)
    assert stated[-3:] == [0.31, 0.48, 0.49]


def test_the_sentence_of_a_violation_names_the_counts_and_the_noise() -> None:
    text = "135 stored evaluations violate the criterion; all of them were simulated again, and 120 violate there too"
    own = finding(0.49, validation=case(cost=0.49, realisation=77))
    given = validation(violations=Violations(stored=135, checked=135, confirmed=120, text=text))
    statement = concluded(**violation(finding=own, violating=135, validation=given)).reason
    assert f" {text}." in statement
    assert " seed 77" in statement


@pytest.mark.parametrize(
    ("curves", "rounding"),
    [
        ([slice_of(M, WORST, 1e6), slice_of(J, 5.45, 4.55)], False),
        ([slice_of(M, WORST, 1e6), slice_of(J, 1e6, 1e6), slice_of(J, 5.0, 5.0001)], False),
        ([slice_of(M, WORST, 1e6), slice_of(J, 5.0, 5.000001)], True),
        ([slice_of(M, WORST, 1e6), slice_of(J, 0.5000001, 0.4999999)], False),
        ([slice_of(M, WORST, 1e6), slice_of(J, 0.5000001, 0.50000012)], False),
    ],
)
def test_a_large_value_elsewhere_does_not_make_an_effect_rounding(curves: list[Curve], rounding: bool) -> None:
    """The criterion is 1e6 m where nothing is met; the threshold is 0.5 m."""
    assert ("vehicle.J" in check_of("influence", concluded(**over(1e6, *curves))).text) is rounding
