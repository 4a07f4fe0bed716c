"""A criterion of obstacles that declares a distance is compared with it, wherever the vehicle may be."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from campaigns import Catalogue
from campaigns.asked.load import load_document
from campaigns.claims.spans import words
from campaigns.results.validate import Beyond, Mismeasured
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign, document
from tests.given.verdict_evidence import encountered
from worker.engine.components.criteria import separation, surface_separation
from worker.engine.kernels.component import Criterion
from worker.engine.kernels.maths import kernel
from worker.engine.systems.closed_loop import beyond
from worker.engine.systems.closed_loop.distances import in_flights
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.parts import Installed
from worker.evidence.scopes import closed_loop
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts.sentence import scope
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import catalogue, components
from worker.running.examination.distances import note_of

CENTRE, SURFACE = separation.component, surface_separation.component
BOX = {"component": "box", "parameters": {"position": {"x": 30.0, "y": 20.0}, "length": 0.2, "width": 45.0}}
MOVING = {
    "component": "moving_circle",
    "parameters": {"position": {"x": 9.0, "y": 19.0}, "goal": {"x": 9.0, "y": -10.0}, "speed": 1.0, "radius": 0.3},
}


@kernel
def total(lowest: Any, p: Any) -> float:
    found = 0.0
    for gap in lowest:
        found = found + gap
    return found


@kernel
def harmonic(lowest: Any, p: Any) -> float:
    found = 0.0
    for gap in lowest:
        found = found + 1.0 / gap
    return 1.0 / found


@kernel
def last(lowest: Any, p: Any) -> float:
    return lowest[len(lowest) - 1]  # type: ignore[no-any-return]


@kernel
def never_inside(t: float, q: Any, v: Any, x: Any, u: Any, body: Any, p: Any) -> tuple[float]:
    return (body.gap if body.gap > 0.0 else 1.0,)


@kernel
def farther(t: float, q: Any, v: Any, x: Any, u: Any, body: Any, p: Any) -> tuple[float]:
    return (body.gap - p.body_radius + 0.5,)


@kernel
def faster(t: float, q: Any, v: Any, x: Any, u: Any, body: Any, p: Any) -> tuple[float]:
    return (body.gap - p.body_radius + 0.1 * abs(v[0]),)


def own(of: Criterion, sample: Any = None, **changes: Any) -> Criterion:
    if sample is not None:
        changes["sample"] = {2: sample, 3: sample}
    return replace(of, name="own", **changes)


WRONG = {
    "centre for surface": own(CENTRE, measured_to="surface"),
    "surface for centre": own(SURFACE, measured_to="centre"),
    "never inside": own(SURFACE, never_inside),
    "farther than it is": own(SURFACE, farther),
    "by the speed": own(SURFACE, faster),
    "sum": own(SURFACE, value=total),
    "harmonic sum": own(SURFACE, value=harmonic),
    "one obstacle": own(SURFACE, value=last),
}
RIGHT = {"centre": own(CENTRE), "surface": own(SURFACE), "none": own(SURFACE, value=total, measured_to="none")}


def installed(criterion: Criterion) -> Installed:
    described = catalogue()
    entry = component_entry(criterion, surface_separation)
    described = described.model_copy(update={"components": [*described.components, entry]})
    return Installed(components() | {("criterion", "own"): criterion}, described)


def flights(criterion: Criterion) -> Flights:
    """Two more obstacles than case 1, of which one moves; the body has a radius where it may have one."""
    made = document()
    made["scenario"]["obstacles"] += [BOX, MOVING]
    made["criterion"] = {"component": "own", "threshold": 60.0}
    if "body_radius" in criterion.parameters._fields:  # type: ignore[attr-defined]
        made["criterion"]["parameters"] = {"body_radius": 0.2}
    return Flights(load_document(made), installed(criterion), compiled=False, lanes=1)


@pytest.mark.by_day(2)
@pytest.mark.parametrize("name", WRONG)
def test_a_distance_that_is_declared_and_not_computed_is_found(name: str) -> None:
    """By the examination of the component, and in every run."""
    criterion = WRONG[name]
    assert f'measured_to="{criterion.measured_to}"' in note_of(criterion, lambda _: None)
    different = in_flights(flights(criterion))
    assert different is not None
    assert different.value is not None
    assert abs(different.value - different.distance) > 1e-3


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", RIGHT)
def test_what_is_as_declared_is_accepted(name: str) -> None:
    assert note_of(RIGHT[name], lambda _: None) == ""
    assert in_flights(flights(RIGHT[name])) is None


@pytest.mark.parametrize("measured_to", ["centre", "surface"])
@pytest.mark.parametrize("unit", ["mm", "ft", "s", ""])
def test_a_distance_in_another_unit_than_metres_bars_cleared(unit: str, measured_to: Any) -> None:
    """Its threshold is compared with the sizes of obstacles, which are in metres."""
    criterion = own(CENTRE, unit=unit, measured_to=measured_to)
    assert "not in m" in note_of(criterion, lambda _: None)
    for stated in {False, measured_to == "centre"}:
        made = document()
        made["criterion"] = {"component": "own", "threshold": 600.0, "from_centre": stated}
        described: Catalogue = installed(criterion).catalogue
        shown = closed_loop.described(load_document(made), described, "DOP853")
        assert "not in m" in words(dict(shown.bars)["distances"])
        assert not shown.scope.distances


def test_the_scope_does_not_state_a_distance_that_is_not_computed() -> None:
    made = Problem(campaign(criterion__component="surface_separation"), compiled=False)
    clause = words(terms(made.system).scope.distances)
    assert clause
    assert clause in words(scope(made))
    different = Mismeasured(obstacle=0, time=0.0, position=[0.0, 0.0], distance=-0.1, value=0.4)
    assert encountered(mismeasured=different).mismeasured == different
    assert clause not in words(scope(made, measured=False))


RETURNING = {
    "component": "waypoint_circle",
    "parameters": {
        "position": {"x": 16.0, "y": 7.0}, "waypoint1": {"x": 50.0, "y": 7.0}, "waypoint2": {"x": 6.0, "y": 7.0},
        "legs": 2.0, "speed": 3.0, "radius": 0.1,
    },
}  # fmt: skip
"""It leaves, and returns to the goal at 26 s."""


@kernel
def infinite(lowest: Any, p: Any) -> float:
    return math.inf


@kernel
def no_number(lowest: Any, p: Any) -> float:
    return math.nan


def returned(value: Any, horizon: float) -> Beyond:
    made = document(scenario__horizon=horizon, scenario__step=0.02, scenario__guidance={"period": 0.02})
    made["scenario"]["vehicle"]["parameters"] = {"J": 0.5}  # stable with that step
    made["stages"]["search"] = [{"method": "direct", "evaluations": 50}]
    made["scenario"]["obstacles"].append(RETURNING)
    made["criterion"] = {"component": "own", "threshold": 0.1}
    with_it = Flights(load_document(made), installed(own(SURFACE, value=value)), compiled=False, lanes=1)
    row = with_it.vector({})[None, :]
    cost = float(with_it.simulate_vectors(row)[0].costs[0, 0])
    found = beyond.met(with_it, ["nominal"], row, [None], cost if math.isfinite(cost) else 1.0, lambda: False)
    assert found is not None
    return found


@pytest.mark.by_day(1)
@pytest.mark.parametrize("value", [total, SURFACE.value])
def test_what_combines_obstacles_comes_lower_beyond_the_horizon(value: Any) -> None:
    """Where all but one obstacle were infinitely far away, such a value was infinite, and nothing came below it."""
    found = returned(value, 10.0)
    assert found.lowest is not None
    assert found.lowest.obstacle == 1
    assert found.closer == 1


@pytest.mark.parametrize("value", [infinite, no_number])
def test_a_value_that_stays_infinite_is_not_known_beyond_the_horizon(value: Any) -> None:
    unknown = returned(value, 5.0).unknown
    assert unknown is not None
    assert math.isfinite(unknown.value)
