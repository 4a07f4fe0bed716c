"""Detection at the point of closest approach, resolution by vector sharing: `closest_approach` in space."""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.avoiders import closest_approach
from worker.engine.kernels.parameters import in_space, text_in_space
from worker.engine.physics.vectors import SpatialGoal

__doc__ = text_in_space(
    closest_approach.__doc__, "Axes as in flight mechanics: z down, so that right is (-y, x) of the course."
)

ClosestApproach = in_space(closest_approach.ClosestApproach, speed=20.0, clearance=50.0, horizon=30.0)

component = replace(
    closest_approach.component,
    name="closest_approach_3d",
    dimension=3,
    parameters=ClosestApproach,
    goal=SpatialGoal,
    frame="ned",
)
