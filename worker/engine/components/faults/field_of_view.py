"""Limited field of view: an obstacle is seen only while its centre is within a cone about the vehicle's axis.

    seen  when  (c - q) . a >= |c - q| cos(alpha)

c is the obstacle's centre, q the vehicle's own estimated position, a its longitudinal axis (cos(theta) cos(psi),
cos(theta) sin(psi), -sin(theta)) with estimated heading psi and pitch theta, alpha the half angle of the cone:
pi covers all directions. In the plane the cone is a sector. An obstacle that leaves the view is forgotten; how much of
a large obstacle is in view does not matter. The sign of the pitch is that of a frame with z down (NED).
Source: Srikanthakumar, step 3 of section 1.3; chapter 2 names limited visibility among the constraints of sensing.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import PI, kernel, norm2, sincos
from worker.engine.kernels.views import Sight


class FieldOfView(NamedTuple):
    alpha: Annotated[float, Parameter("rad", "Half angle of the cone", 0.0, PI, symbol="α")] = PI


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: FieldOfView) -> Sight:
    x = body.x - own[0]
    y = body.y - own[1]
    z = body.z - own[2]
    s_pitch, c_pitch = sincos(own[4])
    s, c = sincos(own[5])
    along = c_pitch * (c * x + s * y) - s_pitch * z
    _, edge = sincos(p.alpha)
    r = norm2(norm2(x, y), z)
    hidden = along < r * edge - 1e-9 * r
    return Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 if hidden else 1.0)


component = Fault(
    name="field_of_view", title="Limited field of view", path="perception", parameters=FieldOfView, kernel=see
)
