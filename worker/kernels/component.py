"""What a component is: typed parameters with unit, limits and text, and the kernels that fill the loop's slots.

One file declares one component as its module attribute `component`; the file's docstring is its documentation.
Start reading at `Vehicle`; parameters are in `parameters`; docs/your-own-component.md shows a whole file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from worker.kernels.parameters import Declared, Parameter, declared, extended

__all__ = [
    "Avoider",
    "Component",
    "Controller",
    "Criterion",
    "Declared",
    "Derived",
    "Environment",
    "Fault",
    "Limit",
    "NoTrim",
    "Obstacle",
    "Parameter",
    "Reach",
    "Signal",
    "Switches",
    "Trim",
    "Vehicle",
    "declared",
    "extended",
]

Kernel = Callable[..., Any]
Switches = Callable[[Any, float], list[float]]
"""switches(parameters or derived constants, horizon [s]) -> instants [s] at which it jumps, in plain Python."""


@dataclass(frozen=True)
class Signal:
    """A column of a trace: what it shows, its symbol and unit."""

    name: str
    symbol: str
    unit: str


@dataclass(frozen=True)
class Limit:
    """An edge of a vehicle's envelope; `text` completes "the flight left the model's envelope: ..."."""

    text: str


Frame = Literal["enu", "ned"]
"""Axes of the world: x east, y north, z up; or x north, y east, z down as flight mechanics has it."""


@dataclass(frozen=True)
class Trim:
    """What is solved once per campaign, in plain Python, at the nominal values: an equilibrium, gains at it.

    solve(nominal values by path, such as "vehicle.m" and "start.speed") -> fields; raises `NoTrim` with a sentence.
    The same for every flight: an autopilot is set up for the nominal aircraft, not for the one that flies.
    """

    fields: type
    solve: Callable[[Mapping[str, float]], Any]


class NoTrim(ValueError):
    """The equilibrium cannot be found; the message says at which values and what to change."""


@dataclass(frozen=True)
class Derived:
    """What a component computes once per flight: constants(*derive(parameters, trim)), trim being () without one.

    Where a component has it, its kernels receive the NamedTuple `constants` in place of its parameters: a division or
    a gain that stays the same all flight is not worth four times every step.
    """

    constants: type
    derive: Kernel


@dataclass(frozen=True)
class Vehicle:
    """A vehicle. Its kernels, x being its state and p its parameters or derived constants:

    begin(start, p) -> x; derivative(t, x, u, env, p) -> dx with env as views.Surroundings; position(x, p) and
    velocity(x, p) in the world frame [m], [m/s]; pose(x, p) -> (x, y, z, roll, pitch, yaw) [m], [rad];
    outside(x, p) -> 0.0 inside the envelope, else the number of the limit exceeded, from 1.0;
    measured(x, errors, p) -> x as navigation reports it, errors as views.Errors;
    settle(x, p) -> x after each step, where the vehicle has stops of its own;
    felt(x, env, p) -> x as measured, to the controller of a vehicle that feels the air and not the ground.
    """

    name: str
    title: str
    dimension: Literal[2, 3]
    parameters: type
    start: type
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    limits: tuple[Limit, ...]
    begin: Kernel
    derivative: Kernel
    position: Kernel
    velocity: Kernel
    pose: Kernel
    outside: Kernel
    measured: Kernel
    settle: Kernel | None = None
    felt: Kernel | None = None
    derived: Derived | None = None
    trim: Trim | None = None
    frame: Frame = "enu"
    """The axes that it flies in: the scenario's, which every other component has to share."""
    role: Literal["vehicle"] = "vehicle"


@dataclass(frozen=True)
class Controller:
    """A controller of the vehicles it fits. Its kernels, c being its own state:

    prepare(x, demand, p) -> c; command(t, x, c, demand, p) -> (u, dc); references(x, demand, p) -> what it aims at.
    `command` holds one kernel per kind of demand it accepts: it owns the mapping from the demand to its references.
    Where it has translate(x, demand, p) -> as many numbers as a demand has, the others receive these in place of the
    demand: with sampled guidance they are worked out once a sample and held, as an autopilot holds its references.
    """

    name: str
    title: str
    fits: tuple[str, ...]
    parameters: type
    states: int
    signals: tuple[Signal, ...]
    prepare: dict[str, Kernel]
    command: dict[str, Kernel]
    references: dict[str, Kernel]
    translate: dict[str, Kernel] | None = None
    derived: Derived | None = None
    role: Literal["controller"] = "controller"


@dataclass(frozen=True)
class Avoider:
    """An avoidance algorithm. Its kernels, m being its memory between samples:

    steer(t, position, velocity, goal, bodies, m, p) -> (demand, m); remember(p) -> m at the start.
    The demand is a world-frame force or velocity of the given dimension. `frame`: the axes that it takes for granted,
    where it has a sense of up, right or heading of its own; None where it is the same in all.
    Where it has weigh(so_far, number, body, t, position, velocity, goal, m, p) -> so_far, which every obstacle goes
    through in turn from first(t, position, velocity, goal, m, p) -> so_far on, steer receives the last so_far in place
    of the bodies: a loop over bodies with much to do in it would not vectorise.
    """

    name: str
    title: str
    dimension: Literal[2, 3]
    demand: Literal["force", "velocity"]
    parameters: type
    goal: type
    memory: int
    steer: Kernel
    remember: Kernel
    weigh: Kernel | None = None
    first: Kernel | None = None
    derived: Derived | None = None
    frame: Frame | None = None
    role: Literal["avoider"] = "avoider"


