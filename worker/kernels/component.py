"""What a component is: typed parameters with unit, limits and text, and the kernels that fill the loop's slots.

One file declares one component as its module attribute `component`; the file's docstring is its documentation.
Start reading at `Vehicle`; parameters are in `parameters`, the kernels' types with their units in `signatures`;
docs/your-own-component.md shows a whole file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from worker.kernels import signatures as sig
from worker.kernels.look import ObstacleLook, VehicleLook
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
    "ObstacleLook",
    "Parameter",
    "Reach",
    "Signal",
    "Switches",
    "Trim",
    "Vehicle",
    "VehicleLook",
    "declared",
    "extended",
]

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
    derive: sig.Derive


@dataclass(frozen=True)
class Vehicle:
    """A vehicle."""

    name: str
    title: str
    dimension: Literal[2, 3]
    parameters: type
    start: type
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    limits: tuple[Limit, ...]
    begin: sig.Begin
    derivative: sig.Derivative
    position: sig.Located
    velocity: sig.Moving
    pose: sig.Posed
    outside: sig.Outside
    measured: sig.Measured
    settle: sig.Settle | None = None
    felt: sig.Felt | None = None
    derived: Derived | None = None
    trim: Trim | None = None
    frame: Frame = "enu"
    """The axes that it flies in: the scenario's, which every other component has to share."""
    look: VehicleLook | None = None
    role: Literal["vehicle"] = "vehicle"


@dataclass(frozen=True)
class Controller:
    """A controller of the vehicles it fits.

    It has one kernel per kind of demand it accepts: it owns the mapping from the demand to its references. Where it has
    `translate`, the others receive its result in place of the demand: with sampled guidance it is computed once a
    sample and held, as an autopilot holds its references.
    """

    name: str
    title: str
    fits: tuple[str, ...]
    parameters: type
    states: int
    signals: tuple[Signal, ...]
    prepare: dict[str, sig.Prepare]
    command: dict[str, sig.Command]
    references: dict[str, sig.References]
    translate: dict[str, sig.Translate] | None = None
    derived: Derived | None = None
    role: Literal["controller"] = "controller"


@dataclass(frozen=True)
class Avoider:
    """An avoidance algorithm.

    `frame`: the axes that it takes for granted, where it has a sense of up, right or heading of its own; None where it
    is the same in all. Where it has `weigh`, every obstacle goes through it in turn, from what `first` returns on, and
    `steer` receives the last result in place of the bodies: a loop over bodies with much to do in it would not
    vectorise.
    """

    name: str
    title: str
    dimension: Literal[2, 3]
    demand: Literal["force", "velocity"]
    parameters: type
    goal: type
    memory: int
    steer: sig.Steer
    remember: sig.Wake
    weigh: sig.Weigh | None = None
    first: sig.First | None = None
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
    """An obstacle or intruder; with states of its own it has `wake` and `move`.

    `reach`: the largest distance of a point inside it from the centre that `body` reports. `frame` as in `Avoider`.
    `look`: how it is drawn; without one it is a ball of its parameter `radius`.
    """

    name: str
    title: str
    dimension: Literal[2, 3]
    parameters: type
    body: sig.Shown
    states: int = 0
    wake: sig.Wake | None = None
    move: sig.Move | None = None
    moving: bool = False
    derived: Derived | None = None
    reach: Reach | None = None
    frame: Frame | None = None
    look: ObstacleLook | None = None
    role: Literal["obstacle"] = "obstacle"


@dataclass(frozen=True)
class Environment:
    """A part of the environment.

    One with noise may have a `draw` of so many `draws`, which change at its `switches` alone; blow takes them before p.
    With the defaults of all its parameters it changes nothing; `switches` and a parameter `seed` as in `Fault`, `frame`
    as in `Avoider`.
    """

    name: str
    title: str
    parameters: type
    blow: sig.Blow
    states: int = 0
    wake: sig.Wake | None = None
    draw: sig.Draw | None = None
    draws: int = 0
    derived: Derived | None = None
    switches: Switches | None = None
    frame: Frame | None = None
    role: Literal["environment"] = "environment"


@dataclass(frozen=True)
class Fault:
    """An error or failure in one of the loop's paths, which decides which kernel it has.

    With the defaults of all its parameters it changes nothing: they are its zero magnitude. A parameter named `seed`
    selects a realisation: the campaign gives it, apart for every component and realisation. `switches` tells the
    instants at which it jumps, so that the other integrator can start anew there.
    """

    name: str
    title: str
    path: Literal["perception", "timing", "navigation", "guidance", "actuator"]
    parameters: type
    kernel: sig.See | sig.Delay | sig.Mistake | sig.Wait | sig.Act
    states: int = 0
    rest: sig.Rest | None = None
    derived: Derived | None = None
    switches: Switches | None = None
    frame: Frame | None = None
    role: Literal["fault"] = "fault"


@dataclass(frozen=True)
class Criterion:
    """What a flight is judged by; `sample` has one kernel per dimension it has a meaning in.

    `of`: each obstacle, a channel for each; the goal; or the flight. `over`: what becomes of a channel: the lowest over
    the flight, refined between steps by a parabola (a smooth channel) or at the steps (one that may jump), or the
    first instant [s] at which it is not above 0, the horizon where there is none.

    `worse`: which end is sought. One that is worse when low may decide: its first parameter is `threshold`, its value
    must stay above it, and it has `excluded`.
    `measured_to`: the point of an obstacle that its distances end at; "" where it reads no distances to obstacles.
    """

    name: str
    title: str
    quantity: str
    unit: str
    parameters: type
    sample: dict[int, sig.Sample]
    value: sig.Value
    excluded: sig.Excluded | None = None
    worse: Literal["low", "high"] = "low"
    of: Literal["obstacles", "goal", "flight"] = "obstacles"
    over: Literal["refined", "steps", "crossing"] = "refined"
    measured_to: Literal["", "centre", "surface"] = ""
    derived: Derived | None = None
    frame: Frame | None = None
    role: Literal["criterion"] = "criterion"


Component = Vehicle | Controller | Avoider | Obstacle | Environment | Fault | Criterion
