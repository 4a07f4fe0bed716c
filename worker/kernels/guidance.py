"""Sampled guidance that comes late: the demand of earlier samples, interpolated between two of them.

Start reading at `blended2`.
"""

from __future__ import annotations

from typing import Any

from worker.kernels.maths import clip, kernel

KEPT = 4
"""How many earlier demands are kept for guidance that comes late: the most periods by which it can."""


@kernel
def share(late: float, samples: float) -> float:
    """The weight of the demand of so many samples ago: linear interpolation in time."""
    weight = 1.0 - abs(clip(late, 0.0, float(KEPT)) - samples)
    return 0.0 if weight < 0.0 else weight


@kernel
def blended2(late: float, new: Any, old: Any) -> tuple[float, float]:
    """The demand in the plane as of `late` samples ago; old holds the four before the newest, latest first."""
    a, b, c, d, e = share(late, 0.0), share(late, 1.0), share(late, 2.0), share(late, 3.0), share(late, 4.0)
    return (
        a * new[0] + b * old[0] + c * old[2] + d * old[4] + e * old[6],
        a * new[1] + b * old[1] + c * old[3] + d * old[5] + e * old[7],
    )


@kernel
def blended3(late: float, new: Any, old: Any) -> tuple[float, float, float]:
    """The demand in space as of `late` samples ago; old holds the four before the newest, latest first."""
    a, b, c, d, e = share(late, 0.0), share(late, 1.0), share(late, 2.0), share(late, 3.0), share(late, 4.0)
    return (
        a * new[0] + b * old[0] + c * old[3] + d * old[6] + e * old[9],
        a * new[1] + b * old[1] + c * old[4] + d * old[7] + e * old[10],
        a * new[2] + b * old[2] + c * old[5] + d * old[8] + e * old[11],
    )
