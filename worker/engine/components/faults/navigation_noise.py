"""Navigation noise: random errors of own position, heading and speed, new in every navigation sample.

    believed = true + sigma n,  heading + sigma_psi n',  speed + sigma_u n''

Independent standard normal numbers per quantity and sample, held for the period, from a hash of (seed, quantity,
sample index); distribution and measured moments as in `sensor_noise`. Controller and avoider use the
estimated values. Choose the period as a whole number of steps, because noise jumps between samples.
Source: Srikanthakumar, section 7.5 and step 3 of section 1.3 (tolerances of the air data system).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, normals, sample_number
from worker.engine.kernels.views import Errors
from worker.engine.physics import instants


class NavigationNoise(NamedTuple):
    sigma: Annotated[float, Parameter("m", "Deviation of the own position, each axis", 0.0, 1e4, symbol="σ")] = 0.0
    sigma_psi: Annotated[float, Parameter("rad", "Deviation of the own heading", 0.0, 3.2, symbol="σ_ψ")] = 0.0
    sigma_u: Annotated[float, Parameter("m/s", "Deviation of the own speed", 0.0, 1e3, symbol="σ_u")] = 0.0
    period: Annotated[float, Parameter("s", "Period of navigation", 1e-3, 1e3)] = 0.1
    seed: Annotated[float, Parameter("", "Which realisation", 0.0, 16777215.0)] = 0.0


@kernel
def mistake(t: float, p: NavigationNoise) -> Errors:
    k = sample_number(t, p.period)
    x, y = normals(p.seed, 0.0, k)
    heading, speed = normals(p.seed, 1.0, k)
    z, _ = normals(p.seed, 2.0, k)
    return Errors(p.sigma * x, p.sigma * y, p.sigma * z, p.sigma_psi * heading, p.sigma_u * speed)


component = Fault(
    name="navigation_noise",
    title="Navigation noise",
    path="navigation",
    parameters=NavigationNoise,
    kernel=mistake,
    switches=instants.samples,
)
