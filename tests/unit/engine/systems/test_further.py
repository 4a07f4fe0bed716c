"""What lies straight ahead of a vehicle that is still under way is not taken as passed, wherever its line is cut."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from clearance.testing.problems import Problem
from tests.given.beyond_horizon import KNOWN, TRAVELS, met, place, travelling, under_way
from worker.engine.components.obstacles import cooperative_circle, moving_circle
from worker.engine.kernels.component import Rate
from worker.engine.systems.closed_loop import further
from worker.engine.systems.closed_loop.ahead import Ahead, Leg
from worker.engine.systems.closed_loop.onward import Path
from worker.engine.systems.closed_loop.parts import Installed
from worker.engine.systems.closed_loop.trace import trace
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import catalogue, components
from worker.running.opening import opened

HORIZON = 5.0
Points = np.ndarray[Any, np.dtype[np.float64]]


def obstacle(component: str, horizons: float, aside: float) -> dict[str, Any]:
    """One that the vehicle meets so many horizons after it was simulated if it goes straight on."""
    here, velocity = under_way()
    after, left = HORIZON * horizons, np.array([-velocity[1], velocity[0]]) / np.linalg.norm(velocity)
    there = here + after * velocity + aside * left
    rate, since = 1.0, 2.0 * HORIZON + after
    given: dict[str, dict[str, Any]] = {
        "circle": {"position": place(*there)},
        "moving_circle": {  # it is overtaken
            "position": place(*(there - 0.3 * velocity * since)), "goal": place(*(there + 1e3 * velocity)),
            "speed": 0.3 * float(np.linalg.norm(velocity)),
        },
        "orbiting_circle": {
            "centre": place(*(there - 2.0 * np.array([math.cos(rate * since), math.sin(rate * since)]))),
            "way": 2.0, "phase": 0.0, "speed": 2.0 * rate,
        },
    }  # fmt: skip
    return {"component": component, "parameters": given[component] | {"radius": 0.3}}


@pytest.mark.parametrize("component", ["circle", "moving_circle", "orbiting_circle"])
@pytest.mark.parametrize("horizons", [1.5, 4.0, 9.0])
def test_what_lies_ahead_is_not_known_if_the_vehicle_would_come_to_the_threshold(
    component: str, horizons: float
) -> None:
    found = met(travelling(obstacle(component, horizons, 0.0)))
    assert found.unknown is not None
    assert found.unknown.vehicle
    assert found.unknown.obstacle == 1
    assert found.unknown.value < 0.1
    if found.closer:
        assert found.lowest is not None
        assert found.lowest.value > found.unknown.value
    if component == "circle":  # others are met wherever they are on their paths
        assert found.unknown.time == pytest.approx(HORIZON * (1.0 + horizons), rel=0.02)


@pytest.mark.parametrize(
    ("component", "horizons", "aside"),
    [
        ("circle", 4.0, 3.0),
        ("circle", -0.5, 3.0),
        ("circle", -0.5, -3.0),
        ("moving_circle", 4.0, 3.0),
        ("orbiting_circle", 4.0, 9.0),
        ("orbiting_circle", -2.0, 9.0),
    ],
)
def test_what_is_passed_or_lies_aside_bars_nothing(component: str, horizons: float, aside: float) -> None:
    found = met(travelling(obstacle(component, horizons, aside)))
    assert (found.closer, found.unknown) == (0, None)


def test_what_is_met_within_the_horizon_that_is_followed_is_known() -> None:
    found = met(travelling(obstacle("circle", 0.6, 0.2)))
    assert (found.closer, found.unknown) == (1, None)
    assert found.lowest is not None
    assert found.lowest.time == pytest.approx(1.6 * HORIZON, rel=0.02)


TIMES = 0.1 * np.arange(101.0)


def along(x: Points, y: Points | float = 0.0) -> Points:
    return np.stack([x, y + 0.0 * x, 0.0 * x], axis=1)


@pytest.mark.parametrize(
    ("positions", "lasts"),
    [
        (along(3.0 * TIMES), math.inf),
        (along(0.01 * TIMES), math.inf),
        (along(TIMES**2), math.inf),
        (along(10.0 * np.sin(0.3 * TIMES), 10.0 * np.cos(0.3 * TIMES)), math.inf),  # half a circle
        (along(np.sin(3.0 * TIMES), np.cos(3.0 * TIMES)), 0.0),
        (along(5.0 + 0.0 * TIMES), 0.0),
        (along(1e-3 * np.random.default_rng(1).normal(size=101)), 0.0),
        (along(-np.exp(-0.4 * TIMES)), 1.0 / 0.4),
        (along(-np.exp(-0.01 * TIMES)), 1.0 / 0.01),
        (along(np.where(TIMES < 4.0, 8.0 * TIMES, 32.0 + 2.0 * (TIMES - 4.0))), math.inf),
    ],
    ids=[
        "straight", "slowly", "faster and faster", "a bend", "circles", "stands", "hovers", "slows",
        "hardly slows", "slower now",
    ],
)  # fmt: skip
def test_a_vehicle_goes_as_far_as_it_gets(positions: Points, lasts: float) -> None:
    assert further.going(positions, 100, 0.1).lasts == pytest.approx(lasts, rel=0.05)


CREEPING = {
    "is carried on": (along(TIMES), math.inf),
    "stops there": (along(1.0 - np.exp(-TIMES)), 0.0),
    "swings out": (along(np.exp(-0.6 * TIMES) * np.cos(0.8 * TIMES)), 0.0),
    "hardly slows": (along(-np.exp(-0.05 * TIMES)), 20.0),
    "about a place": (along(np.sin(3.0 * TIMES), np.cos(3.0 * TIMES)), 0.0),
}


@pytest.mark.parametrize(("moves", "lasts"), CREEPING.values(), ids=CREEPING)
@pytest.mark.parametrize("speed", [0.05, 0.002, 1e-6])
def test_a_vehicle_that_creeps_has_come_to_its_goal_unless_it_is_carried_on(
    speed: float, moves: Points, lasts: float
) -> None:
    came = np.concatenate([along(3.0 * TIMES[:-1]), along(3.0 * TIMES[-1:]) + speed * (moves - moves[0])])
    assert further.going(came, 100, 0.1).lasts == pytest.approx(lasts, rel=0.05)


@pytest.mark.parametrize(
    ("positions", "about"),
    [
        (along(np.sin(3.0 * TIMES), np.cos(3.0 * TIMES)), 2.0),
        (along(5.0 * np.sin(9.0 * TIMES)), 5.0 + 5.0 * math.sin(90.0)),
        (along(3.0 * TIMES), 0.0),
        (along(5.0 + 0.0 * TIMES), 0.0),
    ],
    ids=["circles", "to and fro", "straight", "stands"],
)
def test_one_that_keeps_moving_about_a_place_may_be_anywhere_there(positions: Points, about: float) -> None:
    assert further.going(positions, 100, 0.1).about == pytest.approx(about, rel=0.01, abs=1e-12)


@pytest.mark.parametrize(
    ("positions", "turned"),
    [
        (along(3.0 * TIMES), 0.0),
        (along(10.0 * np.sin(0.1 * TIMES), 10.0 * np.cos(0.1 * TIMES)), 0.99),
        (along(np.where(TIMES < 4.0, TIMES, 4.0), np.where(TIMES < 4.0, 0.0, TIMES - 4.0)), math.pi / 2.0),
    ],
    ids=["straight", "a bend", "a corner"],
)
def test_by_how_much_a_vehicle_turned(positions: Points, turned: float) -> None:
    assert further.going(positions, 100, 0.1).turned == pytest.approx(turned, abs=1e-7, rel=0.01)


@pytest.mark.parametrize(
    ("positions", "steady"),
    [
        (along(3.0 * TIMES), False),
        (along(10.0 * np.sin(0.1 * TIMES), 10.0 * np.cos(0.1 * TIMES)), True),
        (along(10.0 * np.sin(0.001 * TIMES), 10.0 * np.cos(0.001 * TIMES)), False),  # hardly
        (along(3.0 * TIMES, -np.exp(-TIMES)), False),  # into a line
    ],
    ids=["straight", "a circle", "hardly", "a curve that ends"],
)
def test_what_turns_steadily_goes_round(positions: Points, steady: bool) -> None:
    assert further.going(positions, 100, 0.1).steady == steady


@pytest.mark.parametrize("seed", range(20))
def test_no_circle_comes_nearer_than_a_steady_turn_may(seed: int) -> None:
    random, half = np.random.default_rng(seed), 4.0
    turned, speed = random.uniform(0.1, 1.0), random.uniform(1.0, 5.0)
    times = np.linspace(0.0, 2.0 * math.pi * half / turned, 2000)
    there, radius = random.normal(0.0, 30.0, 2), speed * half / turned
    relative = np.tile([*there, 0.0], (len(times), 1))
    found, _ = further.turning(relative, np.array([speed, 0.0, 0.0]), turned, half, times, steady=True)
    for side in (-1.0, 1.0):
        assert abs(math.hypot(there[0], there[1] - side * radius) - radius) >= found - 0.1
    alone, _ = further.turning(relative, np.array([speed, 0.0, 0.0]), turned, half, times)
    assert found >= alone


@pytest.mark.parametrize("seed", range(5))
def test_nothing_of_a_path_that_repeats_is_closer_than_is_found(seed: int) -> None:
    random = np.random.default_rng(seed)
    angle = np.linspace(0.0, 2.0 * np.pi, 201)
    centres = random.normal(size=3) + 3.0 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    path = Path(angle, centres, whole=True, repeats=True)
    begin, velocity, lasts = random.normal(0.0, 9.0, 3), random.normal(0.0, 2.0, 3), random.uniform(1.0, 9.0)
    line = begin + np.linspace(0.0, lasts, 2000)[:, None] * velocity
    true = np.linalg.norm(line[:, None] - centres, axis=2).min()
    found, _ = further.after(path, begin, velocity, lasts)
    assert found <= true
    assert found == pytest.approx(true, abs=0.2)


def nearest(one: Points, other: Points) -> float:
    return float(np.linalg.norm(one[:, None] - other, axis=2).min())


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("lasts", [2.0, math.inf])
def test_an_obstacle_may_stop_anywhere_on_its_line(seed: int, lasts: float) -> None:
    relative, velocity, drift = np.random.default_rng(seed).normal(size=(3, 3))
    along_own = np.linspace(0.0, min(lasts, 40.0), 800)[:, None] * velocity
    along_its = relative + np.linspace(0.0, 40.0, 800)[:, None] * drift
    found, time = further.crossing(relative, velocity, lasts, drift)
    assert 0.0 <= time <= lasts
    assert found <= nearest(along_own, along_its) <= found + 0.1


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("turned", [0.0, 0.3, 2.0])
def test_one_that_turned_may_turn_on_at_that_rate(seed: int, turned: float) -> None:
    """In the plane: no path with that speed, whose direction stays within what it may have turned to, comes nearer."""
    random, times = np.random.default_rng(seed), np.linspace(0.0, 8.0, 801)
    there, velocity = random.normal(0.0, 20.0, 2), random.normal(0.0, 3.0, 2)
    relative = np.tile([*there, 0.0], (len(times), 1))
    found, _ = further.turning(relative, np.array([*velocity, 0.0]), turned, 4.0, times)
    for _ in range(50):
        most = turned * (1.0 + times[:-1] / 4.0)
        directions = np.arctan2(velocity[1], velocity[0]) + most * np.sin(
            random.normal() * times[:-1] + random.normal()
        )
        speed = np.linalg.norm(velocity) * random.uniform(0.2, 1.0)
        moved = speed * 0.01 * np.stack([np.cos(directions), np.sin(directions)], axis=1)
        path = np.concatenate([np.zeros((1, 2)), np.cumsum(moved, axis=0)])
        assert np.linalg.norm(path - there, axis=1).min() >= found - 0.1


COOPERATIVE = components()["obstacle", "cooperative_circle"]


@pytest.fixture(params=["a reach", "no reach"])
def own(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """An obstacle of one's own with states, `own`."""
    made = replace(COOPERATIVE, name="own", **({"reach": None} if request.param == "no reach" else {}))  # type: ignore[type-var]
    install(made, cooperative_circle, monkeypatch)


