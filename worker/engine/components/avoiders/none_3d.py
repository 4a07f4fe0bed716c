"""No avoidance in space: attracted by the goal only, as `none` in the plane."""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.avoiders import none
from worker.engine.kernels.parameters import text_in_space
from worker.engine.physics.vectors import SpatialGoal

__doc__ = text_in_space(none.__doc__)


component = replace(none.component, name="none_3d", dimension=3, goal=SpatialGoal)
