"""Delay of guidance: the avoider's demand takes effect some guidance periods after the sample it was computed from.

    demand(t) = (1 - s) D[k - n] + s D[k - n - 1],   n + s = periods,  n whole,  0 <= s < 1

D[k] is the demand of the latest sample before t. Exact for whole periods; between them it is interpolated linearly
(first-order Lagrange fractional delay: Laakso et al., IEEE Signal Processing Magazine 13, 1996), so that the cost is
continuous in the delay. Before the first demand takes effect, it also stands for all earlier ones. Only
for sampled guidance; several delays add up, to 4 periods at most. The inner loops are not delayed: `control_delay` does
that.
Source: Srikanthakumar, step 3 of section 1.3 (hardware: computing delays).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.guidance import KEPT
from worker.engine.kernels.maths import kernel


class GuidanceDelay(NamedTuple):
    periods: Annotated[float, Parameter("", "Delay in guidance periods", 0.0, float(KEPT))] = 0.0


@kernel
def wait(p: GuidanceDelay) -> float:
    return p.periods


component = Fault(
    name="guidance_delay", title="Delay of guidance", path="guidance", parameters=GuidanceDelay, kernel=wait
)
