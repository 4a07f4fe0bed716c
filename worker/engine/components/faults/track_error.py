"""Track error of perception: an obstacle's speed and the direction of its track are measured with errors.

    seen velocity, horizontally = (1 + du0/|v|) Rot(dpsi0) v

v is the obstacle's horizontal velocity, Rot turns from the x to the y axis (headings of both frames grow that way).
A static obstacle has no track and is detected as static; the vertical velocity is measured correctly.
Source: Srikanthakumar, section 3.3.6 (Vv0 = v_obs + dv, Ppsi0 = psi0 + dpsi) and section 7.5 (u_B, psi_B).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, norm2, sincos
from worker.engine.kernels.views import Sight


class TrackError(NamedTuple):
    du0: Annotated[float, Parameter("m/s", "Error of the obstacle's speed", -1e3, 1e3, symbol="Δu₀")] = 0.0
    dpsi0: Annotated[float, Parameter("rad", "Error of its track angle, from x towards y", -3.2, 3.2, symbol="Δψ₀")] = (
        0.0
    )


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: TrackError) -> Sight:
    s, c = sincos(p.dpsi0)
    x = c * body.vx - s * body.vy
    y = s * body.vx + c * body.vy
    more = p.du0 / (norm2(body.vx, body.vy) + 1e-12)
    return Sight(0.0, 0.0, 0.0, (x - body.vx) + more * x, (y - body.vy) + more * y, 0.0, 1.0)


component = Fault(name="track_error", title="Track error", path="perception", parameters=TrackError, kernel=see)
