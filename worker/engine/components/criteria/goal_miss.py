"""Goal miss: the smallest distance to the goal over the trajectory.

    d_goal = min over t <= T of |q(t) - g|,   0 if the trajectory passes through the goal g; more is worse

The minimum over the trajectory, not the distance at its end: an aircraft cannot stop at its goal, and whether it got
there does not depend on how long the simulation continues. If the vehicle is still under way at the horizon T, the miss
is the remaining distance.
Between steps the minimum is refined by a parabola through three samples of the squared distance, as for the separation:
smooth in the parameters except near 0, where a distance has a corner; halving the step changes it by the integration
error only.
Source: Srikanthakumar, chapter 8, asks for several criteria at once; the definition is the miss distance of guidance.
Limits: needs a goal with a position; an avoider that holds a heading has none.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from worker.engine.kernels.component import Criterion
from worker.engine.kernels.maths import kernel
from worker.engine.physics.space import dot3
from worker.engine.physics.vectors import difference, spatial


class GoalMiss(NamedTuple):
    """No parameters."""


@kernel
def sample(t: float, q: Any, v: Any, x: Any, u: Any, goal: Any, p: GoalMiss) -> tuple[float]:
    away = spatial(difference(q, goal))
    return (dot3(away, away),)


@kernel
def value(lowest: Any, p: GoalMiss) -> float:
    return math.sqrt(lowest[0] if lowest[0] > 0.0 else 0.0)


component = Criterion(
    name="goal_miss",
    title="Goal miss",
    quantity="d_goal",
    unit="m",
    parameters=GoalMiss,
    sample={2: sample, 3: sample},
    value=value,
    worse="high",
    of="goal",
)
