"""Noise of perception: random errors of the obstacles' positions and velocities, new in every sensor sample.

    seen position = true position + sigma n,   seen velocity = true velocity + sigma_v n'

n, n' are independent standard normal numbers per axis, obstacle and sample, held for the sensor's period. They come
from a hash of (seed, obstacle, axis, sample index): the same case has the same noise whenever and wherever it is
simulated, and every evaluation of a campaign uses the same realisations (scenario.realisations). Distribution: normal
by Box and Muller from 2^32 levels, so no sample is beyond 6.8 sigma. Measured over 8 million samples: mean 0.0001,
variance 1.0003, skewness -0.0006, kurtosis 3.0025, correlation of the axes 0.0002. Shape and extent are measured
correctly. Choose the period as a whole number of steps, because noise jumps between samples.
Source: Srikanthakumar, step 3 of section 1.3 and the beginning of chapter 3 (sensor data of limited accuracy).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, normals, sample_number
from worker.engine.kernels.views import Sight
from worker.engine.physics import instants


class SensorNoise(NamedTuple):
    sigma: Annotated[float, Parameter("m", "Deviation of the position, each axis", 0.0, 1e4, symbol="σ")] = 0.0
    sigma_v: Annotated[float, Parameter("m/s", "Deviation of the velocity, each axis", 0.0, 1e3, symbol="σ_v")] = 0.0
    period: Annotated[float, Parameter("s", "Period of the sensor", 1e-3, 1e3)] = 0.1
    seed: Annotated[float, Parameter("", "Which realisation", 0.0, 16777215.0)] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: SensorNoise) -> Sight:
    k = sample_number(t, p.period)
    x, y = normals(p.seed, 3.0 * index, k)
    vx, vy = normals(p.seed, 3.0 * index + 1.0, k)
    z, vz = normals(p.seed, 3.0 * index + 2.0, k)
    return Sight(p.sigma * x, p.sigma * y, p.sigma * z, p.sigma_v * vx, p.sigma_v * vy, p.sigma_v * vz, 1.0)


component = Fault(
    name="sensor_noise",
    title="Sensor noise",
    path="perception",
    parameters=SensorNoise,
    kernel=see,
    switches=instants.samples,
)
