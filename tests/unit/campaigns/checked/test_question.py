"""What evaluates the same is the same question, however it is written; what evaluates something else is another one."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest
from pydantic import BaseModel

from campaigns import Campaign, Catalogue
from campaigns.asked.distributions import Uncertain
from campaigns.asked.load import load_document, load_text
from campaigns.asked.spec import Criterion, Scenario, Simulator
from campaigns.asked.text import to_yaml
from campaigns.checked.box import Box, Part
from campaigns.checked.check import check
from campaigns.checked.question import box, question
from tests.given.small_catalogue import CATALOGUE, component, parameter
from tests.given.small_catalogue import campaign as scenario_campaign

RESULT = {"name": "gap", "title": "", "quantity": "gap", "unit": "m", "worse": "low"}
DROP = {"name": "drop", "title": "", "text": "", "results": [RESULT, RESULT | {"name": "way"}]}
DROP["parameters"] = [parameter("mass", "kg", default=2.0), parameter("drag"), parameter("height", "m", default=2.5)]
HERE = Catalogue.model_validate({
    **CATALOGUE.model_dump(),
    "components": [
        *CATALOGUE.model_dump()["components"],
        component("environment", "gust", [parameter("seed"), parameter("size", "m / s", 0.0, default=1.0)]),
        component("environment", "wind", [parameter("speed", "m / s")]),
        component("fault", "lag", [parameter("time", "s", 0.0)], path="actuator"),
        component("criterion", "range", [parameter("margin", "m")], unit="m", worse="low", of="obstacles"),
    ],
    "simulators": [DROP],
})  # fmt: skip
HERE.components[0].inputs.extend(["F", "T"])

NEAR = {"component": "circle", "parameters": {"position": {"x": 4, "y": 4}, "radius": 0.5}}
FAR = {"component": "circle", "parameters": {"position": {"x": 9, "y": 9}, "radius": 0.45}}
GUST, WIND = {"component": "gust"}, {"component": "wind", "parameters": {"speed": 2.0}}
SLOW, SLOWER = ({"component": "lag", "on": "F", "parameters": {"time": t}} for t in (0.1, 0.2))
LOOP = scenario_campaign()
LOOP["scenario"] |= {"obstacles": [NEAR, FAR], "environment": [GUST, WIND], "faults": [SLOW, SLOWER]}
LOOP["uncertain"]["obstacles.0.radius"] = {"low": 0.4, "high": 0.6}
CALLED = {
    "name": "D",
    "simulator": {"name": "drop", "parameters": {"height": 3.0}},
    "uncertain": {"simulator.mass": {"plus_minus": "10%"}, "simulator.drag": {"low": -1.0, "high": 1.0}},
    "criterion": {"result": "gap", "threshold": 1.0},
    "stages": LOOP["stages"],
}


def put(path: str, value: Any) -> Callable[[Any], None]:
    """Set a value of a document, by keys and indices that are separated by `/`; None removes it."""

    def change(document: Any) -> None:
        *above, last = path.split("/")
        for key in above:
            document = document[int(key)] if isinstance(document, list) else document.setdefault(key, {})
        key: Any = int(last) if isinstance(document, list) else last
        if value is None:
            del document[key]
        else:
            document[key] = value

    return change


def asked(base: Any, *changes: Callable[[Any], None], described: Catalogue | None = HERE) -> str:
    document = copy.deepcopy(base)
    for change in changes:
        change(document)
    campaign = load_document(document)
    assert check(campaign, HERE) == []
    assert question(load_text(to_yaml(campaign)), described) == question(campaign, described)
    return question(campaign, described)


def swapped(document: Any) -> None:
    """The obstacles in their other order, and with them the index of the uncertain one."""
    document["scenario"]["obstacles"].reverse()
    document["uncertain"]["obstacles.1.radius"] = document["uncertain"].pop("obstacles.0.radius")


MASS = "uncertain/vehicle.m"
SAME: list[tuple[Any, list[Callable[[Any], None]]]] = [
    (LOOP, [put(MASS, {"low": 4.0, "high": 6.0})]),
    (LOOP, [put(MASS, {"low": "4", "high": 6})]),
    (LOOP, [put(MASS, {"plus_minus": 1, "unit": "kg"})]),
    (LOOP, [put(MASS, {"plus_minus": "20.0 %", "distribution": {"kind": "triangular", "mode": 5.5}})]),
    *((LOOP, [put("uncertain/vehicle.J/unit", unit)]) for unit in ("kg m2", "kg·m2", "kg·m²")),
    (LOOP, [put("uncertain", dict(reversed(LOOP["uncertain"].items())))]),
    (LOOP, [put("scenario/vehicle/parameters", None)]),
    (LOOP, [put("scenario/vehicle/parameters/J", 0.045)]),  # its bounds are stated
    (LOOP, [put("scenario/controller/parameters", {"k_p": 0.0, "N": "0"})]),
    (LOOP, [put("scenario/start", {"x": 0, "theta": -0.0})]),
    (LOOP, [put("scenario/goal", {"y": 7.0, "x": 6.0})]),
    (LOOP, [put("scenario/horizon", 15.0), put("scenario/guidance", {"period": 0})]),
    (LOOP, [put("scenario/horizon", 15.000001)]),  # the same number of steps
    (LOOP, [put("scenario/obstacles/0/parameters", {"radius": 0.45, "position.x": 4.0, "position.y": 4.0})]),
    (LOOP, [swapped]),
    (LOOP, [put("scenario/environment", [WIND, GUST])]),
    (LOOP, [put("scenario/environment/0/parameters", {"size": 1.0, "seed": 7})]),
    (LOOP, [put("scenario/realisations", {"seeds": [3, 4], "combine": "mean"})]),
    (LOOP, [put("criterion", {"component": "separation", "parameters": {}, "threshold": 0.7, "requirements": ["A"]})]),
    (LOOP, [put("objectives", [{"component": "range"}]), put("uncertain/objectives.0.margin", {"low": -1, "high": 1})]),
    (LOOP, [put("encounter", {"intended": {}}), put("correlations", []), put("seed", 9), put("name", "Other")]),
    (CALLED, [put("uncertain/simulator.mass", {"low": 1.8, "high": 2.2, "unit": "kg"})]),
    (CALLED, [put("simulator/parameters", {"height": 3, "mass": 2, "drag": 0.5})]),
    (CALLED, [put("simulator/repeats", {"count": 3, "combine": "mean"}), put("simulator/retries", 2)]),
    (CALLED, [put("criterion/threshold", 0.0)]),
]  # fmt: skip
OTHER: list[tuple[Any, list[Callable[[Any], None]]]] = [
    (LOOP, [put(MASS, {"low": 4.0, "high": 6.000000001})]),
    (LOOP, [put(MASS, {"plus_minus": "20%"}), put("scenario/vehicle/parameters/m", 5.5)]),
    (LOOP, [put(MASS, None)]),
    (LOOP, [put("uncertain/start.x", {"low": -1, "high": 1})]),
    (LOOP, [put("scenario/controller/parameters", {"k_p": 0.1})]),
    (LOOP, [put("scenario/start", {"x": 1})]),
    (LOOP, [put("scenario/goal/x", 6.5)]),
    (LOOP, [put("scenario/step", 0.0025)]),
    (LOOP, [put("scenario/horizon", 20)]),
    (LOOP, [put("scenario/guidance", {"period": 0.1})]),
    (LOOP, [put("scenario/obstacles/1", None)]),
    (LOOP, [put("scenario/obstacles", [FAR, NEAR])]),  # the other one is uncertain
    (LOOP, [put("scenario/environment/0/parameters", {"size": 2.0})]),
    (LOOP, [put("scenario/environment/1", None)]),
    (LOOP, [put("scenario/faults", [SLOWER, SLOW])]),
    (LOOP, [put("scenario/faults/0/on", "T")]),
    (LOOP, [put("criterion/component", "range")]),
    (LOOP, [put("criterion", {"component": "range", "parameters": {"margin": 1.0}, "threshold": 0.5})]),
    (CALLED, [put("simulator/parameters", None)]),
    (CALLED, [put("uncertain/simulator.drag/low", -0.5)]),
    (CALLED, [put("uncertain/simulator.height", {"low": 2.0, "high": 3.0})]),
    (CALLED, [put("criterion/result", "way")]),
]  # fmt: skip


@pytest.mark.parametrize(("base", "changes"), SAME)
def test_what_evaluates_the_same_is_the_same_question(base: Any, changes: list[Callable[[Any], None]]) -> None:
    assert asked(base, *changes) == asked(base)


def test_what_evaluates_something_else_is_another_question() -> None:
    found = [asked(base) for base in (LOOP, CALLED)] + [asked(base, *changes) for base, changes in OTHER]
    assert len(set(found)) == len(found)


def bounds(base: Any, *changes: Callable[[Any], None], described: Catalogue | None = HERE) -> Box:
    document = copy.deepcopy(base)
    for change in changes:
        change(document)
    campaign = load_document(document)
    assert check(campaign, HERE) == []
    found = box(campaign, described)
    assert Box.of(found.kin, json.loads(json.dumps(found.document()))).inside(found)
    return found


@pytest.mark.parametrize(("base", "changes"), SAME)
def test_the_same_question_has_the_same_cases(base: Any, changes: list[Callable[[Any], None]]) -> None:
    one, other = bounds(base), bounds(base, *changes)
    assert one.inside(other)
    assert other.inside(one)


def test_questions_with_the_same_cases_differ_at_most_by_a_rounding() -> None:
    every = [bounds(LOOP), bounds(CALLED), *(bounds(base, *changes) for base, changes in OTHER[1:])]
    for i, one in enumerate(every):
        assert [k for k, other in enumerate(every) if one.inside(other) and other.inside(one)] == [i]
    base, changes = OTHER[0]
    assert bounds(base, *changes).inside(bounds(base))


INSIDE: list[tuple[Any, list[Callable[[Any], None]]]] = [
    (LOOP, [put(f"{MASS}", {"low": 4.5, "high": 5.0})]),
    (LOOP, [put(MASS, None)]),  # fixed at its nominal value
    (LOOP, [put(MASS, None), put("scenario/vehicle/parameters/m", None)]),  # at its default
    (LOOP, [put(MASS, None), put("scenario/vehicle/parameters/m", 6.0)]),  # at a corner
    (LOOP, [put(MASS, None), put("uncertain/vehicle.J/high", 0.05), put("criterion/threshold", 0.7)]),
    (LOOP, [put("uncertain/obstacles.0.radius/low", 0.5), swapped]),
    (CALLED, [put("uncertain/simulator.drag/low", -0.5)]),
    (CALLED, [put("uncertain/simulator.mass", None)]),
]  # fmt: skip


@pytest.mark.parametrize(("base", "changes"), INSIDE)
def test_all_cases_of_narrower_bounds_are_cases_of_wider_ones(base: Any, changes: list[Callable[[Any], None]]) -> None:
    assert bounds(base, *changes).inside(bounds(base))
    assert not bounds(base).inside(bounds(base, *changes))


def test_whole_numbers_that_differ_are_different_values() -> None:
    """Large ones differ by less than a rounding of their size."""
    fixed = [Box("", {"": [Part("", {"seed": (value, value)})]}) for value in (1.7e9, 1.7e9 + 1, 4e15, 4e15 + 1)]
    for one in fixed:
        assert [other for other in fixed if one.inside(other)] == [one]
        assert [other for other in fixed if not one.apart(other)] == [one]


def test_boxes_are_apart_only_where_no_case_is_in_both() -> None:
    every = [bounds(LOOP), *(bounds(base, *changes) for base, changes in (*SAME, *INSIDE) if base is LOOP)]
    assert not any(one.apart(other) for one in every for other in every if one.inside(other))
    masses = [bounds(LOOP, put(MASS, {"low": low, "high": high})) for low, high in ((4, 5), (5, 5.5), (1, 9))]
    assert not any(one.apart(other) for one in masses for other in masses)
    heavy = bounds(LOOP, put(MASS, {"low": 7, "high": 9}), put("scenario/vehicle/parameters/m", 8))
    assert [one.apart(heavy) for one in masses] == [heavy.apart(one) for one in masses] == [True, True, False]


def test_a_case_is_inside_the_bounds_that_contain_it_wherever_its_obstacle_is_listed() -> None:
    wide = bounds(LOOP, put(MASS, {"low": 1.0, "high": 9.0}), put("uncertain/obstacles.0.radius/low", 0.1))
    for mass, radius, inside in ((4.0, 0.4, True), (6.0, 0.6, True), (6.1, 0.5, False), (5.0, 0.39, False)):
        case = wide.at({"vehicle.m": mass, "obstacles.0.radius": radius, "vehicle.J": 0.05})
        assert case.inside(bounds(LOOP)) is inside
        assert case.inside(bounds(LOOP, swapped)) is inside
        assert case.inside(wide)
    assert not wide.at({"vehicle.m": 5.0}).inside(bounds(LOOP, put("uncertain/vehicle.J/high", 0.05)))


def test_of_parts_that_are_alike_each_is_inside_another_one() -> None:
    """Also where one fits into several, and must leave one of these to a part that fits into no other."""

    def radii(*each: tuple[float, float]) -> Box:
        circles = [
            {"component": "circle", "parameters": {"position.x": 4, "position.y": 4, "radius": r}} for r, _ in each
        ]
        varied = {f"obstacles.{i}.radius": {"low": low, "high": high} for i, (low, high) in enumerate(each)}
        return bounds(LOOP, put("scenario/obstacles", circles), put("uncertain", varied))

    wide = radii((0.1, 0.9), (0.1, 0.5), (0.4, 0.6))
    assert radii((0.2, 0.3), (0.45, 0.5), (0.45, 0.5)).inside(wide)
    assert radii((0.45, 0.5), (0.45, 0.5), (0.2, 0.3)).inside(wide)
    assert radii((0.2, 0.3), (0.7, 0.8), (0.55, 0.6)).inside(wide)
    assert not radii((0.7, 0.8), (0.7, 0.8), (0.45, 0.5)).inside(wide)
    assert not radii((0.2, 0.3), (0.2, 0.3)).inside(wide)


def test_bounds_around_a_value_that_is_not_known_contain_only_themselves() -> None:
    mass = "uncertain/simulator.mass"
    one = bounds(CALLED, described=None)
    assert one.inside(bounds(CALLED, put(mass, {"plus_minus": "10.0%"}), described=None))
    assert bounds(CALLED, put("uncertain/simulator.drag/low", -0.5), described=None).inside(one)
    for other in (put(mass, {"plus_minus": "20%"}), put(mass, None)):
        assert not one.inside(bounds(CALLED, other, described=None))
        assert not bounds(CALLED, other, described=None).inside(one)


def test_without_descriptions_a_question_is_as_far_the_same_as_what_is_stated_shows() -> None:
    def stated(*changes: Callable[[Any], None]) -> str:
        return asked(CALLED, *changes, described=None)

    mass = "uncertain/simulator.mass"
    assert stated() == stated(put(f"{mass}/unit", "kg")) == stated(put(mass, {"plus_minus": "10.0%"}))
    assert stated() != stated(put(mass, {"plus_minus": "20%"}))
    nominal = put("simulator/parameters/mass", 2.0)
    assert stated(nominal) == stated(nominal, put(mass, {"low": 1.8, "high": 2.2})) != stated()


def test_a_default_that_is_changed_or_added_is_another_model_and_not_another_question() -> None:
    entry = HERE.simulators[0]
    longer = [*entry.parameters, entry.parameters[0].model_copy(update={"name": "wear"})]
    later = HERE.model_copy(update={"simulators": [entry.model_copy(update={"parameters": longer})]})
    assert asked(CALLED, described=later) == asked(CALLED)


DECIDES = {  # the fields of which a value may remove a violation, all of which the lists above change
    Simulator: {"name", "parameters"},
    Uncertain: {"low", "high", "plus_minus"},
    Criterion: {"component", "parameters", "result"},
    Scenario: set(Scenario.model_fields) - {"realisations"},
    Campaign: {"scenario", "simulator", "uncertain", "criterion"},
}
SHOWN = {"objectives"}
"""Changed in the lists above as well."""
FREE = [(kind, name) for kind, decide in DECIDES.items() for name in kind.model_fields if name not in decide | SHOWN]


@pytest.mark.parametrize(("kind", "name"), FREE, ids=lambda given: getattr(given, "__name__", given))
def test_no_other_field_decides_the_question(kind: type[BaseModel], name: str) -> None:
    """Of every model, also a field that is added later: whoever adds it states on which side it is."""
    one = load_document(LOOP if kind is Scenario else CALLED)
    other: dict[str, Any] = {name: "of another value"}
    if kind is Uncertain:
        other = {"uncertain": {path: bounds.model_copy(update=other) for path, bounds in one.uncertain.items()}}
    elif kind is not Campaign:
        field = kind.__name__.lower()
        other = {field: getattr(one, field).model_copy(update=other)}
    assert question(one.model_copy(update=other), HERE) == question(one, HERE)
