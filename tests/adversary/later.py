"""Attacks by obstacles that come after the horizon or move faster than the step follows, with the truth by brute force.

The truth of the former is the same campaign with a horizon that holds the encounter; of the latter, with a step that
follows the obstacle.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from campaigns import library, load_file
from campaigns.asked.load import load_document
from tests.adversary.classes import ANY, NOT_CLEARED, Attack, brute_force, campaign, circle

GOAL = (6.0, 7.0)
"""Of case 1; the unicycle is near it from 9 s on."""
LONGER = 5.0
"""Horizons that hold every encounter."""


def _point(x: float, y: float) -> dict[str, float]:
    return {"x": x, "y": y}


def straight_after_the_horizon(random: np.random.Generator) -> Attack:
    """A second obstacle comes past the goal on a straight line up to three horizons late, from anywhere."""
    horizon = round(float(random.uniform(6.5, 11.0)), 1)
    arrives, speed = horizon * float(random.uniform(1.1, 4.0)), float(random.uniform(0.3, 4.0))
    angle, miss = float(random.uniform(0, 2 * math.pi)), float(random.uniform(-2.0, 2.0))
    along, x, y = (math.cos(angle), math.sin(angle)), GOAL[0] - miss * math.sin(angle), GOAL[1] + miss * math.cos(angle)
    back, on = speed * arrives, 20.0 * speed
    moving = {
        "component": "moving_circle",
        "parameters": {
            "position": _point(x - back * along[0], y - back * along[1]),
            "goal": _point(x + on * along[0], y + on * along[1]),
            "speed": speed, "radius": 0.1,
        },
    }  # fmt: skip
    return _after("straight after the horizon", random, moving, horizon)


def turning_after_the_horizon(random: np.random.Generator) -> Attack:
    """A second obstacle turns towards the goal and arrives up to three horizons late: along waypoints, on a circle, or
    accelerating towards it."""
    horizon = round(float(random.uniform(6.5, 11.0)), 1)
    arrives, angle = horizon * float(random.uniform(1.1, 4.0)), float(random.uniform(0, 2 * math.pi))
    kind, miss = random.integers(3), float(random.uniform(-2.0, 2.0))
    x, y = GOAL[0] - miss * math.sin(angle), GOAL[1] + miss * math.cos(angle)
    if kind == 0:
        moving = _along_waypoints(random, arrives, angle, (x, y))
    elif kind == 1:
        moving = _on_a_circle(random, arrives, angle, miss)
    else:
        far = float(random.uniform(1.0, 3.0)) * arrives
        moving = {
            "component": "cooperative_circle",
            "parameters": {
                "position": _point(x + far * math.cos(angle), y + far * math.sin(angle)),
                "goal": _point(x - far * math.cos(angle), y - far * math.sin(angle)),
                "speed": far / arrives, "radius": 0.1, "clearance": 0.0, "lag": float(random.uniform(0.1, 1.0)),
            },
        }  # fmt: skip
    return _after("turning after the horizon", random, moving, horizon)


def _along_waypoints(
    random: np.random.Generator, arrives: float, angle: float, past: tuple[float, float]
) -> dict[str, Any]:
    """Away from the goal first, then past it."""
    turns = arrives * float(random.uniform(0.2, 0.8))
    speed = float(random.uniform(1.0, 4.0))
    corner = [g + speed * (arrives - turns) * c for g, c in zip(past, (math.cos(angle), math.sin(angle)), strict=True)]
    before, other = speed * turns, angle + float(random.uniform(-2.5, 2.5))
    return {
        "component": "waypoint_circle",
        "parameters": {
            "position": _point(corner[0] - before * math.cos(other), corner[1] - before * math.sin(other)),
            "waypoint1": _point(*corner),
            "waypoint2": _point(2 * past[0] - corner[0], 2 * past[1] - corner[1]),
            "legs": 2.0, "speed": speed, "radius": 0.1,
        },
    }  # fmt: skip


def _on_a_circle(random: np.random.Generator, arrives: float, angle: float, miss: float) -> dict[str, Any]:
    """A circle past the goal, of which half a turn or more is left at the start."""
    way, sense = float(random.uniform(8.0, 30.0)), float(random.choice([-1.0, 1.0]))
    past = way + miss
    turns = float(random.uniform(0.5, 0.9)) * 2 * math.pi
    phase = math.remainder(angle - sense * turns, 2 * math.pi)
    return {
        "component": "orbiting_circle",
        "parameters": {
            "centre": _point(GOAL[0] - past * math.cos(angle), GOAL[1] - past * math.sin(angle)),
            "way": way, "phase": phase, "speed": sense * turns * way / arrives, "radius": 0.1,
        },
    }  # fmt: skip


def _after(name: str, random: np.random.Generator, moving: dict[str, Any], horizon: float) -> Attack:
    made = campaign(
        name, random, ANY, scenario__obstacles=[circle(4.0, 4.0, 0.5), moving], scenario__horizon=horizon,
        criterion__threshold=float(random.uniform(0.5, 0.93)),
    )  # fmt: skip
    scenario = made.document["scenario"] | {"horizon": round(LONGER * horizon, 1)}
    lowest = brute_force(load_document(made.document | {"scenario": scenario}), 7)
    clear = lowest > made.document["criterion"]["threshold"]
    return Attack(name, made.document, ANY if clear else NOT_CLEARED)


def aliased_on_the_path(random: np.random.Generator) -> Attack:
    """A robot crosses an orbit of half a step, which every integration and the avoider see behind the start."""
    base = load_file(library()["pioneer_moving"]).document()
    speed, step = float(random.uniform(850.0, 1000.0)), 0.02
    way = speed * 0.5 * step / (2 * math.pi)
    along, heading = float(random.uniform(0.3, way - 0.9)), base["scenario"]["start"]["psi"]
    orbiting = {
        "component": "orbiting_circle",
        "parameters": {
            "centre": _point(along * math.cos(heading), along * math.sin(heading)), "way": way,
            "phase": heading - math.pi + float(random.uniform(-0.3, 0.3)), "speed": speed, "radius": 0.05,
        },
    }  # fmt: skip
    scenario = base["scenario"] | {
        "obstacles": [circle(14.285498650663659, 4.601578892281082, 0.2), orbiting], "step": step,
        "guidance": {"period": step}, "faults": [], "horizon": 30.0,
    }  # fmt: skip
    stages = {
        "search": [{"method": "direct", "evaluations": 100}, {"method": "cma_es", "evaluations": 100}],
        "certify": {"samples": 60}, "validate": {"neighbours": 10, "evaluations": 20_000},
    }  # fmt: skip
    uncertain = {"vehicle.m": {"low": 15.0, "high": 20.0}, "vehicle.B_e": {"low": 0.7, "high": 0.9}}
    criterion = {"component": "separation", "threshold": float(random.uniform(0.3, 0.5))}
    made = base | {"name": "aliased on the path", "published": [], "scenario": scenario, "uncertain": uncertain}
    made |= {"stages": stages, "criterion": criterion, "seed": int(random.integers(1, 2**31))}
    return _fast("aliased on the path", made, step / 2)


def there_and_back(random: np.random.Generator) -> Attack:
    """An obstacle that dashes through the start and is where it was before the next step, or on the other side."""
    step, speed = float(random.choice([0.004, 0.005])), float(random.uniform(850.0, 1000.0))
    length = speed * step / float(random.uniform(4.0, 5.0))
    angle = float(random.uniform(0, 2 * math.pi))
    along = (math.cos(angle), math.sin(angle))
    if random.random() < 0.5:
        path: dict[str, Any] = {"position": _point(*(length * c for c in along)), "waypoint1": _point(0.0, 0.0)}
        path |= {"waypoint2": path["position"], "legs": 2.0}
        dashing = {"component": "waypoint_circle", "parameters": path | {"speed": speed, "radius": 0.05}}
    else:
        path = {"position": _point(*(length * c for c in along)), "goal": _point(*(-length * c for c in along))}
        dashing = {"component": "moving_circle", "parameters": path | {"speed": speed, "radius": 0.05}}
    made = campaign(
        "there and back", random, ANY, scenario__obstacles=[circle(4.0, 4.0, 0.5), dashing], scenario__step=step,
        scenario__guidance={"period": step}, criterion__threshold=float(random.uniform(0.3, 0.6)),
    )  # fmt: skip
    return _fast("there and back", made.document, length / speed)


def _fast(name: str, made: dict[str, Any], period: float) -> Attack:
    """The truth by a step that divides the period of the motion by twenty."""
    lowest = brute_force(load_document(made), 5, finer=math.ceil(20 * made["scenario"]["step"] / period))
    return Attack(name, made, ANY if lowest > made["criterion"]["threshold"] else NOT_CLEARED)


def builds_up_after_the_horizon(random: np.random.Generator) -> Attack:
    """A fault of the torque that would be whole only after the robot is at its goal; of what flights meet of it, little
    or nothing shows."""
    at, over = float(random.uniform(0.0, 6.0)), float(10.0 ** random.uniform(1.5, 5.9))
    component, value = [("hard_over", {"value": 5.0}), ("actuator_loss", {"loss": 1.0}), ("actuator_stuck", {})][
        int(random.integers(0, 3))
    ]
    fault = {"component": component, "on": "torque", "parameters": value | {"at": at, "over": over}}
    return campaign(
        "builds up after the horizon", random, NOT_CLEARED, scenario__faults=[fault], scenario__horizon=13.0
    )


CLASSES = (
    straight_after_the_horizon,
    turning_after_the_horizon,
    aliased_on_the_path,
    there_and_back,
    builds_up_after_the_horizon,
)
