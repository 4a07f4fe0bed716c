"""What flights meet between the horizon and the failure of their simulation: it counts like all that is simulated."""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.results.validate import Beyond
from clearance.testing.problems import Problem
from tests.given.at_night import nightly_but, rows_nightly_but
from worker.engine.systems import optional
from worker.engine.systems.closed_loop import beyond
from worker.engine.systems.closed_loop.trace import Seen

HORIZON, STEP, FAILS = 36.0, 0.05, 71.45
"""The aircraft of case 3 circles about its goal and slips out of its envelope then."""
KNOWN = {"separation": 25.0, "surface_separation": 9.0}
"""A value by criterion that no flight here reaches within the horizon."""
AWAY = (5000.0, 5000.0, -50.0)


def problem(place: tuple[float, ...], criterion: str = "separation") -> Problem:
    """Case 3 with a small obstacle at a place that the avoider does not see after the horizon."""
    document = load_file(library()["uav_static"]).document()
    scenario = document["scenario"]
    position = dict(zip("xyz", map(float, place), strict=True))
    scenario["obstacles"].append({"component": "sphere", "parameters": {"position": position, "radius": 1.0}})
    scenario["faults"] = [{"component": "blackout", "parameters": {"at": HORIZON, "duration": 1000.0}}]
    scenario["horizon"] = HORIZON
    document["criterion"] = {"component": criterion, "threshold": 5.0}
    if criterion == "separation":
        document["criterion"] |= {"threshold": 25.0, "from_centre": True}
    return Problem(load_document(document), compiled=False)


def found(made: Problem, points: Any = None, known: float = KNOWN["separation"]) -> Beyond:
    points = made.nominal_point[None, :] if points is None else np.array(points)
    called = ["nominal", *(f"F{k}" for k in range(1, len(points)))]
    vectors = made.vectors(points)
    shown = optional.beyond(made.system, called, vectors, [None] * len(points), known, lambda: False)
    assert shown is not None
    assert shown.flights == len(points)
    return shown


@cache
def path(criterion: str = "separation") -> Any:
    """The positions of the nominal flight at every step before it fails."""
    made = problem(AWAY, criterion)
    system: Any = made.system
    vector = made.vectors(made.nominal_point[None, :])
    steps, every = system.counts(STEP)
    flown = system.loop.simulate(vector, STEP, 2 * steps, every, traced=1)
    assert flown.when[0] == pytest.approx(FAILS)
    states = flown.trace[0][: round(FAILS / STEP)]
    return Seen(system, system.loop.observe(states, vector[0], STEP), vector[0]).positions


def passed(time: float, aside: float) -> tuple[float, ...]:
    """A place above the point of the nominal flight at a time."""
    x, y, z = path()[round(time / STEP)]
    return x, y, z - aside


@pytest.mark.nightly
@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("time", "criterion"),
    rows_nightly_but(
        [(45.0, "surface_separation"), (FAILS - STEP, "separation")],
        product((45.0, 50.0, 60.0, FAILS - STEP), KNOWN),
    ),
)
def test_what_a_flight_meets_before_it_fails_counts(time: float, criterion: str) -> None:
    shown = found(problem(passed(time, 3.0), criterion), known=KNOWN[criterion])
    assert (shown.closer, shown.cut_short) == (1, 1)
    assert shown.lowest is not None
    assert shown.lowest.simulated
    assert shown.lowest.obstacle == 1
    assert shown.lowest.value <= (3.0 if criterion == "separation" else 2.0) + 0.01
    assert shown.lowest.value > -1.0
    assert shown.lowest.until == pytest.approx(FAILS - STEP)
    assert HORIZON + shown.lowest.time <= FAILS - STEP + 1e-9
    x, y, z = path()[round((HORIZON + shown.lowest.time) / STEP)]
    assert np.linalg.norm(np.array([x, y, z]) - passed(time, 3.0)) == pytest.approx(3.0, abs=0.5)


@pytest.mark.nightly
def test_a_flight_that_meets_nothing_before_it_fails_comes_no_closer() -> None:
    shown = found(problem(AWAY))
    assert (shown.closer, shown.cut_short) == (0, 1)


def test_a_flight_is_extrapolated_from_its_last_step_before_it_fails() -> None:
    ahead = path()[-1] + 20.0 / STEP * (path()[-1] - path()[-2])  # in 20 s, not on the way
    near = np.linalg.norm(path() - ahead, axis=1).min()
    shown = found(problem(tuple(ahead)))
    assert near > KNOWN["separation"]
    assert (shown.closer, shown.cut_short) == (1, 1)
    assert shown.lowest is not None
    assert not shown.lowest.simulated
    assert shown.lowest.time == pytest.approx(FAILS - STEP + 20.0 - HORIZON, abs=0.1)
    assert shown.lowest.value == pytest.approx(0.0, abs=0.5)


def corners(made: Problem) -> Any:
    """Points whose flights fail at different steps."""
    random = np.random.default_rng(3)
    return np.concatenate([made.nominal_point[None, :], random.random((3, len(made.nominal_point)))])


@pytest.mark.nightly
@pytest.mark.parametrize("memory", nightly_but((1,), [1, 2**23]))
def test_flights_that_fail_at_different_steps_meet_what_each_meets_alone(
    memory: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem(passed(60.0, 3.0))
    points = corners(made)
    alone = [found(made, [point]) for point in points]
    monkeypatch.setattr(beyond, "MEMORY", memory)
    together = found(made, points)
    assert len({each.lowest.until for each in alone if each.lowest is not None}) > 2
    assert together.cut_short == sum(each.cut_short or 0 for each in alone) > 2
    assert together.closer == sum(each.closer for each in alone) > 1
    lowest = min((each.lowest for each in alone if each.lowest is not None), key=lambda later: later.value)
    assert together.lowest == lowest.model_copy(update={"name": together.lowest.name if together.lowest else ""})


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("aside", "criterion"),
    rows_nightly_but(
        [(5.0, "separation"), (60.0, "separation")],
        product((5.0, 7.9, 8.1, 9.9, 10.1, 24.9, 25.1, 27.0, 60.0), KNOWN),
    ),
)
def test_what_is_not_simulated_again_stays_away(aside: float, criterion: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The samples exclude nothing that the loop finds, and spare it flights that stay away."""
    made, away, outcomes = problem(passed(55.0, aside), criterion), beyond._away, list[bool]()

    def noted(*given: Any) -> bool:
        outcomes.append(away(*given))
        return outcomes[-1]

    monkeypatch.setattr(beyond, "_away", noted)
    shown = found(made, known=KNOWN[criterion])
    monkeypatch.setattr(beyond, "_away", lambda *given: False)
    assert shown == found(made, known=KNOWN[criterion])
    assert not (outcomes[0] and shown.closer)
    assert outcomes == [aside > 30.0] or 5.0 < aside < 60.0
