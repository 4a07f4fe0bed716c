"""An avoider's demand at other positions: closed form, the loop's own demand, every avoider of the library."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from clearance.testing.problems import Problem
from clearance.testing.scenes import problem
from tests.given.case_campaigns import CASE1
from tests.given.live_process import Live
from worker.engine.kernels.component import Avoider
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.field import UNITS, Field, field
from worker.engine.systems.closed_loop.trace import SimulatedCase, simulate
from worker.running.catalogue.installed import components

AVOIDERS = sorted(c.name for c in components().values() if isinstance(c, Avoider))
SHIPPED = {name: load_file(path) for name, path in library().items()}


def around(middle: Floats, reach: float, count: int = 9) -> Floats:
    """Places (count^2, 2) of a square about the middle."""
    steps = np.linspace(-reach, reach, count)
    return np.stack(np.meshgrid(middle[0] + steps, middle[1] + steps), axis=-1).reshape(-1, 2)


@pytest.fixture(scope="module")
def case1() -> Problem:
    return Problem(load_document(CASE1, "case 1"))


def test_the_potential_field_of_case_1_is_its_closed_form(case1: Problem) -> None:
    places = around(np.array([4.0, 4.0]), 3.7, 12)
    found = field(case1.system, simulate(case1.system, {}), 2.5, places)
    assert (found.kind, UNITS[found.kind], found.time) == ("force", "N", 2.5)
    values = {path: float(case1.system.nominal[k]) for path, k in case1.paths.items()}
    goal = np.array([values["goal.x"], values["goal.y"]])
    obstacle = np.array([values["obstacles.0.position.x"], values["obstacles.0.position.y"]])
    away = places - obstacle
    centre = np.linalg.norm(away, axis=1)
    d, d_0 = centre - values["obstacles.0.radius"], values["avoider.d_0"]
    near = np.where(d <= d_0, values["avoider.k_rep"] * (1 / d - 1 / d_0) / d**2, 0.0)
    expected = values["avoider.k_att"] * (goal - places) + (near / centre)[:, None] * away
    outside = d > 0.05
    assert ((near > 0) & outside).sum() > 10
    assert ((near == 0) & outside).sum() > 10
    assert found.demand[outside, :2] == pytest.approx(expected[outside], rel=1e-9)
    assert np.isfinite(found.demand).all(), "inside the obstacle too"
    assert not found.demand[:, 2].any()


@pytest.mark.parametrize("name", ["unicycle_static", "uav_aca"])
def test_where_the_vehicle_is_it_is_what_the_loop_asked(name: str) -> None:
    flown_by = Problem(SHIPPED[name])
    loop, flown, every = (
        flown_by.system.loop,
        simulate(flown_by.system, {}),
        flown_by.system.counts(flown_by.system.step)[1],
    )
    dimension = flown_by.system.parts.vehicle.dimension
    # For continuous guidance the trace contains only the value at the start of a step.
    rows = [0, every, len(flown.states) // 2 // every * every] if flown_by.system.parts.sampled else [0]
    p = loop.extend(flown.vector)
    for row in rows:
        time = row * flown_by.system.step
        found = field(flown_by.system, flown, time, np.zeros((1, 2)))
        state = tuple(float(v) for v in flown.states[row, : loop.n_state])
        believed = loop.part("measurements")(time, state, p)[0]
        held = loop.part("held_demand")(believed, tuple(found.own[:dimension].tolist()), p)
        assert held == pytest.approx(flown.states[row, loop.n_state : loop.n_state + dimension], rel=1e-9, abs=1e-9)
        same = field(flown_by.system, flown, time, found.place[None, :2])
        assert same.demand[0] == pytest.approx(found.own, rel=1e-9, abs=1e-9)


def standing(made: Problem) -> SimulatedCase:
    """A flight of no duration, which nothing has to be compiled for."""
    vector = made.realisations.flights(made.vector({})[None, :])[0]
    with np.errstate(all="ignore"):
        p = made.system.loop.extend(vector)
        state = (*made.system.loop.part("initial")(p), *made.system.loop.part("initial_guidance")(p))
    return SimulatedCase(vector, np.array([state]), 0, "", np.full((1, 1), np.nan), 0, np.nan)


def check(made: Problem) -> None:
    """The avoider returns a demand of its kind and dimension at every position independently."""
    flown = standing(made)
    here = field(made.system, flown, 0.0, np.zeros((1, 2)))
    places = around(here.place, 30.0, 7)
    found = field(made.system, flown, 0.0, places)
    assert found.kind == made.system.parts.avoider.demand
    assert found.demand.shape == (49, 3)
    assert np.isfinite(found.demand).all()
    assert np.isfinite(found.own).all()
    assert found.demand[24] == pytest.approx(found.own, rel=1e-9, abs=1e-9), "the middle is where the vehicle is"
    for one, place in zip(found.demand[::8], places[::8], strict=True):
        assert (field(made.system, flown, 0.0, place[None]).demand[0] == one).all()
    if made.system.parts.avoider.dimension == 2:
        assert not found.demand[:, 2].any()


@pytest.mark.parametrize("name", AVOIDERS)
def test_every_avoider_answers(name: str) -> None:
    check(problem(components()["avoider", name], compiled=False))


@pytest.mark.by_day(8)
@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_every_campaign_of_the_library_has_a_field(name: str) -> None:
    check(Problem(SHIPPED[name], compiled=False))


@pytest.mark.parametrize(("time", "shown"), [(-1.0, 0.0), (0.0, 0.0), (7.4 * 0.005, 0.035), (1e9, 15.0)])
def test_the_time_is_that_of_the_nearest_step_of_the_flight(case1: Problem, time: float, shown: float) -> None:
    flown = simulate(case1.system, {})
    found = field(case1.system, flown, time, np.zeros((1, 2)))
    assert found.time == pytest.approx(shown)
    assert found.place[:2] == pytest.approx(flown.states[round(shown / case1.system.step), :2])


def test_values_change_the_field_and_unknown_ones_are_refused(case1: Problem) -> None:
    place = np.array([[3.0, 3.0]])
    weak, strong = (
        field(case1.system, simulate(case1.system, {"avoider.k_rep": k}), 1.0, place).demand[0] for k in (0.0, 8.0)
    )
    assert np.linalg.norm(strong - weak) > 1.0
    with pytest.raises(KeyError):
        simulate(case1.system, {"avoider.nothing": 1.0})


def test_it_is_answered_live_between_simulations(live: Live, case1: Problem) -> None:
    places = [[1.0, 2.0], [4.5, 4.5]]
    answer = live.ask(id=1, kind="field", campaign=CASE1, parameters={"vehicle.m": 6.0}, time=3.0, places=places)
    found: Field = field(case1.system, simulate(case1.system, {"vehicle.m": 6.0}), 3.0, np.array(places))
    assert answer["id"] == 1
    assert {k: answer[k] for k in ("time", "kind", "unit")} == {"time": 3.0, "kind": "force", "unit": "N"}
    assert answer["demand"] == found.demand.tolist()
    assert answer["own"] == found.own.tolist()
    assert answer["place"] == found.place.tolist()
    assert set(answer) == {"id", "identity", "unit"} | {f.name for f in dataclasses.fields(Field)}


@pytest.mark.parametrize(
    ("changes", "statement"),
    [
        ({"kind": "music"}, "kind must be 'flight' or 'field', given 'music'"),
        ({"places": []}, "places must be 1 to 10000 pairs of finite numbers"),
        ({"places": [[1.0]]}, "places must be 1 to 10000 pairs of finite numbers"),
        ({"places": [[1.0, float("nan")]]}, "places must be 1 to 10000 pairs of finite numbers"),
        ({"places": [[0.0, 0.0]] * 10_001}, "places must be 1 to 10000 pairs of finite numbers"),
        ({"places": "many"}, "invalid request"),
        ({"time": "late"}, "time must be a number of seconds, given 'late'"),
        ({"time": float("inf")}, "time must be a number of seconds, given inf"),
        ({"parameters": {"vehicle.n": 1.0}}, "the scenario has no parameter 'vehicle.n'"),
    ],
)
def test_invalid_requests_are_refused(live: Live, changes: dict[str, Any], statement: str) -> None:
    request: dict[str, Any] = {"kind": "field", "campaign": CASE1, "time": 1.0, "places": [[0.0, 0.0]]}
    answer = live.ask(id=2, **(request | changes))
    assert set(answer) == {"id", "error"}
    assert statement in answer["error"]
