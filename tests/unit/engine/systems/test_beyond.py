"""What flights meet beyond the horizon: obstacles that turn, stop, repeat their path, or have states."""

from __future__ import annotations

import math
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from clearance.testing.problems import Problem
from tests.given.at_night import nightly_but
from tests.given.beyond_horizon import GOAL, HORIZON, STEP, beyond, place, scene
from worker.engine.systems.closed_loop import onward, samples
from worker.engine.systems.closed_loop.trace import trace


def orbit(arrives: float, miss: float, turns: float = 0.7) -> dict[str, Any]:
    """A circle that passes the goal at a time, at a distance, after so many turns."""
    way, angle = 12.0, 0.6
    phase = math.remainder(angle - 2 * math.pi * turns, 2 * math.pi)
    centre = place(*(g - (way + miss) * c for g, c in zip(GOAL, (math.cos(angle), math.sin(angle)), strict=True)))
    return {"centre": centre, "way": way, "phase": phase, "speed": 2 * math.pi * turns * way / arrives}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("horizons", nightly_but((2.3, 9.0), [2.3, 3.0, 4.0, 9.0]))
def test_an_orbit_is_followed_for_a_whole_turn(horizons: float) -> None:
    found = beyond("orbiting_circle", **orbit(horizons * HORIZON, 0.4))
    assert found.closer == 1
    assert found.unknown is None
    assert found.lowest is not None
    assert not found.lowest.simulated
    assert found.lowest.obstacle == 1
    assert found.lowest.time == pytest.approx((horizons - 1.0) * HORIZON, abs=0.5)
    assert found.lowest.value == pytest.approx(0.4, abs=0.2)


def test_distance_and_closing_speed_are_those_at_the_horizon() -> None:
    turns = orbit(2.3 * HORIZON, 0.4)
    found = beyond("orbiting_circle", **turns).lowest
    flight = trace(Problem(scene("orbiting_circle", **turns), compiled=False).system, "nominal", {})
    (before, now), centre = flight.data[-2:, 1:3], turns["centre"]
    assert flight.data[-1, 0] == pytest.approx(HORIZON)
    times = np.array([HORIZON - STEP, HORIZON])
    angles = turns["phase"] + turns["speed"] * times / turns["way"]
    places = np.column_stack([centre["x"] + turns["way"] * np.cos(angles), centre["y"] + turns["way"] * np.sin(angles)])
    apart = np.linalg.norm(places - [before, now], axis=1)
    assert found is not None
    assert not found.simulated
    assert found.distance == pytest.approx(apart[1], rel=1e-9)
    assert found.closing == pytest.approx((apart[0] - apart[1]) / STEP, rel=1e-6)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("horizons", nightly_but((0.4, 50.0), [0.4, 1.9, 4.0, 50.0]))
def test_an_orbit_that_stays_away_bars_nothing(horizons: float) -> None:
    found = beyond("orbiting_circle", **orbit(horizons * HORIZON, 8.0))
    assert (found.closer, found.unknown) == (0, None)


@pytest.mark.nightly
def test_a_path_is_followed_to_its_end() -> None:
    """It moves away at twice the horizon, and turns later."""
    far = {"position": place(30.0, 7.0), "waypoint1": place(70.0, 7.0), "speed": 2.0}
    found = beyond("waypoint_circle", **far, waypoint2=place(-90.0, 7.3), legs=2.0)
    assert found.closer == 1
    assert found.lowest is not None
    assert found.lowest.closing < 0.0
    assert found.lowest.time == pytest.approx((40.0 + 64.0) / 2.0 - HORIZON, abs=0.5)
    ended = beyond("waypoint_circle", **far, waypoint2=place(20.0, 7.3), legs=2.0)
    assert (ended.closer, ended.unknown) == (0, None)


