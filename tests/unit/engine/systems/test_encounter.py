"""The nominal case without avoidance is kept for the next run, and never for another scenario's."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from campaigns import Campaign, library, load_file
from campaigns.asked.load import load_document
from campaigns.results.finding import ClosestApproach
from tests.given.beyond_horizon import met, place, travelling, under_way
from worker.engine.systems.base import Shown
from worker.engine.systems.closed_loop import encounter
from worker.engine.systems.closed_loop.trace import trace
from worker.running.opening import opened


def changed(**changes: Any) -> Campaign:
    """Case 1 with a short horizon, and with other entries of its scenario or, by their names, of the campaign."""
    document = load_file(library()["unicycle_static"]).document()
    document["scenario"] |= {"horizon": 2.0, "step": 0.01}
    for name, value in changes.items():
        place = document if name in document else document["scenario"]
        place[name] = value
    return load_document(document, "test")


OTHERS = {
    "another vehicle": changed(vehicle={"component": "unicycle", "parameters": {"m": 5.1, "J": 0.05}}),
    "another start": changed(start={"x": 0.0, "y": 0.0, "theta": 0.3, "v": 0.0, "omega": 0.0}),
    "another obstacle": changed(
        obstacles=[{"component": "circle", "parameters": {"position": {"x": 1.0, "y": 0.5}, "radius": 0.2}}]
    ),
    "another step": changed(step=0.005),
    "another horizon": changed(horizon=3.0),
    "another threshold": changed(criterion={"component": "separation", "threshold": 9.0}),
    "noise": changed(faults=[{"component": "sensor_noise"}], realisations={"seeds": [3]}),
    "other noise": changed(faults=[{"component": "sensor_noise"}], realisations={"seeds": [4]}),
}


@pytest.fixture(autouse=True)
def forgotten(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Nothing is known of other tests, and a part that changes nothing is found so by few flights."""
    monkeypatch.setattr(encounter, "COMPARED", (2, 1))
    encounter._flown.cache_clear()
    yield
    encounter._flown.cache_clear()


def seen(campaign: Campaign) -> Shown:
    flights = opened.flights(campaign, compiled=False, lanes=1)
    return encounter.shown(flights, trace(flights, "nominal", {}))


def test_the_next_run_of_a_scenario_has_it_without_simulating_it() -> None:
    first = seen(changed())
    assert seen(changed(name="Another name", seed=7)) == first
    assert (encounter._flown.cache_info().hits, encounter._flown.cache_info().misses) == (1, 1)
    assert first.unseen is not None
    assert first.unseen.deviation is not None


@pytest.mark.nightly
def test_a_nominal_case_that_fails_has_no_closest_approach() -> None:
    """The aircraft of case 3 passes its obstacle, and slips out of its envelope later."""
    document = load_file(library()["uav_static"]).document()
    document["scenario"]["horizon"] = 75.0
    failed, complete = seen(load_document(document)), load_file(library()["uav_static"])
    assert failed.closest == ClosestApproach()
    assert failed.moved is not None
    assert failed.moved > 500.0
    assert seen(complete).closest.at == "inside"


@pytest.mark.by_day(3)
@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
def test_what_changes_it_is_simulated(other: Campaign) -> None:
    alone = seen(other)
    encounter._flown.cache_clear()
    seen(changed())
    assert seen(other) == alone
    assert encounter._flown.cache_info().misses == 2


GUST = {"component": "discrete_gust", "parameters": {"at": 9.0}}


def stuck(at: float, over: float = 0.0, **uncertain: Any) -> Campaign:
    fault = {"component": "hard_over", "on": "torque", "parameters": {"at": at, "over": over}}
    kept = load_file(library()["unicycle_static"]).document()["uncertain"]
    return changed(faults=[{"component": "sensor_noise"}, fault], uncertain=kept | uncertain)


