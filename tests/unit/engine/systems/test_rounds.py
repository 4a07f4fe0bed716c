"""What goes round is carried on by what carries it, and what lies there is not taken as passed."""

from __future__ import annotations

import copy
import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.results.validate import Beyond
from clearance.testing.problems import Problem
from worker.engine.systems import optional
from worker.engine.systems.closed_loop import rounds
from worker.engine.systems.closed_loop.ending import End
from worker.engine.systems.closed_loop.further import Remaining
from worker.engine.systems.closed_loop.onward import Path
from worker.engine.systems.closed_loop.trace import Seen

Points = np.ndarray[Any, np.dtype[np.float64]]
EACH, LATE = 0.04, 500
TIMES: Points = EACH * np.arange(2001.0)
"""Twice a horizon of 40 s; the last half of one is late."""


def along(x: Any, y: Any, z: Any = 0.0) -> Points:
    return np.stack([x, y, z + 0.0 * x], axis=1)


SHAPES = {
    "a circle": along(30.0 * np.cos(0.5 * TIMES), 30.0 * np.sin(0.5 * TIMES)),
    "hardly twice round": along(30.0 * np.cos(0.19 * TIMES), 30.0 * np.sin(0.19 * TIMES)),
    "fast": along(np.cos(20.0 * TIMES), np.sin(20.0 * TIMES)),
    "tilted": along(9.0 * np.cos(0.7 * TIMES), 7.0 * np.sin(0.7 * TIMES), 5.0 * np.sin(0.7 * TIMES)),
    "upright": along(9.0 * np.cos(0.7 * TIMES), 0.0 * TIMES, 9.0 * np.sin(0.7 * TIMES)),
    "to and fro": along(5.0 * np.sin(TIMES), 0.0 * TIMES),
    "an eight": along(5.0 * np.sin(TIMES), 3.0 * np.sin(2.0 * TIMES)),
}
SLOWLY = np.array([0.1, -0.2, 0.05])


@pytest.mark.parametrize("places", SHAPES.values(), ids=SHAPES)
def test_rounds_that_stay_are_none(places: Points) -> None:
    assert rounds.rounds(places, LATE, EACH) is None


@pytest.mark.parametrize("places", SHAPES.values(), ids=SHAPES)
@pytest.mark.parametrize("drift", [SLOWLY, -0.2 * SLOWLY, np.array([0.0, 0.0, 0.1]), 3.0 * SLOWLY])
def test_rounds_are_carried_on_in_any_direction(places: Points, drift: Points) -> None:
    found = rounds.rounds(places + np.outer(TIMES, drift), LATE, EACH)
    assert found is not None
    assert found.carried == pytest.approx(drift, abs=0.03 * float(np.linalg.norm(drift)))
    assert (found.lasts, found.grows) == (math.inf, 0.0)
    assert found.aside < 0.1 * float(np.linalg.norm(drift))


@pytest.mark.parametrize("places", SHAPES.values(), ids=SHAPES)
@pytest.mark.parametrize("rate", [0.01, 0.002])
def test_rounds_that_grow_may_get_anywhere_and_those_that_shrink_stay(places: Points, rate: float) -> None:
    found = rounds.rounds(places * (1.0 + rate * TIMES)[:, None], LATE, EACH)
    assert found is not None
    assert found.grows > 0.0
    shrinks = rounds.rounds(places * np.exp(-rate * TIMES)[:, None], LATE, EACH)
    assert shrinks is None or shrinks.grows == 0.0


def test_rounds_that_are_carried_more_and_more_slowly_get_as_far_as_that() -> None:
    settles = SHAPES["a circle"] - along(40.0 * np.exp(-0.02 * TIMES), 0.0 * TIMES)
    found = rounds.rounds(settles, LATE, EACH)
    assert found is not None
    assert found.lasts == pytest.approx(1.0 / 0.02, rel=0.1)


