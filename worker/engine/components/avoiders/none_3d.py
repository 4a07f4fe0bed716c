"""No avoidance in space: attracted by the goal only, regardless of obstacles.

    F = k_att (goal - q)                          within the distance s of the goal
    F = k_att s (goal - q) / |goal - q|           farther away

Source: Srikanthakumar, equations 2.5 to 2.7 and 3.29, k_att = 2 k_a; the second line is the conic part, whose force
does not grow with the distance. A baseline that shows the encounter without avoidance.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, NamedTuple

from worker.engine.components.avoiders import none
from worker.engine.kernels.component import Parameter
from worker.engine.physics.vectors import SpatialGoal


class Attraction(NamedTuple):
    k_att: Annotated[float, Parameter("N/m", "Attraction per distance to the goal", 0.0, 1e6)] = 1.0
    s: Annotated[float, Parameter("m", "Distance from the goal beyond which the attraction is constant", 1e-3, 1e9)] = (
        1e9
    )


component = replace(none.component, name="none_3d", dimension=3, parameters=Attraction, goal=SpatialGoal)
