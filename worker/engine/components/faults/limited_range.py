"""Limited range: an obstacle is seen only while its surface is within the sensor's range.

    seen  when  gap <= range

gap is the distance from the vehicle's own estimated position to the obstacle's surface. An obstacle that leaves the
range is forgotten.
Source: Srikanthakumar, step 3 of section 1.3; chapter 2 names limited range among the constraints of sensing.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Sight


class LimitedRange(NamedTuple):
    range: Annotated[float, Parameter("m", "Largest distance to the surface at which it is detected", 0.0, 1e7)] = 1e7


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: LimitedRange) -> Sight:
    return Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 if body.gap > p.range else 1.0)


component = Fault(name="limited_range", title="Limited range", path="perception", parameters=LimitedRange, kernel=see)
