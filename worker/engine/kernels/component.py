"""Declarations of components: typed parameters with unit, limits and text, and the kernels that fill the loop's slots.

One file declares one component as its module attribute `component`; the file's docstring is its documentation.
`parameters` declares parameters, `signatures` the types and units of the kernels; docs/your-own-component.md shows a
complete file.
"""

from __future__ import annotations

import dis
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from worker.engine.kernels import signatures as sig
from worker.engine.kernels.about_trim import AboutTrim as AboutTrim  # components import all that they need from here
from worker.engine.kernels.about_trim import Polynomial as Polynomial
from worker.engine.kernels.about_trim import Trimmed as Trimmed
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.numba_internals import python
from worker.engine.kernels.parameters import Declared as Declared
from worker.engine.kernels.parameters import Order as Order
from worker.engine.kernels.parameters import Parameter as Parameter
from worker.engine.kernels.parameters import declared as declared
from worker.engine.kernels.parameters import extended as extended

Switches = Callable[[Any, float], list[float]]
"""switches(parameters or derived constants, horizon [s]) -> instants of its discontinuities [s], in plain Python."""


@dataclass(frozen=True)
class Signal:
    """A column of a trace: name, symbol and unit."""

    name: str
    symbol: str
    unit: str


@dataclass(frozen=True)
class Limit:
    """A limit of a vehicle's envelope; `text` completes "the vehicle left the model's envelope: ..."."""

    text: str


Frame = Literal["enu", "ned"]
"""World axes: x east, y north, z up; or x north, y east, z down, as usual in flight mechanics."""


@dataclass(frozen=True)
class Trim:
    """The equilibrium at the nominal values and gains there, solved once per campaign in plain Python.

    solve(nominal values by path, such as "vehicle.m" and "start.speed") -> fields; raises `NoTrim` with a message.
    Every simulation uses the same trim: an autopilot is tuned for the nominal aircraft, not for the actual one.
    """

    fields: type
    solve: Callable[[Mapping[str, float]], Any]


class NoTrim(ValueError):
    """No equilibrium was found; the message gives the values and what to change."""


@dataclass(frozen=True)
class Derived:
    """Constants that a component computes once per simulation: constants(*derive(parameters, trim)); trim may be ().

    The kernels of such a component receive the NamedTuple `constants` in place of its parameters. This keeps divisions
    and gains that do not change during a simulation out of the four stages of every step.
    """

    constants: type
    derive: sig.Derive


@dataclass(frozen=True)
class VehicleLook:
    """How a vehicle is drawn: the mesh, and the start state that gives the heading."""

    mesh: str
    heading: str = ""


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
    """Of a vehicle that flies relative to the air: its controller and `outside` receive the state with air data."""
    derived: Derived | None = None
    trim: Trim | None = None
    frame: Frame = "enu"
    """The scenario's world axes, which every other component must share."""
    look: VehicleLook | None = None
    orders: tuple[Order, ...] = ()
    role: Literal["vehicle"] = "vehicle"


@dataclass(frozen=True)
class Controller:
    """A controller of the vehicles named in `fits`.

    It has one kernel per kind of demand, which maps the demand to the controller's references. If it has `translate`,
    its other kernels receive the result in place of the demand; with sampled guidance, `translate` runs once per sample
    and its result is held, as an autopilot holds its references.
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
    about_trim: AboutTrim | None = None
    """The polynomial model of the loop with a vehicle that it fits, for the region of attraction."""
    orders: tuple[Order, ...] = ()
    role: Literal["controller"] = "controller"


@kernel
def _nothing(p: Any) -> tuple[()]:
    """The memory of an avoider without one."""
    return ()


@dataclass(frozen=True)
class Avoider:
    """An avoidance algorithm.

    `frame`: the axes that it assumes, if it depends on the directions of up, right or heading; None if it works in any.
    `weigh` folds over the obstacles one by one, starting with the result of `first`; `steer` then receives the last
    result in place of the bodies. This unrolls the loop over bodies: a long loop body would not vectorise. One with
    memory needs `remember`.
    """

    name: str
    title: str
    dimension: Literal[2, 3]
    demand: Literal["force", "velocity"]
    parameters: type
    goal: type
    memory: int
    steer: sig.Steer
    remember: sig.Wake = _nothing
    weigh: sig.Weigh | None = None
    first: sig.First | None = None
    derived: Derived | None = None
    frame: Frame | None = None
    orders: tuple[Order, ...] = ()
    role: Literal["avoider"] = "avoider"


@dataclass(frozen=True)
class Reach:
    """The largest distance of an obstacle's surface from its centre: `times` the root sum of squares of parameters.

    It is data, because the checks of a campaign need it without the physics: Reach(("radius",)) for a circle,
    Reach(("length", "width"), 0.5) for a box.
    """

    of: tuple[str, ...]
    times: float = 1.0


@dataclass(frozen=True)
class Rate:
    """How fast a prescribed motion turns [rad/s]: within pi over the rate its velocity, and its shape, each turn by at
    most half a turn.

    `times` the product of the magnitudes of the parameters `of`, over those of `per`: Rate(("speed",), ("way",)) on a
    circle. A path of straight legs between corners turns at most once in the time of its shortest leg:
    Rate(("speed",), legs=("position", "goal")); `used` is the parameter with the number of legs, `stops` of one leg the
    derived constant with the instant at which it ends [s]. Without `stops`, legs follow each other from t = 0 at that
    speed: simulations are divided where they end, because a distance may have two minima in such a step. Like `Reach`
    it is data. A straight motion that never ends, of a shape that does not turn, has Rate(times=0.0).
    """

    of: tuple[str, ...] = ()
    per: tuple[str, ...] = ()
    times: float = 1.0
    legs: tuple[str, ...] = ()
    used: str = ""
    stops: str = ""


@dataclass(frozen=True)
class ObstacleLook:
    """How an obstacle is drawn: the shape, the parameters that give the sizes, and the kind of path; the allowed values
    are those of `campaigns.looks`, which checks them."""

    shape: str
    radius: str = ""
    height: str = ""
    sides: tuple[str, ...] = ()
    angle: str = ""
    way: str = "still"


@dataclass(frozen=True)
class Obstacle:
    """An obstacle or intruder; one with states has `wake` and `move`.

    `moving`: whether it moves by itself, as one with states does, or one whose body reads the time. `rate`: how fast it
    turns then; nothing is cleared without it.

    `reach`: the largest distance of a point inside it from the centre that `body` reports there, 0 of a point; with a
    criterion of distances to centres nothing is cleared without it. `frame` as in `Avoider`.
    `look`: how it is drawn; by default a ball of its parameter `radius`.
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
    rate: Rate | None = None
    frame: Frame | None = None
    look: ObstacleLook | None = None
    orders: tuple[Order, ...] = ()
    role: Literal["obstacle"] = "obstacle"

    def __post_init__(self) -> None:
        # A motion that is not declared is one, too, and its rate is then unknown.
        if self.states or _reads_time(self.body):
            object.__setattr__(self, "moving", True)


