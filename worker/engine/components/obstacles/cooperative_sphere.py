"""Sphere that gives way: flies to its goal and resolves a conflict with the vehicle at their point of closest approach.

    dc/dt = v,   dv/dt = (U - v) / T

U is the velocity towards its goal, of `speed` and, near the goal, k_goal times the distance; in a conflict
the one from vector sharing (worker/engine/physics/closest.py), with the vehicle's true position and velocity. With
sharing = 0 it makes the whole manoeuvre, with 1 its fraction by the rule; with clearance = 0 it never gives way.
It ignores other obstacles. T is a first-order lag; there is no minimum turn radius.
Source: Park, Oh and Tahk (2008); Srikanthakumar, equations 2.17 to 2.20.
"""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.obstacles import cooperative_circle
from worker.engine.kernels.component import ObstacleLook
from worker.engine.kernels.parameters import in_space

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
