"""Obstacles in space with values for everything that must be given."""

from __future__ import annotations

OBSTACLES: dict[str, dict[str, float]] = {
    "cylinder": {"position.x": 150.0, "position.y": 12.0, "position.z": 0.0},
    "box_3d": {"position.x": 260.0, "position.y": -40.0, "position.z": 30.0, "angle": 0.3},
    "waypoint_sphere": {
        "position.x": 300.0, "position.y": 200.0, "position.z": -20.0, "waypoint1.x": 300.0, "waypoint1.y": 0.0,
        "waypoint1.z": 0.0, "waypoint2.x": 400.0, "legs": 2.0,
    },
    "orbiting_sphere": {
        "centre.x": 500.0, "centre.y": 200.0, "centre.z": 0.0, "phase": 1.73, "speed": -20.0, "climb": 0.2,
    },
    "cooperative_sphere": {
        "position.x": 600.0, "position.y": 5.0, "position.z": 0.0, "goal.x": -100.0, "goal.y": 0.0, "goal.z": 0.0,
        "clearance": 30.0,
    },
}  # fmt: skip
