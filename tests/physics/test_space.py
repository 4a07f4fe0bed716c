"""Avoiders and obstacles in space, with a point mass: lockstep against plain Python, and the achieved clearance."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from tests.given.at_night import nightly_but
from tests.physics.in_space import OBSTACLES
from worker.engine.kernels.component import Controller, Parameter, Signal, Vehicle, declared
from worker.engine.kernels.layout import Parts
from worker.engine.kernels.maths import kernel
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.catalogue.installed import components


class Nothing(NamedTuple):
    gain: Annotated[float, Parameter("1/s", "How fast a velocity is taken up", 0.0, 10.0)] = 1.0


class Start(NamedTuple):
    x: Annotated[float, Parameter("m", "x")] = 0.0
    y: Annotated[float, Parameter("m", "y")] = 0.0
    z: Annotated[float, Parameter("m", "z")] = 0.0


@kernel
def begin(start: Any, p: Any) -> Any:
    return start.x, start.y, start.z, 15.0, 0.0, 0.0


@kernel
def derivative(t: float, x: Any, u: Any, env: Any, p: Any) -> Any:
    return x[3], x[4], x[5], u[0], u[1], u[2]


@kernel
def position(x: Any, p: Any) -> Any:
    return x[0], x[1], x[2]


@kernel
def velocity(x: Any, p: Any) -> Any:
    return x[3], x[4], x[5]


@kernel
def pose(x: Any, p: Any) -> Any:
    return x[0], x[1], x[2], 0.0, 0.0, 0.0


@kernel
def outside(x: Any, p: Any) -> float:
    return 0.0


@kernel
def measured(x: Any, e: Any, p: Any) -> Any:
    return x


@kernel
def prepare(x: Any, demand: Any, p: Any) -> Any:
    return ()


@kernel
def command_velocity(t: float, x: Any, c: Any, demand: Any, p: Any) -> Any:
    u = p.gain * (demand[0] - x[3]), p.gain * (demand[1] - x[4]), p.gain * (demand[2] - x[5])
    return u, ()


@kernel
def command_force(t: float, x: Any, c: Any, demand: Any, p: Any) -> Any:
    return (demand[0] - p.gain * x[3], demand[1] - p.gain * x[4], demand[2] - p.gain * x[5]), ()


@kernel
def references(x: Any, demand: Any, p: Any) -> Any:
    return demand


POINT = Vehicle(
    "point", "Point mass", 3, Nothing, Start, tuple(Signal(n, n, "") for n in ("x", "y", "z", "u", "v", "w")),
    tuple(Signal(n, n, "") for n in ("a_x", "a_y", "a_z")), (), begin, derivative, position, velocity, pose, outside,
    measured, frame="ned",
)  # fmt: skip
FOLLOWS = Controller(
    "follows", "Follows", ("point",), Nothing, 0, tuple(Signal(n, n, "") for n in ("d_x", "d_y", "d_z")),
    {"force": prepare, "velocity": prepare}, {"force": command_force, "velocity": command_velocity},
    {"force": references, "velocity": references},
)  # fmt: skip


def loop(avoider: str, *obstacles: str, compiled: bool = False) -> Loop:
    known: Any = components()
    parts = Parts(
        POINT, FOLLOWS, known["avoider", avoider], tuple(known["obstacle", o] for o in obstacles),
        known["criterion", "separation"],
    )  # fmt: skip
    return Loop(parts, lanes=16 if compiled else 1, compiled=compiled)


def vector(made: Loop, *obstacles: str, **given: float) -> Any:
    values = {"goal.x": 700.0, "goal.y": 0.0, "goal.z": -20.0, "criterion.threshold": 1.0} | given
    for i, name in enumerate(obstacles):
        values |= {f"obstacles.{i}.{k}": v for k, v in OBSTACLES[name].items()}
    found = []
    for section in made.sections:
        for p in declared(section.fields):
            value = values.get(f"{section.prefix}.{p.name}", p.default)
            found.append(math.nan if value is None else value)
    assert not np.isnan(found).any()
    return np.array([found])


GIVEN = {
    "closest_approach_3d": {"avoider.speed": 15.0, "avoider.clearance": 20.0},
    "gnron_3d": {"avoider.k_att": 0.1, "avoider.s": 150.0, "avoider.d_0": 60.0, "avoider.k_rep": 0.3},
}


@pytest.mark.nightly
@pytest.mark.parametrize("avoider", GIVEN)
def test_lockstep_equals_plain_python(avoider: str) -> None:
    fast, slow = loop(avoider, *OBSTACLES, compiled=True), loop(avoider, *OBSTACLES)
    p = vector(fast, *OBSTACLES, **GIVEN[avoider])
    a, b = fast.simulate(p, 0.05, 400, traced=1), slow.simulate(p, 0.05, 400, traced=1)
    assert a.status[0] == 0
    assert b.trace == pytest.approx(a.trace, abs=1e-9)


@pytest.mark.parametrize("obstacle", nightly_but(list(OBSTACLES)[:2], OBSTACLES))
def test_the_closest_approach_is_preserved(obstacle: str) -> None:
    made = loop("closest_approach_3d", obstacle)
    p = vector(made, obstacle, **GIVEN["closest_approach_3d"])
    flown = made.simulate(p, 0.05, 1000, traced=1)
    seen = made.observe(flown.trace[0], p[0], 0.05)
    first = [s.name for s in made.signals].index("obstacle.0.x")
    blind = made.simulate(
        vector(made, obstacle, **GIVEN["closest_approach_3d"] | {"avoider.horizon": 0.01}), 0.05, 1000
    )
    kept = {"cylinder": 40.0, "box_3d": 77.4}.get(obstacle, 45.0)
    assert blind.costs[0, 0] < kept - 10.0
    assert flown.costs[0, 0] > kept - 3.0  # a little goes into taking up the velocity
    assert flown.costs[0, 0] == pytest.approx(
        np.linalg.norm(seen[:, :3] - seen[:, first : first + 3], axis=1).min(), abs=0.2
    )