def test_a_single_round_about_the_goal_is_not_carried_on() -> None:
    """It is guided there, and comes to its circle only now."""
    arrives = SHAPES["a circle"] + along(0.5 * np.minimum(TIMES - 54.0, 0.0) + 0.05 * TIMES, 0.0 * TIMES)
    for goal, carried in (((4.0, 9.0, 0.0), False), ((4.0, 90.0, 0.0), True), ((math.nan,) * 3, True)):
        assert (rounds.rounds(arrives, LATE, EACH, np.array(goal)) is not None) == carried


@pytest.mark.parametrize("seed", range(10))
def test_what_differs_from_round_to_round_is_not_carried_on(seed: int) -> None:
    """As about a goal: each round ends elsewhere, none gets away."""
    wanders = np.interp(TIMES, np.linspace(0.0, 80.0, 14), np.random.default_rng(seed).normal(0.0, 1.0, 14))
    assert rounds.rounds(SHAPES["a circle"] + along(wanders, 0.7 * wanders[::-1]), LATE, EACH) is None


def test_rounds_that_are_not_yet_steady_may_be_carried_aside() -> None:
    turning_aside = along(0.2 * TIMES, 0.002 * TIMES**2)
    found = rounds.rounds(SHAPES["a circle"] + turning_aside, LATE, EACH)
    assert found is not None
    across = 0.2 / float(np.linalg.norm(found.carried))
    assert found.aside == pytest.approx(2.0 * 0.002 * 2.0 * math.pi / 0.5 * across, rel=0.2)


def under_way(until: float, speed: float) -> Points:
    """What comes to a place along x, and is there from some time on [s]."""
    return along(speed * np.minimum(TIMES - until, 0.0), 0.0 * TIMES)


@pytest.mark.parametrize("speed", [1.0, 20.0])
@pytest.mark.parametrize("until", [30.0, 44.0, 55.0])
@pytest.mark.parametrize("shape", ["an eight", "to and fro", "tilted"])
def test_a_vehicle_that_was_under_way_before_it_circled_is_carried_on_for_ever(
    shape: str, until: float, speed: float
) -> None:
    since = int(np.searchsorted(TIMES, until))
    places = np.concatenate([np.repeat(SHAPES[shape][:1], since, axis=0), SHAPES[shape][: len(TIMES) - since]])
    arrives = places + under_way(until, speed)
    assert rounds.rounds(arrives, LATE, EACH) is None
    found = rounds.rounds(arrives + np.outer(TIMES, 0.3 * SLOWLY), LATE, EACH)
    assert found is not None
    assert found.carried == pytest.approx(0.3 * SLOWLY, abs=0.01)
    assert found.lasts == math.inf
    assert found.aside < 0.02


def test_rounds_that_were_carried_faster_until_they_kept_their_velocity_go_on() -> None:
    fast_before = along(0.5 * np.minimum(TIMES - 54.0, 0.0) + 0.05 * TIMES, 0.0 * TIMES)
    found = rounds.rounds(SHAPES["a circle"] + fast_before, LATE, EACH)
    assert found is not None
    assert found.carried == pytest.approx([0.05, 0.0, 0.0], abs=0.01)
    assert found.lasts == math.inf


def test_rounds_that_grow_less_and_less_stay() -> None:
    widens = SHAPES["a circle"] * (1.0 - 0.9 * np.exp(-0.06 * TIMES))[:, None]
    assert rounds.rounds(widens, LATE, EACH) is None


def test_a_round_is_no_whole_number_of_intervals() -> None:
    angle = 2.0 * math.pi * np.arange(80) / 10.4
    drift = np.outer(np.arange(80.0), (0.3, 0.0, 0.0))
    found = rounds.rounds(along(np.cos(angle), np.sin(angle)) + drift, 12, 1.0)
    assert found is not None
    assert found.carried == pytest.approx([0.3, 0.0, 0.0], abs=5e-4)


