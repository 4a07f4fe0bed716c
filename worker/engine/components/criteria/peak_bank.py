"""Peak bank: the largest bank angle of an aircraft over the trajectory, to either side.

    phi_peak = max over t <= T of |phi(t)|,   phi the roll angle of the Euler angles; more is worse

Between steps the maximum is refined by a parabola through three samples: the roll angle is the integral of a rate, so
its peaks are smooth, and so is the value in the parameters, except where two peaks are equally high. Halving the step
changes it by the integration error only.
Source: Srikanthakumar, chapter 8, asks for several criteria at once; the definition is the usual one.
Limits: only for vehicles in space; the aircraft's own envelope ends a flight at 2 rad.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from worker.engine.kernels.component import Criterion
from worker.engine.kernels.maths import kernel


class PeakBank(NamedTuple):
    """No parameters."""


@kernel
def sample(t: float, q: Any, v: Any, x: Any, u: Any, pose: Any, p: PeakBank) -> tuple[float]:
    return (-abs(pose[3]),)


@kernel
def value(lowest: Any, p: PeakBank) -> float:
    return -lowest[0]  # type: ignore[no-any-return]


component = Criterion(
    name="peak_bank",
    title="Peak bank",
    quantity="φ_peak",
    unit="rad",
    parameters=PeakBank,
    sample={3: sample},
    value=value,
    worse="high",
    of="flight",
)
