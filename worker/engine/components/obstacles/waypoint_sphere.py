"""Sphere along waypoints: from its position via up to four waypoints at constant speed; it stops at the last one.

It turns instantly at a waypoint. It never gives way. `legs` is the number of waypoints used; the
others are ignored. Avoiders keep clear of its radius; `separation` measures distances to its centre.
"""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.obstacles import waypoint_circle
from worker.engine.kernels.component import ObstacleLook
from worker.engine.kernels.parameters import in_space

WaypointSphere = in_space(waypoint_circle.WaypointCircle, speed=20.0, radius=25.0)

component = replace(
    waypoint_circle.component,
    name="waypoint_sphere",
    title="Sphere, waypoints",
    dimension=3,
    parameters=WaypointSphere,
    look=ObstacleLook(shape="sphere", radius="radius", way="waypoints"),
)
