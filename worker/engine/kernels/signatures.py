"""Types of the kernels of components: what each receives and returns, with units. `component` lists who has which.

Kernels are scalar Python code on floats and tuples; the component declares the length of each tuple.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from worker.engine.kernels.views import Body, Body3, Errors, Seen, Sight, Surroundings

Time = Annotated[float, "s"]
Place = Annotated[Any, "m", "position in the world frame, as many numbers as the loop has dimensions"]
Velocity = Annotated[Any, "m/s", "in the world frame"]
Velocity3 = Annotated[tuple[float, float, float], "m/s", "in space"]
Pose = Annotated[tuple[float, float, float, float, float, float], "m, rad", "x, y, z, roll, pitch, yaw"]
State = Annotated[Any, "of the vehicle, in the order and units of its states"]
Inputs = Annotated[Any, "in the order and units of the vehicle's inputs"]
Demand = Annotated[Any, "N or m/s", "a force or a velocity in the world frame, or the controller's own references"]
Numbers = tuple[float, ...]
Inner = Annotated[Any, "the component's own state or memory, or its derivative (per second); () without one"]
Own = Annotated[Any, "the component's parameters, or the constants derived from them"]
Goal = Annotated[Any, "the parameters of the avoider's goal"]
Bodies = Annotated[Any, "views.Body or Body3 of every obstacle as perceived, or the result of `weigh`"]

Derive = Callable[[Own, Any], Numbers]
"""(parameters, trim) -> the constants in order; trim is () where the vehicle has none."""
Wake = Callable[[Own], Inner]
"""The component's own state at the start; an avoider's memory."""

# Vehicles receive the true state.

Begin = Callable[[Any, Own], State]
"""(start, p) -> the state at the start."""
Derivative = Callable[[Time, State, Inputs, Surroundings, Own], State]
Located = Callable[[State, Own], Place]
Moving = Callable[[State, Own], Velocity]
Posed = Callable[[State, Own], Pose]
Outside = Callable[[State, Own], float]
"""0.0 inside the envelope, else the number of the exceeded limit, counted from 1.0. A vehicle with `felt` receives the
state with air data here: its limits are those of the flow."""
Measured = Callable[[State, Errors, Own], State]
"""The state as navigation reports it; it is called without errors too."""
Settle = Callable[[State, Own], State]
"""The state after each step, for a vehicle with mechanical stops."""
Felt = Callable[[State, Surroundings, Own], State]
"""The true state with air data, of a vehicle that flies relative to the air; `measured` then adds the errors."""

# Controllers receive the vehicle's measured state.

Prepare = Callable[[State, Demand, Own], Inner]
"""The controller's state at the start."""
Command = Callable[[Time, State, Inner, Demand, Own], tuple[Inputs, Inner]]
"""The inputs, and the derivative of the controller's state."""
References = Callable[[State, Demand, Own], Numbers]
"""The controller's references, in the order and units of its signals."""
Translate = Callable[[State, Demand, Own], Numbers]
"""The demand as the controller's own references; as many numbers as the demand has."""

# Avoiders receive the measured position and velocity.

Steer = Callable[[Time, Place, Velocity, Goal, Bodies, Inner, Own], tuple[Demand, Inner]]
"""The demand, and the new memory."""
First = Callable[[Time, Place, Velocity, Goal, Inner, Own], Any]
"""The initial value of the fold by `weigh`."""
Weigh = Callable[[Any, float, Any, Time, Place, Velocity, Goal, Inner, Own], Any]
"""(result so far, index of the obstacle, its body, ...) -> the result including this obstacle."""

# Obstacles and the environment receive the true position and velocity of the vehicle.

Shown = Callable[[Time, Inner, Place, Own], Body | Body3]
"""The obstacle as seen from that position."""
Move = Callable[[Time, Inner, Place, Velocity, Own], Inner]
"""The derivative of the obstacle's state."""
Blow = Callable[..., tuple[Surroundings, Inner]]
"""(t, q, v, e, p), or (t, q, v, e, n, p) with the noise n of its `draw`: its effect on the vehicle, and the derivative
of its own state."""
Draw = Callable[[Time, Own], tuple[float, ...]]
"""The noise at this instant."""

# Faults, by path.

See = Callable[[Time, float, Pose, Velocity3, Body3, Own], Sight]
"""perception: (t, index of the obstacle, measured pose and velocity of the vehicle, obstacle, p)."""
Delay = Callable[[Time, Own], Seen]
"""timing: the instant for which obstacles are observed."""
Mistake = Callable[[Time, Own], Errors]
"""navigation"""
Wait = Callable[[Own], float]
"""guidance: the delay of the demand in guidance periods, at most guidance.KEPT in sum: beyond, the flight fails."""
Act = Callable[[Time, float, Inner, Own], tuple[float, Inner]]
"""actuator: the input as it reaches the vehicle, and the derivative of the fault's state."""
Rest = Callable[[float, Own], Inner]
"""actuator: the fault's state at the start, given the first command."""

# Criteria.

Sample = Callable[[Time, Place, Velocity, State, Inputs, Any, Own], tuple[float]]
"""A channel at one instant, from true states and actual inputs; the last but one argument is a body, the goal's
position [m] or the vehicle's pose."""
Value = Callable[[Numbers, Own], float]
"""The value in the criterion's own sign and unit, from its reduced channels."""
Excluded = Callable[[Numbers, Own], bool]
"""Whether the channels at the start exclude the simulation."""