def test_an_arc_of_few_places_that_shrinks_shows_what_carries_its_circle() -> None:
    angle = np.linspace(0.0, 6.0, 21)
    for swells in (0.0, -0.05):
        size, drift = 20.0 * np.exp(swells * angle), np.outer(angle, (1.0, 0.0, 0.5))
        found = rounds.fitted(along(size * np.cos(angle), size * np.sin(angle)) + drift, 0.3)
        assert found is not None
        assert found.carried == pytest.approx([1.0, 0.0, 0.5], abs=0.02)
        assert found.reach == pytest.approx(size[-1], rel=0.006)


@pytest.mark.parametrize("rate", [1e-3, 5e-3])
def test_rounds_that_shrink_while_they_are_carried_on_do_not_stay(rate: float) -> None:
    shrinks = SHAPES["a circle"] * np.exp(-rate * TIMES)[:, None]
    assert rounds.rounds(shrinks, LATE, EACH) is None
    found = rounds.rounds(shrinks + np.outer(TIMES, 0.1 * SLOWLY), LATE, EACH)
    assert found is not None
    assert found.carried == pytest.approx(0.1 * SLOWLY, abs=2e-3)


@pytest.mark.parametrize("rate", [0.01, 0.03, 0.06])
@pytest.mark.parametrize("shape", ["to and fro", "an eight", "tilted"])
def test_what_swings_out_stays(shape: str, rate: float) -> None:
    assert rounds.rounds(SHAPES[shape] * np.exp(-rate * TIMES)[:, None], LATE, EACH) is None


def test_what_moves_about_irregularly_in_a_plane_and_climbs_moves_on() -> None:
    about = along(*(5.0 * f(TIMES) + 3.0 * f(1.618 * TIMES) for f in (np.cos, np.sin)))
    assert rounds.rounds(about, LATE, EACH) is None
    found = rounds.rounds(about + np.outer(TIMES, (0.0, 0.0, 0.01)), LATE, EACH)
    assert found is not None
    assert found.carried == pytest.approx([0.0, 0.0, 0.01], abs=1e-3)


def test_what_jumps_between_two_places_stays() -> None:
    jumps = along(0.5 * (np.arange(len(TIMES)) % 2), 0.0 * TIMES)
    assert rounds.rounds(jumps, LATE, EACH) is None


@pytest.mark.parametrize("seed", range(10))
def test_noise_stays_unless_it_moves_on_all_the_time(seed: int) -> None:
    hovers = np.random.default_rng(seed).normal(size=(len(TIMES), 3))
    assert rounds.rounds(hovers, LATE, EACH) is None
    found = rounds.rounds(hovers + np.outer(TIMES, (0.3, 0.0, 0.0)), LATE, EACH)
    assert found is not None
    assert found.carried == pytest.approx([0.3, 0.0, 0.0], abs=0.05)


