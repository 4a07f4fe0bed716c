"""Time to goal: the first instant within a radius of the goal; the horizon if there is none.

    t_goal = min {t <= T : |q(t) - g| <= R},   T where the set is empty; more is worse

The crossing is found on the straight line through the distances at the two steps around it, so t_goal is smooth in the
parameters while the vehicle gets there, of second order in the step, and exact for a straight path to the goal. It
jumps to T where the vehicle just misses the circle or sphere of radius R: no gradient leads across.
Source: Srikanthakumar, chapter 8, asks for several criteria at once; the definition is Clearance's own.
Limits: a passage shorter than a step is missed; T means "not in time", whatever distance is left; needs a goal with a
position.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Criterion, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.vectors import difference, norm


class TimeToGoal(NamedTuple):
    radius: Annotated[float, Parameter("m", "Radius in which the goal counts as reached", 1e-6, 1e6, symbol="R")] = 1.0


@kernel
def sample(t: float, q: Any, v: Any, x: Any, u: Any, goal: Any, p: TimeToGoal) -> tuple[float]:
    return (norm(difference(q, goal)) - p.radius,)


@kernel
def value(first: Any, p: TimeToGoal) -> float:
    return first[0]  # type: ignore[no-any-return]


component = Criterion(
    name="time_to_goal",
    title="Time to goal",
    quantity="t_goal",
    unit="s",
    parameters=TimeToGoal,
    sample={2: sample, 3: sample},
    value=value,
    worse="high",
    of="goal",
    over="crossing",
)