@pytest.mark.parametrize("intervals", [100, onward.MOST])
def test_a_path_that_is_cut_in_the_middle_of_a_leg_is_not_known(
    intervals: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It moves away steadily for hours, and comes back."""
    monkeypatch.setattr(onward, "MOST", intervals)
    far = {"position": place(30.0, 7.0), "waypoint1": place(9000.0, 7.0), "waypoint2": place(-90.0, 7.3)}
    found = beyond("waypoint_circle", **far, legs=2.0, speed=2.0)
    assert (found.closer, found.unknown is not None) == ((0, True) if intervals == 100 else (1, False))


@pytest.mark.parametrize(
    ("position", "goal", "unknown"),
    [
        ((46.0, 9.0), (-90.0, 9.0), True),  # still approaching
        ((8.0, 9.0), (200.0, 40.0), False),  # moving away
        ((9.0, 4.0), (10.0, 3.0), False),  # at rest
    ],
)
def test_an_obstacle_with_states_is_known_at_rest_or_while_it_moves_away(
    position: tuple[float, float], goal: tuple[float, float], unknown: bool
) -> None:
    found = beyond(
        "cooperative_circle", position=place(*position), goal=place(*goal), speed=1.0, clearance=0.0, lag=0.3
    )
    assert found.closer == 0
    assert (found.unknown is not None) == unknown
    if found.unknown is not None:
        assert found.unknown.obstacle == 1
        assert found.unknown.closing == pytest.approx(1.0, abs=0.3)
        assert found.unknown.value == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize(
    ("place_at", "moved", "threshold", "rests"),
    [
        (1e6, 3e-4, 0.5, False),
        (1e6, 1e-10, 0.5, True),  # the last digit
        (0.0, 1e-10, 0.5, True),
        (0.0, 1e-10, 1e-6, False),
        (1.0, 1e-10, 0.0, True),
    ],
    ids=["far away, a metre", "far away, rounding", "rounding", "a scene of a micrometre", "no threshold"],
)
def test_rest_is_measured_by_the_threshold_wherever_it_is(
    place_at: float, moved: float, threshold: float, rests: bool
) -> None:
    scenario = SimpleNamespace(given_scenario=SimpleNamespace(horizon=15.0))
    flights: Any = SimpleNamespace(campaign=scenario, step=0.005, threshold=threshold)
    assert onward.at_rest(np.array([[place_at, 0.0, 0.0], [place_at + moved, 0.0, 0.0]]), flights) == rests


def test_a_straight_path_ends_at_its_goal() -> None:
    path = {"position": place(66.0, 7.0), "speed": 1.5}
    assert beyond("moving_circle", **path, goal=place(-90.0, 7.0)).closer == 1
    stops = beyond("moving_circle", **path, goal=place(9.0, 7.0))
    assert (stops.closer, stops.unknown) == (0, None)


def around(turns: float, count: int = 400, squeezed: float = 1.0) -> np.ndarray[Any, np.dtype[np.float64]]:
    angle = 0.3 + 2.0 * math.pi * turns * np.arange(count + 2) / count
    return np.stack([np.cos(angle), squeezed * np.sin(angle), 0.0 * angle], axis=1)


class Prescribed(onward.Onward):
    """The motion of an obstacle that is on a circle of 9 m, and moves on by something in each turn of 2 s [m]."""

    def __init__(self, *each: float, turns: float = 1.0, squeezed: float = 1.0) -> None:
        self._each, self._turns, self._squeezed, self._time = np.array(each), turns, squeezed, 73.7

    def _centres(self, step: float, first: int, count: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        turns = 0.5 * step * (first + np.arange(count))
        angle = 2.0 * math.pi * self._turns * turns
        on = np.stack([9.0 * np.cos(angle), 9.0 * self._squeezed * np.sin(angle), 0.0 * angle], axis=1)
        return on + np.outer(turns, self._each)


@pytest.mark.parametrize("squeezed", [1.0, 0.0])
@pytest.mark.parametrize("turns", [1.0, 2.0])
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("each", [0.0, 1e-9, 1e-4, -0.03, 2.0])
def test_a_path_repeats_if_no_turn_moves_it_on(turns: float, squeezed: float, axis: int, each: float) -> None:
    """By a hair's breadth, or in a direction in which it does not move otherwise."""
    onwards = Prescribed(*(each * (k == axis) for k in range(3)), turns=turns, squeezed=squeezed)
    assert onwards._returns(2.0) == (each == 0.0)


@pytest.mark.parametrize("turns", [0.0, 0.9, 0.999, 1.001, 1.5])
def test_what_is_elsewhere_after_a_turn_or_never_moves_repeats_nothing(turns: float) -> None:
    assert not Prescribed(0.0, 0.0, 0.0, turns=turns)._returns(2.0)


@pytest.mark.parametrize("seed", range(5))
def test_no_point_of_a_path_is_closer_than_the_bound_of_its_interval(seed: int) -> None:
    random = np.random.default_rng(seed)
    corners = random.uniform(-1.0, 1.0, (4, 3))
    dense = np.concatenate([np.linspace(*pair, 331) for pair in pairwise(corners)])
    turn = 40.0 * around(1.0, 6400) - 40.0 * around(1.0, 6400)[1000] + random.uniform(-0.01, 0.01, 3)
    stops = np.minimum(np.arange(1001.0), random.uniform(1.0, 30.0))[:, None] * (0.01, 0.0, 0.0) - (0.1, 0.0, 0.0)
    for path, each, loose in ((dense, 37, 0.15), (turn, 64, 0.15), (stops, 100, 0.3)):
        path = path[: (len(path) - 1) // each * each + 1]
        bound, true = samples.nearest(path[::each]), np.linalg.norm(path, axis=1)
        lowest = [true[k * each : (k + 1) * each + 1].min() for k in range(len(bound))]
        assert (bound <= np.array(lowest) + 1e-12).all()
        assert bound.min() == pytest.approx(true.min(), abs=loose)


@pytest.mark.parametrize(
    ("centres", "away"),
    [
        (np.outer(np.arange(40), (1.0, 0.2, 0.0)), True),
        (np.outer(np.arange(40) ** 2, (1.0, 0.0, 0.0)) + 1.0, False),  # accelerating
        (np.outer(np.arange(40, 0, -1), (1.0, 0.2, 0.0)), False),  # approaching
        (around(0.4)[:, [1, 0, 2]], False),  # turning
    ],
)
def test_what_neither_repeats_nor_ends_is_known_while_it_moves_away_at_a_constant_velocity(
    centres: Any, away: bool
) -> None:
    path = onward.Path(np.arange(float(len(centres))), centres.astype(float), whole=False)
    assert onward.leaves(path, np.zeros(3)) == away
