"""An obstacle that passes the vehicle and stops or turns within one step has been as close as it was.

The vehicle closes on the obstacle after that, so a distance falls, rises and falls again within the step. Expected
values are those of the vehicle's path, sampled densely, with the obstacle's motion in closed form.
"""

from __future__ import annotations

import math
from copy import copy
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.results.trace import Closest
from clearance.testing.problems import Problem
from tests.given.late_obstacles import TRAIN
from tests.given.reference_in_python import part
from tests.physics.drifting import CONTROLLER, PLANAR_AVOIDER, PLANAR_VEHICLE
from tests.physics.scenes import uncompiled
from worker.engine.kernels.bind import filled
from worker.engine.kernels.lanes import plain_ops
from worker.engine.kernels.layout import Parts
from worker.engine.reference import closed, flight
from worker.engine.reference.reference import Reference
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.assemble import Loop
from worker.engine.systems.closed_loop.trace import trace
from worker.running.catalogue.installed import components

STEP, WITHIN, SPEED = 0.005, 34, 60.0
"""The time step [s], the step in which the obstacle turns, its speed [m/s]."""

PASSES, AHEAD = 0.02, 0.12
"""How far from the vehicle it passes, and how far ahead of the vehicle it stops or turns [m]."""

RADIUS = 0.01
FAR = (-9000.0, 50.0)

CRITERIA = pytest.mark.parametrize("criterion", ["separation", "surface_separation"])
MOTIONS = pytest.mark.parametrize("motion", ["stops", "turns"])
PHASES = pytest.mark.parametrize("phase", [0.43, 0.497, 0.81, 0.98])
"""Where in the step it turns, as a fraction."""

BACK = math.radians(55.0)
"""The angle between its second leg and its way back [rad]."""


@cache
def scene(criterion: str) -> Problem:
    """A robot without avoidance, one obstacle that stops and one that turns."""
    document = load_file(library()["unicycle_static"]).document()
    scenario = document["scenario"]
    scenario["avoider"]["parameters"] |= {"k_rep": 0.0}
    scenario |= {"start": {"x": 0.0, "y": 0.0, "theta": 0.8, "v": 0.4}, "horizon": 0.2, "step": STEP}
    there = {"x": FAR[0], "y": FAR[1]}
    line = {"position": there, "goal": {"x": -8000.0, "y": 0.0}, "speed": 1.0, "radius": RADIUS}
    legs = {"position": there, "waypoint1": there, "waypoint2": there, "legs": 2.0, "speed": 1.0, "radius": RADIUS}
    scenario["obstacles"] = [
        {"component": "moving_circle", "parameters": line},
        {"component": "waypoint_circle", "parameters": legs},
    ]
    threshold = 0.01 if criterion == "separation" else -0.5
    return uncompiled(load_document(document | {"criterion": {"component": criterion, "threshold": threshold}}))


@cache
def path(criterion: str) -> Floats:
    """Where the vehicle is at each step (steps + 1, 2)."""
    flights = scene(criterion).system
    steps, every = flights.counts(STEP)
    trace = flights.loop.simulate(flights.nominal[None, :], STEP, steps, every, traced=1).trace[0]
    return np.array(
        [
            part(flights.loop, "observation")(
                0.0,
                tuple(r[: flights.loop.n_state]),
                tuple(r[flights.loop.n_state :]),
                flights.loop.extend(flights.nominal),
            )[:2]
            for r in trace
        ]
    )


class Encounter:
    """An obstacle that passes and then stops or turns: the parameters, and the lowest value of the criterion."""

    def __init__(self, criterion: str, motion: str, phase: float) -> None:
        self.flights = scene(criterion).system
        at, self.when = path(criterion), (WITHIN + phase) * STEP
        when = self.when
        ahead = at[WITHIN + 1] - at[WITHIN]
        ahead /= np.hypot(*ahead)
        here = at[WITHIN] + phase * (at[WITHIN + 1] - at[WITHIN])
        corner = here + AHEAD * ahead + PASSES * np.array([-ahead[1], ahead[0]])
        begin = corner - SPEED * when * ahead
        turn = np.array([[math.cos(BACK), -math.sin(BACK)], [math.sin(BACK), math.cos(BACK)]])
        end = corner - 500.0 * (turn @ ahead)
        if motion == "stops":
            values = {"0.position": begin, "0.goal": corner}
        else:
            values = {"1.position": begin, "1.waypoint1": corner, "1.waypoint2": end}
        self.row = self.flights.nominal.copy()
        for name, point in values.items():
            for axis, value in zip("xy", point, strict=True):
                self.row[self.flights.paths[f"obstacles.{name}.{axis}"]] = value
        self.row[self.flights.paths[f"obstacles.{0 if motion == 'stops' else 1}.speed"]] = SPEED
        times = np.linspace(0.0, (len(at) - 1) * STEP, 400_001)
        vehicle = np.array([np.interp(times, STEP * np.arange(len(at)), c) for c in at.T])
        before, after = np.minimum(times, when), np.maximum(times - when, 0.0)
        moved = np.outer(ahead, SPEED * before)
        if motion == "turns":
            moved = moved - np.outer(turn @ ahead, SPEED * after)
        away = np.hypot(*(vehicle - begin[:, None] - moved)).min()
        body = float(self.row[self.flights.paths["criterion.body_radius"]]) if "surface" in criterion else 0.0
        self.lowest = float(away) - (RADIUS + body if "surface" in criterion else 0.0)

    def by_the_loop(self, finer: int = 1) -> float:
        steps, every = self.flights.counts(STEP)
        made = self.flights.loop.simulate(self.row[None, :], STEP / finer, steps * finer, every * finer)
        assert made.status[0] == 0.0
        return float(made.costs[0, 0])

    def closest(self) -> Closest:
        """The closest approach of the trace."""
        flights = copy(self.flights)
        flights.nominal = self.row
        found = trace(flights, "nominal", {}).meta.closest
        assert found is not None
        return found

    def by_the_reference(self) -> float | None:
        reference = Reference(self.flights)
        reference.__dict__["_system"] = SimpleNamespace(address=interpreted(self.flights.loop)), flight.fly
        return reference.simulate(self.row).cost