@dataclass(frozen=True)
class Reach:
    """How far an obstacle's surface is from its centre at most: `times` the root of the sum of squares of parameters.

    As data, because the checks of a campaign need it without the physics. Of a circle Reach(("radius",)), of a box
    Reach(("length", "width"), 0.5).
    """

    of: tuple[str, ...]
    times: float = 1.0


@dataclass(frozen=True)
class Obstacle:
    """An obstacle or intruder. Its kernels, o being its own state where it has one:

    body(t, o, q, p) -> views.Body (plane) or views.Body3 (space) as seen from q; wake(p) -> o at the start;
    move(t, o, q, v, p) -> do, q and v being the true position and velocity of the vehicle.

    `reach`: the largest distance of a point inside it from the centre that `body` reports. `frame` as in `Avoider`.
    """

    name: str
    title: str
    dimension: Literal[2, 3]
    parameters: type
    body: Kernel
    states: int = 0
    wake: Kernel | None = None
    move: Kernel | None = None
    moving: bool = False
    derived: Derived | None = None
    reach: Reach | None = None
    frame: Frame | None = None
    role: Literal["obstacle"] = "obstacle"


@dataclass(frozen=True)
class Environment:
    """A part of the environment. blow(t, q, v, e, p) -> (views.Surroundings, de); wake(p) -> e at the start.

    q and v are the true position and velocity in space, whatever the dimension (z = 0 in the plane).
    One with noise may have draw(t, p) -> n, so many `draws` that change at its `switches` alone; blow takes n before p.
    With the defaults of all its parameters it changes nothing; `switches` and a parameter `seed` as in `Fault`, `frame`
    as in `Avoider`.
    """

    name: str
    title: str
    parameters: type
    blow: Kernel
    states: int = 0
    wake: Kernel | None = None
    draw: Kernel | None = None
    draws: int = 0
    derived: Derived | None = None
    switches: Switches | None = None
    frame: Frame | None = None
    role: Literal["environment"] = "environment"


@dataclass(frozen=True)
class Fault:
    """An error or failure in one of the loop's paths. Its kernel, by path:

    perception: see(t, index, own, v, body, p) -> views.Sight; own is (x, y, z, roll, pitch, yaw), v its velocity (3),
    as the vehicle believes, body the obstacle as views.Body3, whatever the dimension;
    timing: delay(t, p) -> views.Seen, the instant at which obstacles are seen;
    navigation: mistake(t, p) -> views.Errors;
    guidance: wait(p) -> by how many guidance periods the demand is late, guidance.KEPT at most;
    actuator: act(t, u, a, p) -> (u, da) for the one input it is `on`, a being its own state; rest(u, p) -> a at first.

    With the defaults of all its parameters it changes nothing: they are its zero magnitude. A parameter named `seed`
    selects a realisation: the campaign gives it, apart for every component and realisation. `switches` tells the
    instants at which it jumps, so that the other integrator can start anew there.
    """

    name: str
    title: str
    path: Literal["perception", "timing", "navigation", "guidance", "actuator"]
    parameters: type
    kernel: Kernel
    states: int = 0
    rest: Kernel | None = None
    derived: Derived | None = None
    switches: Switches | None = None
    frame: Frame | None = None
    role: Literal["fault"] = "fault"


@dataclass(frozen=True)
class Criterion:
    """What a flight is judged by. Its kernels, `sample` one per dimension it has a meaning in:

    sample(t, position, velocity, x, u, to, p) -> (channel,) at one instant, with the true state x and the inputs u that
    arrive. `to` is what it is `of`: each obstacle as views.Body or Body3, a channel for each; the goal's place; or the
    vehicle's pose. value(reading, p) -> its value in its own sign, from what `over` makes of each channel: the lowest
    over the flight, refined between steps by a parabola (a smooth channel) or at the steps (one that may jump), or the
    first instant [s] at which it is not above 0, the horizon where there is none.

    `worse`: which end is sought. One that is worse when low may decide: its first parameter is `threshold`, its value
    must stay above it, and excluded(first, p) tells whether the first reading bars the flight.
    `measured_to`: the point of an obstacle that its distances end at; "" where it reads no distances to obstacles.
    """

    name: str
    title: str
    quantity: str
    unit: str
    parameters: type
    sample: dict[int, Kernel]
    value: Kernel
    excluded: Kernel | None = None
    worse: Literal["low", "high"] = "low"
    of: Literal["obstacles", "goal", "flight"] = "obstacles"
    over: Literal["refined", "steps", "crossing"] = "refined"
    measured_to: Literal["", "centre", "surface"] = ""
    derived: Derived | None = None
    frame: Frame | None = None
    role: Literal["criterion"] = "criterion"


Component = Vehicle | Controller | Avoider | Obstacle | Environment | Fault | Criterion
