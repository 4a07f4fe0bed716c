"""The coefficients of Dormand and Prince's pair of order 8(5,3), with its dense output of order 7, as SciPy has them.

Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), section II.10. Row 12 of `A` is the step
itself (b), whose slope is the first of the next step; rows 13 to 15 are the additional stages of the dense output.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import DOP853

from worker.engine.systems.base import Floats

STAGES = 12
"""Slopes of one step; the thirteenth is the first of the next."""
ALL = 16
"""Slopes of one step with dense output."""


def _table(*blocks: Floats) -> Floats:
    """The rows of these blocks, each filled up with zeros to `ALL` columns."""
    return np.concatenate([np.pad(block, ((0, 0), (0, ALL - block.shape[1]))) for block in map(np.atleast_2d, blocks)])


C: Floats = np.concatenate([DOP853.C, [1.0], DOP853.C_EXTRA])
"""The fraction of the step at which each slope is evaluated."""

A: Floats = _table(DOP853.A, DOP853.B, DOP853.A_EXTRA)

E5: Floats = _table(DOP853.E5)[0]
"""The step minus the solution of order 5."""

E3: Floats = _table(DOP853.E3)[0]
"""The step minus the solution of order 3."""

D: Floats = DOP853.D.copy()
"""The last four rows of the dense output, per step length."""
