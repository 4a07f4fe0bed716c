"""A vehicle for tests of criteria: it moves along a straight line, with roll and load factor given by parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Controller, Parameter, Signal, Vehicle
from worker.engine.kernels.maths import sincos


class Drift(NamedTuple):
    vx: Annotated[float, Parameter("m/s", "Speed, x")] = 1.0
    vy: Annotated[float, Parameter("m/s", "Speed, y")] = 0.0
    bank: Annotated[float, Parameter("rad", "Amplitude of the bank")] = 0.0
    rate: Annotated[float, Parameter("rad/s", "Its rate")] = 1.0


class Start(NamedTuple):
    x: Annotated[float, Parameter("m", "Start, x")] = 0.0


class Goal(NamedTuple):
    x: Annotated[float, Parameter("m", "Goal, x")] = 5.0
    y: Annotated[float, Parameter("m", "Goal, y")] = 0.0
    z: Annotated[float, Parameter("m", "Goal, z")] = 0.0


class Nothing(NamedTuple):
    """It has nothing to set."""


def _bank(x: Any, p: Drift) -> float:
    return p.bank * sincos(p.rate * x[3])[0]  # type: ignore[no-any-return]


def begin(start: Start, p: Drift) -> Any:
    return start.x, 0.0, 0.0, 0.0


def derivative(t: float, x: Any, u: Any, env: Any, p: Drift) -> Any:
    return p.vx, p.vy, 0.0, 1.0


def position(x: Any, p: Drift) -> Any:
    return x[0], x[1], x[2]


def velocity(x: Any, p: Drift) -> Any:
    return p.vx, p.vy, 0.0


def pose(x: Any, p: Drift) -> Any:
    return x[0], x[1], x[2], _bank(x, p), 0.0, 0.0


def outside(x: Any, p: Drift) -> float:
    return 0.0


def measured(x: Any, e: Any, p: Drift) -> Any:
    return x


VEHICLE = Vehicle(
    name="drift",
    title="Drift",
    dimension=3,
    parameters=Drift,
    start=Start,
    states=tuple(Signal(n, n, "") for n in ("x", "y", "z", "t")),
    inputs=(Signal("pull", "pull", ""), Signal("push", "push", "")),
    limits=(),
    begin=begin,
    derivative=derivative,
    position=position,
    velocity=velocity,
    pose=pose,
    outside=outside,
    measured=measured,
)


class Pulls(NamedTuple):
    pull: Annotated[float, Parameter("", "First input after 1.001 s")] = 0.0
    push: Annotated[float, Parameter("", "Second input, always")] = 0.0


def prepare(x: Any, demand: Any, p: Pulls) -> Any:
    return ()


def command(t: float, x: Any, c: Any, demand: Any, p: Pulls) -> Any:
    return (p.pull if x[3] > 1.001 else 0.0, p.push), ()


def steer(t: float, q: Any, v: Any, goal: Goal, bodies: Any, m: Any, p: Nothing) -> Any:
    return (0.0, 0.0, 0.0), ()


def remember(p: Nothing) -> Any:
    return ()


CONTROLLER = Controller(
    name="pulls",
    title="Pulls",
    fits=("drift",),
    parameters=Pulls,
    states=0,
    signals=(),
    prepare={"velocity": prepare},
    command={"velocity": command},
    references={"velocity": prepare},
)

AVOIDER = Avoider(
    name="nothing",
    title="Nothing",
    dimension=3,
    demand="velocity",
    parameters=Nothing,
    goal=Goal,
    memory=0,
    steer=steer,
    remember=remember,
)


class PlanarGoal(NamedTuple):
    x: Annotated[float, Parameter("m", "Goal, x")] = 5.0
    y: Annotated[float, Parameter("m", "Goal, y")] = 0.0


def planar_position(x: Any, p: Drift) -> Any:
    return x[0], x[1]


def planar_velocity(x: Any, p: Drift) -> Any:
    return p.vx, p.vy


def planar_steer(t: float, q: Any, v: Any, goal: PlanarGoal, bodies: Any, m: Any, p: Nothing) -> Any:
    return (0.0, 0.0), ()


PLANAR_VEHICLE = replace(VEHICLE, dimension=2, position=planar_position, velocity=planar_velocity)
PLANAR_AVOIDER = replace(AVOIDER, dimension=2, goal=PlanarGoal, steer=planar_steer)
