"""A campaign held against the catalogue of this installation."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import Catalogue, check
from campaigns.asked.load import load_document
from campaigns.catalogue import MethodEntry
from campaigns.checked.attracted import attracted
from campaigns.checked.check import parameters
from campaigns.checked.estimated import estimated
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign, searching
from tests.simulators import package
from worker.engine.systems.base import CampaignUnusable
from worker.running.catalogue.installed import catalogue


def found(**changes: Any) -> list[tuple[str, str, str]]:
    """The problems of case 1 with these changes."""
    return [(p.field, p.given, p.message) for p in check(campaign(**changes), catalogue())]


def one_search(**changes: Any) -> dict[str, Any]:
    return {"stages__search": [{"method": "direct", "evaluations": 10, **changes}]}


AVOIDERS = [c.name for c in catalogue().components if c.role == "avoider"]
NAMES = ", ".join([*AVOIDERS[:12], "..."] if len(AVOIDERS) > 12 else AVOIDERS)
M = "scenario.vehicle.parameters.m"
ONLY_J = {"uncertain": {"vehicle.J": {"plus_minus": "20%"}}, **one_search()}
ESTIMATE = {"stages__estimate": {"evaluations": 5000}}
BOUNDS = "uncertain__vehicle.m"

WRONG: dict[str, tuple[dict[str, Any], tuple[str, str, str]]] = {
    "component near": (
        {"scenario__vehicle__component": "unicyle"},
        ("scenario.vehicle.component", "unicyle", "no such vehicle; did you mean 'unicycle'?"),
    ),
    "component far": (
        {"scenario__avoider__component": "zzz"},
        ("scenario.avoider.component", "zzz", f"no such avoider; choose one of: {NAMES}"),
    ),
    "obstacle": (
        {"scenario__obstacles": [{"component": "cirle"}]},
        ("scenario.obstacles.0.component", "cirle", "no such obstacle; did you mean 'circle'?"),
    ),
    "criterion": (
        {"criterion__component": "seperation"},
        ("criterion.component", "seperation", "no such criterion; did you mean 'separation'?"),
    ),
    "parameter": (
        {"scenario__controller__parameters": {"k_tehta": 5}},
        ("scenario.controller.parameters.k_tehta", "5", "no such parameter; did you mean 'k_theta'?"),
    ),
    "value": (
        {"scenario__vehicle__parameters__m": -1, **ONLY_J},
        (M, "-1", "Mass must be within 0.001 to 100000 kg"),
    ),
    "value shown with its digits": (
        {"scenario__start__theta": 6.400001},
        ("scenario.start.theta", "6.400001", "Start heading, from the x axis must be within -6.4 to 6.4 rad"),
    ),
    "start": (
        {"scenario__start": {"X": 1}},
        ("scenario.start.X", "1", "no such parameter; choose one of: x, y, theta, v, omega"),
    ),
    "missing": (
        {"scenario__goal": {"x": 6}},
        ("scenario.goal.y", "", "this parameter is required: Goal, y [m]"),
    ),
    "no obstacles": (
        {"scenario__obstacles": []},
        ("scenario.obstacles", "[]", "give at least one obstacle: the criterion reads distances to them"),
    ),
    "threshold is no parameter": (
        {"criterion__parameters": {"threshold": 1}},
        ("criterion.parameters.threshold", "1", "no such parameter; no name is valid here"),
    ),
    "uncertain path": (
        {"uncertain__vehicle.n": {"low": 1, "high": 2}},
        ("uncertain.vehicle.n", "vehicle.n", "the scenario has no such parameter; did you mean 'vehicle.m'?"),
    ),
    "unit": (
        {BOUNDS: {"plus_minus": 1, "unit": "g"}}, ("uncertain.vehicle.m.unit", "g", "the unit of vehicle.m is kg"),
    ),
    "low": (
        {BOUNDS: {"low": 0, "high": 6}},
        ("uncertain.vehicle.m.low", "0", "low bound: Mass must be within 0.001 to 100000 kg"),
    ),
    "high": (
        {BOUNDS: {"low": 4, "high": 1e6}},
        ("uncertain.vehicle.m.high", "1000000", "high bound: Mass must be within 0.001 to 100000 kg"),
    ),
    "share beyond the limits": (
        {BOUNDS: {"plus_minus": "100%"}},
        ("uncertain.vehicle.m.plus_minus", "0", "low bound: Mass must be within 0.001 to 100000 kg"),
    ),
    "share of nothing": (
        {"uncertain__start.x": {"plus_minus": "20%"}},
        (
            "uncertain.start.x.plus_minus", "20%",
            "around the nominal value 0 this is an empty interval; give low and high",
        ),
    ),
    "nominal outside": (
        {BOUNDS: {"low": 5.5, "high": 6}, **one_search()},
        ("uncertain.vehicle.m", "5.5 to 6", "the nominal value 5 is outside the bounds; widen the bounds or change "
            "the nominal value"),
    ),
    "mode": (
        {BOUNDS: {"plus_minus": 1, "distribution": {"kind": "triangular", "mode": 6.5}}},
        ("uncertain.vehicle.m.distribution.mode", "6.5", "must be within 4 to 6"),
    ),
    "mean": (
        {BOUNDS: {"plus_minus": 1, "distribution": {"kind": "truncated_normal", "mean": 3, "deviation": 1}}},
        ("uncertain.vehicle.m.distribution.mean", "3", "must be within 4 to 6"),
    ),
    "method": (
        one_search(method="dirct"), ("stages.search.0.method", "dirct", "no such method; did you mean 'direct'?"),
    ),
    "option": (
        one_search(options={"iteration": 5}),
        ("stages.search.0.options.iteration", "5", "no such option; did you mean 'iterations'?"),
    ),
    "option near another one": (
        one_search(method="monte_carlo", options={"samples": 5}),
        ("stages.search.0.options.samples", "5", "no such option; did you mean 'sampling'?"),
    ),
    "option of another type": (
        one_search(options={"iterations": "many"}),
        ("stages.search.0.options.iterations", "'many'", "expected a value of type integer"),
    ),
    "option true": (
        one_search(options={"iterations": True}),
        ("stages.search.0.options.iterations", "True", "expected a value of type integer"),
    ),
    "option with a fraction": (
        one_search(options={"iterations": 1.5}),
        ("stages.search.0.options.iterations", "1.5", "expected a value of type integer"),
    ),
    "option too small": (
        one_search(options={"iterations": 0}), ("stages.search.0.options.iterations", "0", "expected at least 1"),
    ),
    "option too large": (
        one_search(options={"epsilon": 2}), ("stages.search.0.options.epsilon", "2", "expected at most 1"),
    ),
    "option at an open end": (
        one_search(options={"smallest": 1}), ("stages.search.0.options.smallest", "1", "expected below 1"),
    ),
    "choice": (
        one_search(method="sqp", options={"differences": "left"}),
        ("stages.search.0.options.differences", "'left'", "expected one of central, forward"),
    ),
    "list for a number": (
        one_search(options={"iterations": [1]}),
        ("stages.search.0.options.iterations", "[1]", "expected a value of type integer"),
    ),
    "start outside": (
        one_search(method="sqp", starts=[{"vehicle.m": 5}, {"vehicle.m": 6.1}]),
        ("stages.search.0.starts.1.vehicle.m", "6.1", "a start must be within the bounds 4 to 6"),
    ),
    "start of what is certain": (
        one_search(method="sqp", starts=[{"start.v": 1}]),
        ("stages.search.0.starts.0.start.v", "start.v", "not an uncertain parameter; choose one of: "
            "vehicle.m, vehicle.J"),
    ),
    "an estimate of noise": (
        ESTIMATE | {"scenario__faults": [{"component": "sensor_noise", "parameters": {"sigma": 0.01}}]},
        ("stages.estimate", "noise",
            "the scenario has noise, so P(violation) is also over its realisations, of which the estimate would miss "
            "the rare ones without a sign; remove this"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_does_not_fit_the_catalogue(name: str) -> None:
    changes, problem = WRONG[name]
    assert found(**changes) == [problem]


def test_every_problem_is_reported() -> None:
    changes = {"scenario__vehicle__parameters__m": -1, "scenario__goal": {}, **one_search(method="nothing")}
    assert {field for field, _, _ in found(**changes)} == {
        "scenario.vehicle.parameters.m",
        "scenario.goal.x",
        "scenario.goal.y",
        "stages.search.0.method",
        "uncertain.vehicle.m.plus_minus",  # 20 % of -1 is no mass
    }


def test_a_missing_uncertain_value_is_reported_once() -> None:
    for bounds in ({"plus_minus": 1}, {"low": 5, "high": 8}):
        (problem,) = found(scenario__goal={"x": 6}, uncertain={"goal.y": bounds}, **one_search())
        assert problem[0] == "scenario.goal.y"


@pytest.mark.parametrize("unit", ["kg m2", "kg m²", "kg*m^2", "kgm2", "kg·m2"])
def test_spellings_of_a_unit(unit: str) -> None:
    assert found(**{"uncertain__vehicle.J": {"plus_minus": "20%", "unit": unit}}) == []


def test_starts_and_modes_on_a_bound_that_rounding_moved() -> None:
    # 0.1 * (1 - 0.1) is 0.09000000000000001
    uncertain = {"vehicle.J": {"plus_minus": "10%", "distribution": {"kind": "triangular", "mode": 0.09}}}
    search = [{"method": "sqp", "evaluations": 10, "starts": [{"vehicle.J": 0.09}, {"vehicle.J": 0.11}]}]
    assert found(scenario__vehicle__parameters__J=0.1, uncertain=uncertain, stages__search=search) == []


def altered(component: str, **changes: Any) -> Catalogue:
    """The catalogue with one component changed."""
    known = catalogue()
    entries = [c.model_copy(update=changes) if c.name == component else c for c in known.components]
    return known.model_copy(update={"components": entries})


def test_a_controller_is_accepted_only_for_vehicles_it_fits() -> None:
    problems = check(campaign(), altered("pid_speed", fits=["quadrotor", "blimp"]))
    assert [(p.field, p.given, p.message) for p in problems] == [
        ("scenario.controller.component", "pid_speed", "this controller controls quadrotor, blimp, not unicycle")
    ]


def test_a_region_of_attraction_needs_a_polynomial_model() -> None:
    asked = campaign(stages__attraction={})
    assert check(asked, catalogue()) == []
    (problem,) = check(asked, altered("pid_speed", about_trim=[]))
    assert (problem.field, problem.given) == ("stages.attraction", "controller pid_speed")
    assert "pi_anti_windup" in problem.message
    assert check(campaign(stages__attraction={"degree": 4}), catalogue()) == []
    (problem,) = check(campaign(stages__attraction={"degree": 6}), catalogue())
    assert (problem.field, problem.given) == ("stages.attraction.degree", "6")
    (problem,) = check(asked, altered("pid_speed", about_trim=list("abcde")))
    assert (problem.field, problem.given) == ("stages.attraction.degree", "2")
    simulated = package.campaign()
    simulated["stages"]["attraction"] = {}
    (problem,) = attracted(load_document(simulated), catalogue())
    assert (problem.field, problem.given) == ("stages.attraction", f"simulator {simulated['simulator']['name']}")


def test_components_share_their_dimension() -> None:
    problems = check(campaign(), altered("circle", dimension=3))
    assert [(p.field, p.given, p.message) for p in problems] == [
        ("scenario.obstacles.0.component", "circle", "has 3 dimensions, the vehicle 'unicycle' has 2")
    ]
    assert check(campaign(), altered("circle", dimension=None)) == []


def test_options_that_may_be_nothing() -> None:
    rule = {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "null"}]}
    known = catalogue()
    method = known.method("direct")
    assert isinstance(method, MethodEntry)
    entry = method.model_copy(update={"options": {"properties": {"limit": rule}}})
    changed = known.model_copy(update={"methods": [entry]})

    def statement(value: Any) -> list[str]:
        asked = searching({"method": "direct", "evaluations": 10, "options": {"limit": value}})
        return [p.message for p in check(asked, changed)]

    assert statement(None) == statement(0.5) == statement(2) == []
    assert statement(0) == ["expected above 0"]
    assert statement("x") == ["expected a value of type number"]


def test_every_parameter_has_a_path() -> None:
    known = parameters(campaign(), catalogue())
    assert set(known) == set(Problem(campaign()).paths) - {"criterion.threshold"}
    assert known["vehicle.J"][1] == 0.05
    assert known["obstacles.0.position.x"][1] == 4.0
    assert known["controller.N"][0].unit == "rad/s"


def test_a_problem_is_not_made_of_a_campaign_that_does_not_fit() -> None:
    with pytest.raises(CampaignUnusable) as caught:
        Problem(campaign(scenario__vehicle__component="car"))
    assert [(p.field, p.given) for p in caught.value.problems] == [("scenario.vehicle.component", "car")]


def test_what_an_estimate_cannot_be_made_of() -> None:
    simulated = package.campaign()
    simulated["simulator"]["repeats"] = {"count": 3}
    simulated["stages"]["estimate"] = {"evaluations": 5000}
    (problem,) = estimated(load_document(simulated), random=False)
    assert (problem.field, problem.given) == ("stages.estimate", "3 calls")
    del simulated["simulator"]["repeats"]
    assert not [*estimated(load_document(simulated), random=False)]
    (path, bounds), *_ = simulated["uncertain"].items()
    many = {f"{path}{k}": bounds for k in range(21)}
    (problem,) = estimated(load_document(simulated | {"uncertain": many}), random=False)
    assert problem.given == "21 parameters"
