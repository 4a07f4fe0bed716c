"""The kernels that components have, as types: what each receives and returns, with units. See `component` for whose.

Kernels are plain scalar Python on floats and tuples; how long a tuple is depends on the component, which states it.
Start reading at `Derivative`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from worker.kernels.views import Body, Body3, Errors, Seen, Sight, Surroundings

Time = Annotated[float, "s"]
Place = Annotated[Any, "m", "in the world frame, as many numbers as the loop has dimensions"]
Velocity = Annotated[Any, "m/s", "in the world frame"]
Place3 = Annotated[tuple[float, float, float], "m", "in space, z = 0 in the plane"]
Velocity3 = Annotated[tuple[float, float, float], "m/s", "in space"]
Pose = Annotated[tuple[float, float, float, float, float, float], "m, rad", "x, y, z, roll, pitch, yaw"]
State = Annotated[Any, "of the vehicle, in the order and units of its states"]
Inputs = Annotated[Any, "in the order and units of the vehicle's inputs"]
Demand = Annotated[Any, "N or m/s", "a force or a velocity in the world frame, or the controller's own references"]
Numbers = tuple[float, ...]
Inner = Annotated[Any, "the component's own state or memory; a derivative of it is per second; () without one"]
Own = Annotated[Any, "the component's parameters, or the constants that it derives from them"]
Goal = Annotated[Any, "the parameters of the avoider's goal"]
Bodies = Annotated[Any, "views.Body or Body3 of every obstacle as perceived, or what `weigh` made of them"]

Derive = Callable[[Own, Any], Numbers]
"""(parameters, trim) -> the constants in order; trim is () where the vehicle has none."""
Wake = Callable[[Own], Inner]
"""The component's own state at the start; an avoider's memory."""

# Vehicles: with the true state.

Begin = Callable[[Any, Own], State]
"""(start, p) -> the state at the start."""
Derivative = Callable[[Time, State, Inputs, Surroundings, Own], State]
Located = Callable[[State, Own], Place]
Moving = Callable[[State, Own], Velocity]
Posed = Callable[[State, Own], Pose]
Outside = Callable[[State, Own], float]
"""0.0 inside the envelope, else the number of the limit that is exceeded, from 1.0."""
Measured = Callable[[State, Errors, Own], State]
"""The state as navigation reports it; without errors too."""
Settle = Callable[[State, Own], State]
"""The state after each step, where the vehicle has stops of its own."""
Felt = Callable[[State, Surroundings, Own], State]
"""The state as measured, to the controller of a vehicle that feels the air and not the ground."""

# Controllers: with the vehicle's state as measured.

Prepare = Callable[[State, Demand, Own], Inner]
"""The controller's state at the start."""
Command = Callable[[Time, State, Inner, Demand, Own], tuple[Inputs, Inner]]
"""The inputs, and the derivative of the controller's state."""
References = Callable[[State, Demand, Own], Numbers]
"""What it aims at, in the order and units of its signals."""
Translate = Callable[[State, Demand, Own], Numbers]
"""The demand as its own references, as many numbers as a demand has."""

# Avoiders: with position and velocity as the vehicle believes them.

Steer = Callable[[Time, Place, Velocity, Goal, Bodies, Inner, Own], tuple[Demand, Inner]]
"""The demand, and the memory from then on."""
First = Callable[[Time, Place, Velocity, Goal, Inner, Own], Any]
"""What `weigh` begins with."""
Weigh = Callable[[Any, float, Any, Time, Place, Velocity, Goal, Inner, Own], Any]
"""(so far, number of the obstacle, its body, ...) -> what has been made of the obstacles so far and of this one."""

# Obstacles and environment: with the true position and velocity of the vehicle.

Shown = Callable[[Time, Inner, Place, Own], Body | Body3]
"""The obstacle as seen from there."""
Move = Callable[[Time, Inner, Place, Velocity, Own], Inner]
"""The derivative of the obstacle's state."""
Blow = Callable[..., tuple[Surroundings, Inner]]
"""(t, q, v, e, p), or (t, q, v, e, n, p) with the noise n of its `draw`: what it does to the vehicle, and the
derivative of its own state."""
Draw = Callable[[Time, Own], tuple[float, ...]]
"""The noise at this instant."""

# Faults, by path.

See = Callable[[Time, float, Pose, Velocity3, Body3, Own], Sight]
"""perception: (t, number of the obstacle, pose and velocity as the vehicle believes them, obstacle, p)."""
Delay = Callable[[Time, Own], Seen]
"""timing: the instant at which obstacles are seen."""
Mistake = Callable[[Time, Own], Errors]
"""navigation"""
Wait = Callable[[Own], float]
"""guidance: by how many guidance periods the demand is late, guidance.KEPT at most."""
Act = Callable[[Time, float, Inner, Own], tuple[float, Inner]]
"""actuator: the one input it is on as it arrives, and the derivative of the fault's state."""
Rest = Callable[[float, Own], Inner]
"""actuator: the fault's state at the start, given the first command."""

# Criteria.

Sample = Callable[[Time, Place, Velocity, State, Inputs, Any, Own], tuple[float]]
"""A channel at one instant, of what is true and arrives; last: a body, the goal's place [m] or the vehicle's pose."""
Value = Callable[[Numbers, Own], float]
"""The value in the criterion's own sign and unit, from what became of its channels."""
Excluded = Callable[[Numbers, Own], bool]
"""Whether the first reading bars the simulation."""
