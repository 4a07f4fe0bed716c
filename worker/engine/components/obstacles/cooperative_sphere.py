"""Sphere that gives way: `cooperative_circle` in space."""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.obstacles import cooperative_circle
from worker.engine.kernels.component import ObstacleLook
from worker.engine.kernels.parameters import in_space, text_in_space

__doc__ = text_in_space(cooperative_circle.__doc__)

CooperativeSphere = in_space(
    cooperative_circle.CooperativeCircle, speed=20.0, radius=25.0, clearance=75.0, horizon=30.0, lag=2.0
)

component = replace(
    cooperative_circle.component,
    name="cooperative_sphere",
    title="Sphere that gives way",
    dimension=3,
    parameters=CooperativeSphere,
    states=6,
    frame="ned",
    look=ObstacleLook(shape="sphere", radius="radius", way="goal"),
)
