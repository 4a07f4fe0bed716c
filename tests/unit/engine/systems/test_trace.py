"""A trace shows exactly the simulation whose cost was stored."""

from __future__ import annotations

import numpy as np
import pytest

from campaigns.stored.records import Trace
from tests.given.case_campaigns import case1
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.trace import trace

WORST = {"vehicle.m": 6.0, "vehicle.J": 0.06}


def column(shown: Trace, name: str) -> Floats:
    return np.asarray(shown.data[:, [c.name for c in shown.columns].index(name)])


def test_a_trace_has_the_columns_of_its_parts() -> None:
    shown = trace(case1().system, "nominal", {})
    assert [(c.name, c.unit, c.group) for c in shown.columns] == [
        ("t", "s", "time"),
        ("x", "m", "pose"), ("y", "m", "pose"), ("z", "m", "pose"),
        ("roll", "rad", "pose"), ("pitch", "rad", "pose"), ("yaw", "rad", "pose"),
        ("v", "m/s", "state"), ("omega", "rad/s", "state"),
        ("force", "N", "command"), ("torque", "N m", "command"),
        ("v_demand", "m/s", "command"), ("omega_demand", "rad/s", "command"),
        ("separation", "m", "separation"),
    ]  # fmt: skip
    assert shown.data.shape == (3001, 14)
    assert column(shown, "t")[[0, 1, -1]] == pytest.approx([0, 0.005, 15])
    assert np.isfinite(shown.data).all()


def test_a_trace_describes_its_scene() -> None:
    meta = trace(case1().system, "F1", WORST).meta
    (obstacle,) = meta.obstacles
    assert {
        "component": "circle",
        "title": "Circle",
        "position": [4.0, 4.0, 0.0],
        "radius": 0.5,
    }.items() <= obstacle.model_dump().items()
    assert (meta.start, meta.goal) == ([0.0, 0.0, 0.0], [6.0, 7.0, 0.0])
    assert (meta.frame, meta.vehicle, meta.threshold) == ("enu", "unicycle", 0.5)
    assert (meta.status, meta.reason, meta.parameters) == ("ok", "", WORST)


@pytest.mark.parametrize("values", [{}, WORST, {"vehicle.m": 4.0, "start.y": -1.0}])
def test_it_is_the_flight_that_was_counted(values: dict[str, float]) -> None:
    problem = case1()
    shown = trace(problem.system, "flight", values)
    cost = problem.system.simulate_vectors(problem.vector(values)[None, :])[0].costs[0, 0]
    assert shown.meta.cost == cost
    closest, separation = shown.meta.closest, column(shown, "separation")
    assert closest is not None
    assert closest.speed is not None
    assert closest.value == pytest.approx(cost, abs=1e-14)
    row = int(separation.argmin())
    assert closest.row == row
    assert 0 <= separation[row] - closest.value < 1e-4
    assert abs(closest.time - row * 0.005) <= 0.0025
    near = np.hypot(*(np.gradient(column(shown, n), 0.005)[row - 1 : row + 2] for n in "xy"))
    assert near.min() - 1e-6 <= closest.speed <= near.max() + 1e-6
    assert shown.meta.values == {"separation": cost}
    place = np.array(closest.position)
    assert np.hypot(*(place - closest.obstacle_position)[:2]) == pytest.approx(cost, abs=1e-6)


def test_the_separation_is_the_distance_to_the_centre() -> None:
    shown = trace(case1().system, "nominal", {})
    distance = np.hypot(column(shown, "x") - 4, column(shown, "y") - 4)
    assert column(shown, "separation") == pytest.approx(distance, abs=1e-12)


def test_the_commands_move_the_vehicle() -> None:
    shown = trace(case1().system, "nominal", {})
    acceleration = np.gradient(column(shown, "v"), 0.005)
    assert column(shown, "force")[5:-5] / 5.0 == pytest.approx(acceleration[5:-5], abs=2e-3)


@pytest.mark.parametrize("rows", [2, 30, 400, 3000, 3001, 10**6])
def test_thinned_it_keeps_the_ends_and_the_closest_approach(rows: int) -> None:
    whole, shown = trace(case1().system, "nominal", {}), trace(case1().system, "nominal", {}, rows)
    assert len(shown.data) <= max(rows, 23)
    assert np.isin(shown.data[:, 0], whole.data[:, 0]).all()
    assert (np.diff(shown.data[:, 0]) > 0).all()
    assert shown.data[[0, -1]].tolist() == whole.data[[0, -1]].tolist()
    assert column(shown, "separation").min() == column(whole, "separation").min()
    assert shown.meta == whole.meta


def test_a_failed_flight_is_shown_up_to_its_failure() -> None:
    shown = trace(case1().system, "F1", {"vehicle.J": 0.001})
    assert (shown.meta.status, shown.meta.cost) == ("failed", None)
    assert shown.meta.reason == "the vehicle left the model's envelope at t = 0.005 s: the turn rate exceeds 1000 rad/s"
    assert column(shown, "t").tolist() == [0.0, 0.005]
    assert abs(column(shown, "omega")[-1]) > 1000
    assert np.isfinite(shown.data).all()
    assert shown.meta.closest is not None
    assert shown.meta.closest.value == pytest.approx(32**0.5, abs=1e-3)


def test_an_excluded_simulation_is_reported_as_excluded() -> None:
    shown = trace(case1().system, "F1", {"start.x": 4.1, "start.y": 4.0})
    assert (shown.meta.status, shown.meta.cost) == ("excluded", None)
    assert shown.meta.closest is not None
    assert shown.meta.closest.value == pytest.approx(0.1)


def test_an_unknown_parameter_is_refused() -> None:
    with pytest.raises(KeyError, match=r"vehicle\.n"):
        trace(case1().system, "F1", {"vehicle.n": 1.0})