def install(made: Any, module: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    described = catalogue()
    entry = component_entry(made, module)
    described = described.model_copy(update={"components": [*described.components, entry]})
    every = Installed(components() | {("obstacle", "own"): made}, described)
    monkeypatch.setattr(opened, "installed", lambda: every)


def leaving(ahead: float, aside: float, speed: float) -> dict[str, Any]:
    """One with states that moves straight away from the vehicle, so far ahead [m] and in that direction."""
    here, velocity = under_way()
    along_it = velocity / np.linalg.norm(velocity)
    way = math.cos(aside) * along_it + math.sin(aside) * np.array([-along_it[1], along_it[0]])
    begin, goal = here + ahead * along_it - 2.0 * HORIZON * speed * way, here + 1e5 * way
    given = {"position": place(*begin), "goal": place(*goal), "speed": speed, "clearance": 0.0, "radius": 0.3}
    return {"component": "own", "parameters": given}


@pytest.mark.usefixtures("own")
def test_what_moves_away_on_the_line_of_the_vehicle_may_stop_there() -> None:
    found = met(travelling(leaving(20.0, 0.0, 9.0)))
    assert found.unknown is not None
    assert (found.unknown.obstacle, found.unknown.vehicle) == (1, None)
    assert found.unknown.value < 0.1


@pytest.mark.parametrize(("passes", "unknown"), [(6.0, True), (-6.0, False)])
def test_what_comes_straight_to_where_a_vehicle_that_slows_down_stands_is_not_known(
    passes: float, unknown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    straight = replace(moving_circle.component, name="own", rate=Rate(times=0.0))
    install(straight, moving_circle, monkeypatch)
    monkeypatch.setattr(further, "going", lambda *_: further.Remaining(3.0 * HORIZON))
    here, velocity = under_way()
    stands, across = here + 3.0 * HORIZON * velocity, 4.0 * np.array([-velocity[1], velocity[0]])
    begin = stands - (2.0 + passes) * HORIZON * across
    given = {"position": place(*begin), "goal": place(*(begin + 4e3 * across)), "speed": float(np.linalg.norm(across))}
    found = met(travelling({"component": "own", "parameters": given | {"radius": 0.3}}))
    assert (found.unknown is not None) == unknown
    if found.unknown is not None:
        assert found.unknown.vehicle
        assert found.unknown.time == pytest.approx((1.0 + passes) * HORIZON, rel=0.02)


@pytest.mark.parametrize(("over", "horizons"), [("searched", 1e12), ("steps", 1e4)])
def test_what_lies_near_is_met_however_slowly_a_vehicle_slows_down(
    over: Any, horizons: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The samples of so long a line are farther apart than the obstacle is wide."""
    criterion: Any = components()["criterion", "surface_separation"]
    every = Installed(components() | {("criterion", criterion.name): replace(criterion, over=over)}, catalogue())
    monkeypatch.setattr(opened, "installed", lambda: every)
    monkeypatch.setattr(further, "going", lambda *_: further.Remaining(horizons * HORIZON))
    found = met(travelling(obstacle("circle", 4.1, 0.0)))
    assert found.unknown is not None
    assert (found.unknown.obstacle, found.unknown.vehicle) == (1, True)
    assert found.unknown.time == pytest.approx(5.1 * HORIZON, rel=0.02)


def straight_on(passes: Points, velocity: Points, after: float) -> dict[str, Any]:
    """One of one's own that is at a place so long after the last sample [s]."""
    begin, goal = passes - (2.0 * HORIZON + after) * velocity, passes + 4e3 * velocity
    given = {"position": place(*begin), "goal": place(*goal), "speed": float(np.linalg.norm(velocity)), "radius": 0.3}
    return {"component": "own", "parameters": given}


def test_what_has_no_finite_value_where_the_vehicle_stops_is_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    install(replace(moving_circle.component, name="own", rate=Rate(times=0.0)), moving_circle, monkeypatch)
    here, velocity = under_way()
    away = travelling(straight_on(here - 9.0 * HORIZON * velocity, -0.1 * velocity, 0.0))
    assert met(away).unknown is None
    lowest = Ahead.lowest

    def at_rest(self: Ahead, i: int, leg: Leg, drift: Points | None = None) -> tuple[float, float]:
        value, time = lowest(self, i, leg, drift)
        return (math.nan if i == 1 and not leg.begins and not leg.velocity.any() else value), time

    monkeypatch.setattr(Ahead, "lowest", at_rest)
    found = met(away)
    assert found.unknown is not None
    assert found.unknown.obstacle == 1


def test_what_comes_to_where_the_vehicle_stops_may_come_closer_if_it_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its own body is followed: near where the vehicle stops after a horizon, and before that nearer, ahead of it."""
    install(replace(moving_circle.component, name="own", reach=None), moving_circle, monkeypatch)
    monkeypatch.setattr(further, "going", lambda *_: further.Remaining(1.2 * HORIZON))
    here, velocity = under_way()
    left = np.array([-velocity[1], velocity[0]]) / np.linalg.norm(velocity)
    nearer, near = here + 1.1 * HORIZON * velocity + 0.7 * left, here + HORIZON * velocity + 1.0 * left
    slow = (near - nearer) / (0.2 * HORIZON)
    found = met(travelling(straight_on(nearer, slow, 1.1 * HORIZON)))
    assert found.closer == 1
    assert found.lowest is not None
    assert found.unknown is not None
    assert found.unknown.vehicle
    assert found.unknown.value < found.lowest.value < KNOWN


def test_a_body_of_which_no_extent_is_known_is_seen_nowhere_else(monkeypatch: pytest.MonkeyPatch) -> None:
    """It may not be known there."""
    install(replace(moving_circle.component, name="own", reach=None), moving_circle, monkeypatch)
    monkeypatch.setattr(Ahead, "leans", Mock(side_effect=ZeroDivisionError))
    here, velocity = under_way()
    assert met(travelling(straight_on(here - 9.0 * HORIZON * velocity, -0.1 * velocity, 0.0))).flights == 1


@pytest.mark.usefixtures("own")
def test_what_moves_away_elsewhere_bars_nothing_and_hides_nothing() -> None:
    assert met(travelling(leaving(-20.0, 2.0, 3.0))).unknown is None
    found = met(travelling(obstacle("circle", 4.0, 0.0), leaving(-20.0, 2.0, 3.0)))
    assert found.unknown is not None
    assert (found.unknown.obstacle, found.unknown.vehicle) == (1, True)


def test_what_a_vehicle_that_turned_may_turn_to_is_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    beside = travelling(obstacle("circle", 0.5, 6.0))
    assert met(beside).unknown is None
    straight = further.going
    monkeypatch.setattr(further, "going", lambda *of: straight(*of)._replace(turned=0.7))
    found = met(beside)
    assert found.unknown is not None
    assert (found.unknown.obstacle, found.unknown.vehicle) == (1, True)


def test_what_comes_to_the_place_about_which_a_vehicle_moves_is_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    here, velocity = under_way()
    left = np.array([-velocity[1], velocity[0]]) / np.linalg.norm(velocity)
    begin, goal = here + 8.0 * left - 300.0 * velocity, here + 8.0 * left + 300.0 * velocity
    given = {"position": place(*begin), "goal": place(*goal), "speed": 5.0, "radius": 0.3}
    crossing = travelling({"component": "moving_circle", "parameters": given})
    monkeypatch.setattr(further, "rounds", lambda *_: None)
    monkeypatch.setattr(further, "going", lambda *_: further.Remaining(about=5.0))
    assert met(crossing).unknown is None
    monkeypatch.setattr(further, "going", lambda *_: further.Remaining(about=9.0))
    found = met(crossing)
    assert found.unknown is not None
    assert (found.unknown.obstacle, found.unknown.vehicle) == (1, True)


STEADILY = {"component": "none", "parameters": {"k_att": 5.0, "s": 7.0}}
"""Attraction that is constant until the goal is near, so that the vehicle does not slow down before."""


@cache
def steadily() -> tuple[Points, Points]:
    """Place and velocity of that vehicle after twice its horizon."""
    longer = Problem(travelling(scenario__horizon=2.0 * HORIZON, scenario__avoider=STEADILY), compiled=False)
    path = trace(longer.system, "nominal", {}).data  # type: ignore[arg-type]
    return path[-1, 1:3], (path[-1, 1:3] - path[-2, 1:3]) / TRAVELS


@pytest.mark.parametrize("at", [(300.0, 380.0), (700.0, 700.0), (-900.0, 50.0)])
def test_nothing_is_known_of_a_vehicle_under_way_to_its_goal(at: tuple[float, float]) -> None:
    """It turns there: an aircraft that passed its goal came to an obstacle beside its line."""
    beside = {"component": "circle", "parameters": {"position": place(*at), "radius": 0.3}}
    found = met(travelling(beside, scenario__avoider=STEADILY))
    assert found.unknown is not None
    assert found.unknown.vehicle
    here, velocity = steadily()
    way = float(np.linalg.norm(np.array([600.0, 700.0]) - here))
    assert found.unknown.goal == pytest.approx(way / np.linalg.norm(velocity), rel=0.01)
    assert found.unknown.time > HORIZON + found.unknown.goal


def test_a_vehicle_that_comes_to_rest_at_its_goal_gets_no_farther() -> None:
    assert met(travelling(obstacle("circle", 4.0, 3.0))).unknown is None


@pytest.mark.usefixtures("own")
@pytest.mark.parametrize(("speed", "known"), [(0.5, False), (3.0, True)])
def test_what_outruns_a_vehicle_under_way_to_its_goal_is_not_met(speed: float, known: bool) -> None:
    here, velocity = steadily()
    begin, goal = here - 300.0 * velocity, here - 1e5 * velocity
    away = {"position": place(*begin), "goal": place(*goal), "speed": speed * float(np.linalg.norm(velocity))}
    own = {"component": "own", "parameters": away | {"clearance": 0.0, "radius": 0.3}}
    found = met(travelling(scenario__obstacles=[own], scenario__avoider=STEADILY))
    assert (found.unknown is None) == known


@pytest.mark.parametrize("component", ["orbiting_circle", "moving_circle"])
def test_what_circles_or_comes_to_its_end_outruns_no_vehicle_under_way_to_its_goal(component: str) -> None:
    fast = 3.0 * float(np.linalg.norm(steadily()[1]))
    given = {
        "orbiting_circle": {"centre": place(700.0, 700.0), "way": 10.0, "phase": 1.0},
        "moving_circle": {"position": place(650.0, 700.0), "goal": place(700.0, 750.0)},
    }
    parameters = given[component] | {"radius": 0.3, "speed": fast}
    found = met(travelling({"component": component, "parameters": parameters}, scenario__avoider=STEADILY))
    assert found.unknown is not None


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("faster", [0.5, 1.0, 2.0])
def test_when_a_vehicle_first_reaches_what_moves_straight_on(seed: int, faster: float) -> None:
    relative, drift = np.random.default_rng(seed).normal(size=(2, 3))
    speed = faster * float(np.linalg.norm(drift))
    found, times = further.reaching(relative, drift, speed), np.linspace(0.0, 500.0, 500_001)
    gap = np.linalg.norm(relative + times[:, None] * drift, axis=1) - speed * times
    if math.isfinite(found) and found < 500.0:
        assert np.linalg.norm(relative + found * drift) == pytest.approx(speed * found)
        assert (gap[times < found - 1e-3] > 0.0).all()
    else:
        assert (gap > 0.0).all()
