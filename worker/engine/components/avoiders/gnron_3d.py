"""Potential field in space whose goal stays reachable next to an obstacle (GNRON): `gnron` in space."""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.avoiders import gnron
from worker.engine.kernels.parameters import text_in_space
from worker.engine.physics.vectors import SpatialGoal

__doc__ = text_in_space(gnron.__doc__)

component = replace(gnron.component, name="gnron_3d", dimension=3, goal=SpatialGoal)