@pytest.mark.parametrize(
    ("campaign", "begins"),
    [
        (stuck(1.0), {}),
        (stuck(1.9, over=5.0), {}),
        (stuck(2.0), {"faults.1": (2.0, 2.0)}),
        (stuck(34.0), {"faults.1": (34.0, 34.0)}),
        (stuck(1.0, **{"faults.1.at": {"low": 0.5, "high": 2.0}}), {}),
        (stuck(1.0, **{"faults.1.at": {"low": 0.5, "high": 5.0}}), {"faults.1": (0.5, 5.0)}),
        (stuck(4.0, **{"faults.1.at": {"low": 3.0, "high": 5.0}}), {"faults.1": (3.0, 5.0)}),
        (changed(environment=[GUST]), {"environment.0": (9.0, 9.0)}),
    ],
)  # fmt: skip
def test_what_begins_only_after_the_horizon_is_named(campaign: Campaign, begins: dict[str, Any]) -> None:
    assert encounter.late(opened.flights(campaign, compiled=False, lanes=1)) == begins


def rising(rise: float) -> Campaign:
    return changed(environment=[{"component": "discrete_gust", "parameters": {"x": 1.0, "at": 0.5, "rise": rise}}])


@pytest.mark.parametrize(
    ("campaign", "whole"),
    [
        (stuck(1.0), {}),
        (stuck(0.5, over=1.5), {}),
        (stuck(1.9, over=0.1), {}),
        (stuck(1.9, over=5.0), {"faults.1": (6.9, 6.9)}),
        (stuck(1.0, over=0.5, **{"faults.1.over": {"low": 0.5, "high": 1e5}}), {"faults.1": (1.5, 100_001.0)}),
        (stuck(1.0, over=9.0, **{"faults.1.over": {"low": 2.0, "high": 9.0}}), {"faults.1": (3.0, 10.0)}),
        (rising(1.5), {}),
        (rising(1e6), {"environment.0": (1e6 + 0.5, 1e6 + 0.5)}),
    ],
)  # fmt: skip
def test_what_still_builds_up_after_the_horizon_is_named(campaign: Campaign, whole: dict[str, Any]) -> None:
    """Of a gust of 30 m/s that rises in days, "cleared ... with Discrete gust" was stated of flights of 15 s."""
    flights = opened.flights(campaign, compiled=False, lanes=1)
    assert encounter.late(flights, whole=True) == whole
    assert encounter.late(flights) == {}


def test_what_ends_only_after_the_horizon_is_simulated_to_its_end() -> None:
    """A blackout from within the horizon hides an obstacle that the vehicle meets after it, unless it is over then."""
    here, velocity = under_way()
    ahead = {"component": "circle", "parameters": {"position": place(*(here - 2.0 * velocity)), "radius": 0.3}}

    def lowest(lasts: float) -> float:
        dark = {"component": "blackout", "parameters": {"at": 1.0, "duration": lasts}}
        found = met(travelling(ahead, scenario__faults=[dark])).lowest
        return found.value if found is not None and found.simulated else math.inf

    assert lowest(5.0) > lowest(8.5) + 0.1
    assert lowest(8.5) < -0.2


def met_by(fault: dict[str, Any], environment: Sequence[dict[str, Any]] = (), **uncertain: Any) -> Campaign:
    kept = load_file(library()["unicycle_static"]).document()["uncertain"]
    return changed(faults=[fault], environment=[*environment], uncertain=kept | uncertain)


LOSS = {"component": "actuator_loss", "on": "torque"}
WIND = {"component": "steady_wind", "parameters": {"x": 57.0}}
GUSTS = {"component": "dryden_gusts", "parameters": {"W": 20.0}}


@pytest.mark.parametrize(
    ("campaign", "idle"),
    [
        (met_by(LOSS | {"parameters": {"loss": 0.3}}), []),
        (met_by(LOSS | {"parameters": {"loss": 0.3}}, [WIND, GUSTS]), ["environment.0", "environment.1"]),
        (met_by(LOSS), ["faults.0"]),
        (met_by(LOSS, **{"faults.0.loss": {"low": 0.0, "high": 0.1}}), []),
        (met_by({"component": "blackout", "parameters": {"at": 0.5, "duration": 0.0}}), ["faults.0"]),
    ],
    ids=["a loss", "wind on a ground robot", "no loss", "up to a bound", "of no duration"],
)
def test_what_changes_no_flight_is_named(campaign: Campaign, idle: list[str]) -> None:
    """Of a robot in a wind of 57 m/s that moves no robot, "cleared ... with Steady wind" was stated."""
    found = encounter.idle(opened.flights(campaign, compiled=False, lanes=1))
    assert found == dict.fromkeys(idle, 4)
