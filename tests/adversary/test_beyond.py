"""Random scenes of shipped vehicles, obstacles and criteria that end too early: nothing that is met later is missed.

What may be met is computed a second time, densely: obstacles move on, and the vehicle stops or goes straight
on for another horizon. A few by day, all by `make nightly`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import pytest

from campaigns.asked.load import load_document
from clearance.testing.problems import Problem
from clearance.testing.scenes import scene
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import nested
from worker.engine.kernels.component import Criterion, Obstacle, Vehicle
from worker.engine.kernels.loop import OK
from worker.engine.systems.closed_loop import beyond
from worker.engine.systems.closed_loop.trace import Seen
from worker.running.catalogue.installed import catalogue, components

Points = np.ndarray[Any, np.dtype[np.float64]]
BY_DAY, BY_NIGHT = 6, 200
DENSE = 3000
"""Times that are looked at."""
CRITERIA = ("separation", "surface_separation")
HORIZONS = 4.0
"""After the last sample: for so many, a path that takes longer is looked at."""
TURNS = 0.05, 3.0
"""The shortest and the longest turn, in horizons."""


def of(kind: type, dimension: int) -> list[Any]:
    return [c for c in components().values() if isinstance(c, kind) and getattr(c, "dimension", 0) in (0, dimension)]


class Scene(NamedTuple):
    problem: Problem
    row: Points
    place: Points
    velocity: Points
    time: float
    flies: bool


def flown(document: dict[str, Any]) -> Scene:
    """The nominal flight to twice its horizon."""
    problem = Problem(load_document(document), compiled=False)
    system: Any = problem.system
    row = problem.vectors(problem.nominal_point[None, :])[0]
    (steps, every), step = system.counts(system.step), system.step
    result = system.loop.simulate(row[None, :], step, 2 * steps, every, traced=1)
    seen = Seen(system, system.loop.observe(result.trace[0][-2:], row, step, 2 * steps - 1), row)
    velocity = (seen.positions[1] - seen.positions[0]) / step
    return Scene(problem, row, seen.positions[1], velocity, 2 * steps * step, int(result.status[0]) == OK)


def values(obstacle: Obstacle, near: Points, speed: float, random: np.random.Generator) -> dict[str, float]:
    """Parameters of an obstacle near a place; distances and speeds are as those of the vehicle."""
    entry = catalogue().component("obstacle", obstacle.name)
    assert entry is not None
    found: dict[str, float] = {}
    for p in entry.parameters:
        axis = "xyz".find(p.name.rpartition(".")[2]) if "." in p.name else -1
        if axis >= 0:
            value = float(near[axis]) + random.normal(0.0, 2.0 * speed)
        elif p.unit == "m" or p.unit == "m/s":
            value = speed * 10.0 ** random.uniform(-1.5, 0.7)
        elif p.unit == "rad":
            value = random.uniform(-3.0, 3.0)
        else:
            continue
        found[p.name] = min(max(value, p.low), p.high)
    return found


def drawn(seed: int, turns: bool = False) -> Scene:
    """The first one whose flight is neither excluded at its start nor unstable with its step."""
    random = np.random.default_rng(seed)
    return next(made for _ in range(100) if (made := among(random, turns)).flies)


def among(random: np.random.Generator, turns: bool) -> Scene:
    """A scene whose obstacles lie where the vehicle goes after twice the horizon; turns: one that repeats its path, and
    that the vehicle meets within a horizon while it goes straight on, or within a turn after it has stopped."""
    dimension = int(random.integers(2, 4))
    vehicle = random.choice(of(Vehicle, dimension))
    criterion = random.choice([c for c in of(Criterion, dimension) if c.name in CRITERIA])
    passive = [o for o in of(Obstacle, dimension) if not o.states and o.dimension == dimension]
    passive = [o for o in passive if repeats(o)] if turns else passive
    obstacles = [passive[k] for k in random.integers(0, len(passive), 1 if turns else random.integers(1, 4))]
    document: Any = scene(vehicle, criterion, obstacles[0]).document
    step = 0.005 if dimension == 2 else 0.05
    document["scenario"] |= {"horizon": round(int(random.integers(20, 60)) * step, 6), "step": step}
    if criterion.name == "separation":
        document["criterion"]["from_centre"] = True
    away = np.array([1e5, 1e5, -1e5])
    far = flown(placed(document, [(o, values(o, away, 1.0, random)) for o in obstacles]))
    speed, horizon = float(np.linalg.norm(far.velocity)) + 1e-3, document["scenario"]["horizon"]
    put = [far.place + far.velocity * horizon * random.uniform(-0.2, 1.5) for _ in obstacles]
    given = [(o, values(o, at, speed, random)) for o, at in zip(obstacles, put, strict=True)]
    if turns:
        given = [(o, turning(found, far, horizon, random)) for o, found in given]
    return flown(placed(document, given))


def repeats(obstacle: Obstacle) -> bool:
    """Whether it goes in a circle."""
    entry = catalogue().component("obstacle", obstacle.name)
    return entry is not None and entry.rate is not None and entry.rate.of == ["speed"] and entry.rate.per == ["way"]


def turning(found: dict[str, float], far: Scene, horizon: float, random: np.random.Generator) -> dict[str, float]:
    """A circle of a wanted turn that passes the vehicle at some time."""
    turn = horizon * float(np.exp(random.uniform(*np.log(TURNS))))
    after = random.uniform(0.0, horizon + turn)
    met = far.place + min(after, horizon) * far.velocity
    way = min(found["way"], 30.0 * turn)  # below the highest speed
    angle = found["phase"] + 2.0 * math.pi * (far.time + after) / turn
    centre = {"centre.x": met[0] - way * math.cos(angle), "centre.y": met[1] - way * math.sin(angle)}
    height = {"centre.z": met[2]} if "centre.z" in found else {}
    placed = {name: float(x) for name, x in (centre | height).items()}
    return found | placed | {"way": way, "speed": 2.0 * math.pi * way / turn}


def placed(document: dict[str, Any], obstacles: list[tuple[Obstacle, dict[str, float]]]) -> dict[str, Any]:
    listed = [{"component": o.name, "parameters": nested(flat)} for o, flat in obstacles]
    return {**document, "scenario": {**document["scenario"], "obstacles": listed}}


def least(scene: Scene) -> tuple[float, float, float]:
    """The lowest value after the last sample, that at the last sample, and what dense times may miss of it."""
    system: Any = scene.problem.system
    bodies, p = system.loop.part("bodies"), system.loop.extend(scene.row)
    axes, horizon = system.parts.vehicle.dimension, system.campaign.given_scenario.horizon
    surface = system.parts.criterion.measured_to == "surface"
    less = scene.row[system.paths["criterion.body_radius"]] if "criterion.body_radius" in system.paths else 0.0

    def value(after: float, velocity: Points) -> Any:
        q = (scene.place + min(after, horizon) * velocity)[:axes]
        shown = bodies(scene.time + after, (), tuple(map(float, q)), p)
        if surface:
            return min(b.gap for b in shown) - less
        return min(math.dist(q, (b.x, b.y, b.z) if axes == 3 else (b.x, b.y)) for b in shown)

    times = np.linspace(0.0, HORIZONS * horizon, DENSE)
    curves = [np.array([value(t, v) for t in times]) for v in (scene.velocity, 0.0 * scene.velocity)]
    change = max(float(np.abs(np.diff(curve)).max()) for curve in curves)
    return min(float(curve.min()) for curve in curves), float(curves[0][0]), change


@pytest.mark.by_day(2)
@pytest.mark.parametrize("seed", nightly_but(range(BY_DAY), range(BY_NIGHT)))
def test_nothing_that_is_met_after_the_horizon_is_missed(seed: int) -> None:
    nothing_missed(drawn(seed), seed)


@pytest.mark.parametrize("seed", nightly_but((1, 6, 21), range(BY_NIGHT)))
def test_what_repeats_its_path_is_met_however_long_a_turn_takes(seed: int) -> None:
    nothing_missed(drawn(seed, turns=True), seed)


def nothing_missed(made: Scene, seed: int) -> None:
    lowest, here, change = least(made)
    system: Any = made.problem.system
    below = max(lowest + change, 0.0) * float(np.random.default_rng(seed).uniform(1.0, 3.0)) + 1e-3
    found = beyond.met(system, ["nominal"], made.row[None, :], [None], below, lambda: False)
    assert found is not None
    stated = [later for later in (found.lowest, found.unknown) if later is not None]
    assert stated
    closest = min(stated, key=lambda later: later.value)
    if found.unknown is None:  # which bars "cleared" whatever else comes closer
        assert found.closer == 1
        assert closest.value <= min(lowest, here) + 1e-9 * (1.0 + abs(lowest))
    horizon = system.campaign.given_scenario.horizon
    # Of a vehicle that has reached the threshold, what is lower straight on is stated, later than it stops here.
    on = closest.vehicle or (closest.value <= made.problem.threshold and closest.time > 2.0 * horizon)
    if not closest.simulated and not on and closest.time <= (1.0 + HORIZONS) * horizon:
        assert closest.value >= lowest - change
