"""Sphere along waypoints: `waypoint_circle` in space."""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.obstacles import waypoint_circle
from worker.engine.kernels.component import ObstacleLook
from worker.engine.kernels.parameters import in_space, text_in_space

__doc__ = text_in_space(waypoint_circle.__doc__)

WaypointSphere = in_space(waypoint_circle.WaypointCircle, speed=20.0, radius=25.0)

component = replace(
    waypoint_circle.component,
    name="waypoint_sphere",
    title="Sphere, waypoints",
    dimension=3,
    parameters=WaypointSphere,
    look=ObstacleLook(shape="sphere", radius="radius", way="waypoints"),
)