@cache
def interpreted(loop: Loop) -> Any:
    """A closed loop as a system for the reference integrator, in plain Python."""
    first, last = loop.channels.of["criterion"]
    sizes = {"x": loop.n_state, "g": loop.n_held, "y": last - first, "p": loop.size_extended}
    ops = {letter: plain_ops(size, 1) for letter, size in sizes.items()}
    slots: dict[str, Any] = {f"load_{letter}": each.load for letter, each in ops.items()}
    slots |= {f"store_{letter}": ops[letter].store for letter in "xgy"}
    names = ("initial", "initial_guidance", "guide", "closed_loop", "envelope", "cost", "excluded")
    slots |= {name: part(loop, name) for name in names}
    slots |= {"drawn": closed.none_drawn, "store_d": lambda *_: None, "carray": lambda values, _: values}
    slots |= {"N_X": sizes["x"], "N_P": sizes["p"], "N_D": 0, "N_G": sizes["g"], "N_Y": sizes["y"]}
    return filled(closed.answer, slots | {"Y0": first, "Y1": last, "AHEAD": (0.0,) * first})


@PHASES
@MOTIONS
@CRITERIA
def test_the_reference_finds_the_pass(
    criterion: str, motion: str, phase: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flight, "READINGS", 27)  # samples as far apart as those of a simulation of 15 s
    met = Encounter(criterion, motion, phase)
    assert met.by_the_reference() == pytest.approx(met.lowest, abs=1e-4)


@PHASES
@MOTIONS
@CRITERIA
def test_the_loop_finds_the_pass(criterion: str, motion: str, phase: float) -> None:
    met = Encounter(criterion, motion, phase)
    assert [met.by_the_loop(1), met.by_the_loop(2)] == pytest.approx([met.lowest] * 2, abs=1e-4)


@MOTIONS
def test_the_closest_approach_of_a_trace_is_that_of_the_pass(motion: str) -> None:
    met = Encounter("separation", motion, 0.81)
    closest = met.closest()
    assert closest.obstacle == (0 if motion == "stops" else 1)
    assert closest.time == pytest.approx(met.when - AHEAD / SPEED, abs=1e-4)


@pytest.mark.parametrize("ended", ["declared", "from its legs"])
def test_an_obstacle_of_ones_own_divides_the_step_in_which_a_leg_ends(ended: str) -> None:
    """The vehicle is at rest 1 m from the place at which it stops, which is within the step."""
    known: Any = components()
    own = TRAIN if ended == "from its legs" else known["obstacle", "moving_circle"]
    parts = Parts(PLANAR_VEHICLE, CONTROLLER, PLANAR_AVOIDER, (own,), known["criterion", "surface_separation"])
    loop = Loop(parts, lanes=1, compiled=False)
    assert loop.channels.turns == ((0, 0),)
    values = {f"{s.prefix}.{p.name}": p.default for s in loop.sections for p in s.parameters}
    values |= {"vehicle.vx": 1.0, "criterion.threshold": -1e3, "obstacles.0.speed": 100.0, "obstacles.0.radius": 0.1}
    values |= {"obstacles.0.position.x": -100.0, "obstacles.0.position.y": 0.5}
    values |= {"obstacles.0.goal.x": 2.7, "obstacles.0.goal.y": 0.5}
    assert loop.part("turns")(loop.extend(np.array(list(values.values())))) == pytest.approx((1.027,))
    made = loop.simulate(np.array([list(values.values())]), 0.05, 22)
    body = values["criterion.body_radius"]
    assert made.costs[0, 0] == pytest.approx(0.5 - 0.1 - body, abs=1e-4)