def _reads_time(body: Any) -> bool:
    """Whether the code of a kernel uses its first argument, as far as this is known."""
    code = getattr(python(body), "__code__", None)
    if code is None or not code.co_argcount:
        return True  # what it does with arguments that have no names is unknown
    uses = (each.argval for each in dis.get_instructions(code))
    return any(code.co_varnames[0] in (use if isinstance(use, tuple) else (use,)) for use in uses)


@dataclass(frozen=True)
class Environment:
    """A part of the environment.

    A random one may have `draw`, which returns `draws` samples that change only at its `switches`; `blow` takes them
    before p. With default parameters it has no effect. `switches`, `whole` and a parameter `seed` as in `Fault`,
    `frame` as in `Avoider`.
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
    whole: int = 0
    frame: Frame | None = None
    orders: tuple[Order, ...] = ()
    role: Literal["environment"] = "environment"


def unswitched(component: Fault | Environment) -> bool:
    """Whether it reads the time and declares no `switches`, not even an empty list: when it jumps is unknown."""
    if component.switches is not None or (isinstance(component, Fault) and component.path == "guidance"):
        return False
    return _reads_time(component.kernel if isinstance(component, Fault) else component.blow)


@dataclass(frozen=True)
class Fault:
    """An error or failure in one path of the loop; the path determines the type of its kernel.

    With default parameters it has no effect: the defaults are zero magnitude. A parameter named `seed` selects a
    realisation; the campaign sets it, differently for every component and realisation. `switches` returns the instants
    of its discontinuities, so that the reference integrator can restart there; `whole` is the index of the one from
    which on its effect is whole, if it builds up until then.
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
    whole: int = 0
    frame: Frame | None = None
    orders: tuple[Order, ...] = ()
    role: Literal["fault"] = "fault"


@dataclass(frozen=True)
class Criterion:
    """A criterion of a simulation; `sample` has one kernel per dimension that it supports.

    `of`: what a channel is sampled for: each obstacle (one channel each), the goal, or the whole flight.
    `over`: how a channel is reduced over time: its minimum, refined between steps by a parabola (smooth channels, such
    as squared distances), searched between steps (channels with kinks that depend on time and state alone, such as
    distances to surfaces) or at the steps (channels that may jump), or the first instant [s] at which it is not above 0
    (the horizon if there is none).

    `worse`: the end of the range that searches look for. A criterion that is worse when low may decide the verdict: its
    first parameter is `threshold`, its value must stay above it, and it has `excluded`.
    `measured_to`: the point of an obstacle that distances are measured to; "none" if the criterion uses no such
    distances. Of one of obstacles that does not state it, nothing is cleared.
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
    over: Literal["refined", "searched", "steps", "crossing"] = "refined"
    measured_to: Literal["", "centre", "surface", "none"] = ""
    derived: Derived | None = None
    frame: Frame | None = None
    role: Literal["criterion"] = "criterion"


Component = Vehicle | Controller | Avoider | Obstacle | Environment | Fault | Criterion
