"""The kernels that components have, as types: what each receives and returns, with units. See `component` for whose.

Kernels are plain scalar Python on floats and tuples. p is the component's own NamedTuple of parameters, or of the
constants that it derives from them. Start reading at `Derivative`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Protocol

from worker.kernels.views import Body, Body3, Errors, Seen, Sight, Surroundings

Time = Annotated[float, "s"]
Place = Annotated[tuple[float, ...], "m"]
"""In the world frame, as many numbers as the loop has dimensions."""
Velocity = Annotated[tuple[float, ...], "m/s"]
Place3 = Annotated[tuple[float, float, float], "m"]
Velocity3 = Annotated[tuple[float, float, float], "m/s"]
Pose = Annotated[tuple[float, float, float, float, float, float], "m, m, m, rad, rad, rad"]
"""x, y, z, roll, pitch, yaw."""
Demand = Annotated[tuple[float, ...], "N or m/s"]
"""A force or a velocity in the world frame, as the avoider declares."""
State = tuple[float, ...]
"""In the order and units of the `Signal`s that the component declares; a derivative of one is per second."""
Inputs = tuple[float, ...]
"""In the order and units of the vehicle's `inputs`."""
Memory = tuple[float, ...]
"""What an avoider remembers from one guidance sample to the next."""
Reading = Annotated[tuple[float], "the criterion's unit"]

Derive = Callable[[Any, Any], tuple[float, ...]]
"""derive(parameters, trim) -> the derived constants in order; trim is () without one."""
Wake = Callable[[Any], State]
"""wake(p) -> the component's own state at the start; remember(p) -> an avoider's memory."""


# Vehicles: x is the true state unless stated otherwise, u the inputs that arrive.


class Begin(Protocol):
    def __call__(self, start: Any, p: Any, /) -> State: ...


class Derivative(Protocol):
    def __call__(self, t: Time, x: Any, u: Any, env: Surroundings, p: Any, /) -> State: ...


class Located(Protocol):
    def __call__(self, x: Any, p: Any, /) -> Place: ...


class Moving(Protocol):
    def __call__(self, x: Any, p: Any, /) -> Velocity: ...


class Posed(Protocol):
    def __call__(self, x: Any, p: Any, /) -> Pose: ...


class Outside(Protocol):
    """0.0 inside the envelope, else the number of the limit that is exceeded, from 1.0."""

    def __call__(self, x: Any, p: Any, /) -> float: ...


class Measured(Protocol):
    """The state as navigation reports it."""

    def __call__(self, x: Any, errors: Errors, p: Any, /) -> State: ...


class Settle(Protocol):
    """The state after each step, where the vehicle has stops of its own."""

    def __call__(self, x: Any, p: Any, /) -> State: ...


class Felt(Protocol):
    """The state as measured, to the controller of a vehicle that feels the air and not the ground."""

    def __call__(self, x: Any, env: Surroundings, p: Any, /) -> State: ...


# Controllers: x is the vehicle's state as measured, c the controller's own.


class Prepare(Protocol):
    """The controller's state at the start."""

    def __call__(self, x: Any, demand: Any, p: Any, /) -> State: ...


class Command(Protocol):
    """The inputs, and the derivative of the controller's state."""

    def __call__(self, t: Time, x: Any, c: Any, demand: Any, p: Any, /) -> tuple[Inputs, State]: ...


class References(Protocol):
    """What the controller aims at, in the order and units of its `signals`."""

    def __call__(self, x: Any, demand: Any, p: Any, /) -> tuple[float, ...]: ...


class Translate(Protocol):
    """The demand as the controller's own references, as many numbers as a demand has."""

    def __call__(self, x: Any, demand: Any, p: Any, /) -> tuple[float, ...]: ...


# Avoiders: q and v are position [m] and velocity [m/s] as the vehicle believes them.


class Steer(Protocol):
    """The demand, and the memory from then on; bodies are views.Body or Body3, or what `weigh` made of them."""

    def __call__(self, t: Time, q: Any, v: Any, goal: Any, bodies: Any, m: Any, p: Any, /) -> tuple[Demand, Memory]: ...


class First(Protocol):
    """What `weigh` begins with."""

    def __call__(self, t: Time, q: Any, v: Any, goal: Any, m: Any, p: Any, /) -> Any: ...


class Weigh(Protocol):
    """What has been made of the obstacles so far, and of one more."""

    def __call__(
        self, so_far: Any, number: float, body: Any, t: Time, q: Any, v: Any, goal: Any, m: Any, p: Any, /
    ) -> Any: ...


# Obstacles and environment: q and v are the true position [m] and velocity [m/s] of the vehicle.


class Shown(Protocol):
    """The obstacle as seen from q; o is its own state, () without one."""

    def __call__(self, t: Time, o: Any, q: Any, p: Any, /) -> Body | Body3: ...


class Move(Protocol):
    """The derivative of the obstacle's state."""

    def __call__(self, t: Time, o: Any, q: Any, v: Any, p: Any, /) -> State: ...


class Blow(Protocol):
    """What it does to the vehicle, and the derivative of its own state; q and v in space (z = 0 in the plane)."""

    def __call__(self, t: Time, q: Place3, v: Velocity3, e: Any, p: Any, /) -> tuple[Surroundings, State]: ...


# Faults, by path.


class See(Protocol):
    """perception: index counts the obstacles; pose and velocity as the vehicle believes them, in space."""

    def __call__(self, t: Time, index: float, pose: Pose, v: Velocity3, body: Body3, p: Any, /) -> Sight: ...


class Delay(Protocol):
    """timing: the instant at which obstacles are seen."""

    def __call__(self, t: Time, p: Any, /) -> Seen: ...


class Mistake(Protocol):
    """navigation"""

    def __call__(self, t: Time, p: Any, /) -> Errors: ...


class Wait(Protocol):
    """guidance: by how many guidance periods the demand is late, guidance.KEPT at most."""

    def __call__(self, p: Any, /) -> float: ...


class Act(Protocol):
    """actuator: the one input it is `on` as it arrives, and the derivative of the fault's own state a."""

    def __call__(self, t: Time, u: float, a: Any, p: Any, /) -> tuple[float, State]: ...


class Rest(Protocol):
    """actuator: its own state at the start, given the first command."""

    def __call__(self, u: float, p: Any, /) -> State: ...


# Criteria: with the true state x and the inputs u that arrive.


class Sample(Protocol):
    """One channel at one instant. `to`: a views.Body or Body3, the goal's place [m], or the vehicle's pose."""

    def __call__(self, t: Time, q: Any, v: Any, x: Any, u: Any, to: Any, p: Any, /) -> Reading: ...


class Value(Protocol):
    """The criterion's value in its own sign, from what became of its channels over the flight."""

    def __call__(self, reading: Any, p: Any, /) -> float: ...


class Excluded(Protocol):
    """Whether the first reading bars the flight."""

    def __call__(self, first: Any, p: Any, /) -> bool: ...
