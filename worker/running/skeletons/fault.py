"""My fault: the range to every obstacle is measured too long by a factor and an offset, from an instant on.

    seen distance = (1 + k) d + b,   along the line of sight

With the default parameters it has no effect, as every fault. Other paths are timing, navigation, guidance and actuator:
worker/engine/kernels/component.py, `Fault`.
Source: none, an example; replace this line by your own source. This text is the help page of the component.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, onset
from worker.engine.kernels.views import Sight


class MyFault(NamedTuple):
    scale: Annotated[float, Parameter("", "Error of scale", -0.9, 10.0, symbol="k")] = 0.0
    offset: Annotated[float, Parameter("m", "Offset", -1e3, 1e3, symbol="b")] = 0.0
    at: Annotated[float, Parameter("s", "Start of the fault", 0.0, 1e5)] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: MyFault) -> Sight:
    # The displacement of obstacle number `index` as perceived; own is the measured pose of the vehicle, v its velocity.
    longer = onset(t, p.at, 0.0) * (p.scale * (body.gap + body.radius) + p.offset)
    return Sight(-longer * body.nx, -longer * body.ny, -longer * body.nz, 0.0, 0.0, 0.0, 1.0)


def switches(p: MyFault, horizon: float) -> list[float]:
    # The instants at which it jumps [s], in plain Python: the reference integrator restarts there.
    return [p.at]


component = Fault(
    name="my_fault",
    title="My fault",
    path="perception",
    parameters=MyFault,
    kernel=see,
    switches=switches,
)
