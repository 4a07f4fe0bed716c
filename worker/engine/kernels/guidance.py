"""Delayed sampled guidance: earlier demands, interpolated linearly between samples."""

from __future__ import annotations

import math
from typing import Any

from worker.engine.kernels.maths import kernel

KEPT = 4
"""Earlier demands stored for delayed guidance: the largest delay in guidance periods, of all faults in sum."""
LATEST = KEPT + 1e-8
"""It with what a sum of delays is off by rounding, and more."""


@kernel
def weight(late: float, samples: float) -> float:
    """The weight of the demand of `samples` samples ago at a delay of `late` samples: linear interpolation in time."""
    w = 1.0 - abs(late - samples)
    return 0.0 if w < 0.0 else w


@kernel
def blended(late: float, new: Any, old: Any) -> Any:
    """The demand `late` samples ago; old holds the four demands before `new`, latest first. NaN if it is not stored."""
    late = late if (late >= 0.0) & (late <= LATEST) else math.nan
    a, b, c, d, e = weight(late, 0.0), weight(late, 1.0), weight(late, 2.0), weight(late, 3.0), weight(late, 4.0)
    if len(new) == 2:
        return (
            a * new[0] + b * old[0] + c * old[2] + d * old[4] + e * old[6],
            a * new[1] + b * old[1] + c * old[3] + d * old[5] + e * old[7],
        )
    return (
        a * new[0] + b * old[0] + c * old[3] + d * old[6] + e * old[9],
        a * new[1] + b * old[1] + c * old[4] + d * old[7] + e * old[10],
        a * new[2] + b * old[2] + c * old[5] + d * old[8] + e * old[11],
    )