@pytest.mark.parametrize("count", range(1, 12))
def test_few_places_show_what_they_can(count: int) -> None:
    places = SHAPES["a circle"][:: 2000 // count][:count]
    assert rounds.rounds(np.ascontiguousarray(places), max(count // 2, 1), EACH) is None


@pytest.mark.parametrize("turned", [1.0, 2.0, 3.5])
@pytest.mark.parametrize("drift", [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.3, -0.5)])
def test_an_arc_shows_what_carries_its_circle(turned: float, drift: tuple[float, float, float]) -> None:
    rate = turned / 20.0
    arc = along(20.0 / rate * np.cos(rate * TIMES), 20.0 / rate * np.sin(rate * TIMES)) + np.outer(TIMES, drift)
    found = rounds.fitted(arc[-LATE - 1 :], EACH)
    assert (found is None) == (not any(drift))
    if found is not None:
        assert found.carried == pytest.approx(drift, abs=0.01)
        assert found.centre == pytest.approx(80.0 * np.array(drift), abs=0.02 * found.reach)
        assert found.reach == pytest.approx(20.0 / rate, rel=0.01)


@pytest.mark.parametrize("turned", [2e-3, 0.01, 0.04])
def test_a_slight_turn_leads_onto_a_wide_circle(turned: float) -> None:
    rate = turned / 20.0
    radius = 20.0 / rate
    arc = along(radius * np.sin(rate * TIMES), radius * (1.0 - np.cos(rate * TIMES)))[-LATE - 1 :]
    turn, velocity = rounds.bend(arc, EACH), (arc[-1] - arc[-2]) / EACH
    assert turn is not None
    assert turn == pytest.approx([0.0, 0.0, rate], rel=0.01, abs=1e-3 * rate)
    after = np.linspace(0.0, 2.0 * math.pi / rate, 50)
    circle = along(radius * np.sin(rate * (80.0 + after)), radius * (1.0 - np.cos(rate * (80.0 + after))))
    assert np.linalg.norm(rounds.onto(arc[-1], velocity, turn, after) - circle, axis=1).max() < 0.01 * radius


@pytest.mark.parametrize(
    "places",
    [
        along(20.0 * TIMES, 0.0 * TIMES),
        along(20.0 * TIMES, 0.01 * np.sin(9.0 * TIMES)),
        along(20.0 * TIMES, 3.0 * np.exp(-0.3 * TIMES)),
        along(20.0 * TIMES, 0.003 * np.random.default_rng(1).normal(size=len(TIMES))),
        along(0.0 * TIMES, 0.0 * TIMES),
    ],
    ids=["straight", "swings", "comes onto its line", "noise", "stands"],
)
def test_what_does_not_turn_evenly_leads_onto_no_circle(places: Points) -> None:
    assert rounds.bend(places[-LATE - 1 :], EACH) is None


@pytest.mark.parametrize("orbits", [False, True])
@pytest.mark.parametrize(("across", "open_"), [(20_000.0, 1), (10_000.0, 0), (-20_000.0, 0)])
def test_what_lies_on_the_wide_circle_is_not_known(orbits: bool, across: float, open_: int) -> None:
    """A circle of 10 km: what lies across it is met, not what lies in its middle or on the other side."""
    end, there = object.__new__(End), np.array([0.0, across, 0.0])
    times = np.linspace(0.0, 60.0, 1001)
    orbit = there + along(3.0 * np.cos(0.3 * times), 3.0 * np.sin(0.3 * times))
    vars(end).update(
        _place=np.zeros(3), _own=np.array([20.0, 0.0, 0.0]), _relative=there, _drift=np.zeros(3), _extent=1.0,
        _path=Path(times, orbit, whole=True, repeats=True) if orbits else None,
        _index=0, _since=0.0, _threshold=1.0, _below=math.inf,
    )  # fmt: skip
    found = [*end._bending(Remaining(bend=np.array([0.0, 0.0, 0.002])))]
    assert len(found) == open_
    assert all(not each.known and each.vehicle and 1400.0 < each.time < 1800.0 for each in found)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("lasts", [math.inf, 9.0])
def test_the_nearest_place_within_what_may_be_carried_aside(seed: int, lasts: float) -> None:
    random = np.random.default_rng(seed)
    carried, drift, centre, there = random.normal(size=(4, 3))
    aside = float(random.choice([0.0, 0.3, 5.0]))
    found = rounds.Rounds(centre, 2.0, carried, aside, lasts)
    distance, when = found.nearest(9.0 * there[None], drift)
    times = np.linspace(0.0, min(lasts, 400.0), 20_001)
    apart = np.linalg.norm(9.0 * there + np.outer(times, drift - carried) - centre, axis=1) - aside * times - 2.0
    assert 0.0 <= when <= lasts
    if math.isinf(lasts) and aside > np.linalg.norm(carried - drift):
        assert distance < 0.0 > apart.min()
    else:
        assert distance == pytest.approx(apart.min(), abs=1e-3)


def test_what_keeps_pace_with_rounds_stays_as_far_away() -> None:
    found = rounds.Rounds(np.zeros(3), 2.0, SLOWLY)
    assert found.nearest(np.array([[9.0, 0.0, 0.0]]), SLOWLY) == (7.0, 0.0)


HORIZON = 30.0


def turning(wind: float, *obstacles: dict[str, Any], rudder: float = 0.15) -> Problem:
    """An aircraft with its rudder hard over in a steady wind along x [m/s]."""
    document = copy.deepcopy(load_file(library()["uav_static_wind"]).document())
    over = {"component": "hard_over", "on": "rudder", "parameters": {"at": 0.0, "over": 1.0, "value": rudder}}
    document["scenario"] |= {
        "horizon": HORIZON, "faults": [over], "obstacles": [*obstacles],
        "environment": [{"component": "steady_wind", "parameters": {"x": wind, "y": 0.0}}],
    }  # fmt: skip
    document["uncertain"] = {"vehicle.m": {"low": 1.52, "high": 2.28}}
    document["stages"] = {"search": [{"method": "direct", "evaluations": 50}]}
    return Problem(load_document(document), compiled=False)


def at(place: Points, component: str = "sphere") -> dict[str, Any]:
    x, y, z = map(float, place)
    size = {"sphere": {"radius": 1.0}, "orbiting_sphere": {"radius": 1.0, "way": 3.0, "speed": 1.0}}[component]
    where = {"sphere": "position", "orbiting_sphere": "centre"}[component]
    return {"component": component, "parameters": {where: {"x": x, "y": y, "z": z}} | size}


@cache
def later(wind: float, horizons: int, rudder: float = 0.15) -> Points:
    """Where that aircraft is after so many horizons; no obstacle is near."""
    problem: Any = turning(wind, at(np.array([-9000.0, 0.0, 0.0])), rudder=rudder)
    system, row = problem.system, problem.vectors(problem.nominal_point[None, :])[0]
    steps, every = system.counts(system.step)
    flown = system.loop.simulate(row[None, :], system.step, horizons * steps, every, traced=1).trace[0]
    last = system.loop.observe(flown[-1:], row, system.step, horizons * steps)
    place: Points = Seen(system, last, row).positions[0]
    return place


def met(problem: Problem) -> Beyond:
    found = optional.beyond(
        problem.system, ["nominal"], problem.vectors(problem.nominal_point[None, :]), [None], 1e9, lambda: False
    )
    assert found is not None
    return found


@pytest.mark.by_day(1)
@pytest.mark.parametrize("component", ["sphere", "orbiting_sphere"])
@pytest.mark.parametrize("wind", [2.0, -1.0])
@pytest.mark.parametrize("horizons", [6, 9])
def test_what_the_wind_carries_a_circling_aircraft_to_is_not_known(component: str, wind: float, horizons: int) -> None:
    found = met(turning(wind, at(later(wind, horizons), component)))
    assert found.unknown is not None
    assert found.unknown.vehicle
    assert found.unknown.value < 25.0
    assert HORIZON < found.unknown.time < 1.5 * horizons * HORIZON
    away = later(wind, 2) - 3.0 * (later(wind, horizons) - later(wind, 2))
    behind = met(turning(wind, at(away, component)))
    assert behind.unknown is None


@pytest.mark.nightly
def test_without_wind_it_stays_where_it_circles() -> None:
    away = later(0.0, 9) + np.array([300.0, 0.0, 0.0])
    assert met(turning(0.0, at(away))).unknown is None


@pytest.mark.by_day(1)
@pytest.mark.parametrize("component", ["orbiting_sphere", "sphere"])
def test_what_is_far_along_a_wide_circle_is_not_known(component: str) -> None:
    """An obstacle that repeats its path is there whenever the vehicle comes."""
    found = met(turning(0.0, at(later(0.0, 12, 0.005), component), rudder=0.005))
    assert found.unknown is not None
    assert found.unknown.vehicle
    assert found.unknown.value < 25.0
