"""Missed detection: in each sample of the sensor an obstacle is missed with a given probability.

    not seen in sample k  when  n_k < P

n_k is uniform on [0, 1) per obstacle and sample, from a hash of (seed, obstacle, sample index); samples are
independent. For the avoider a missed obstacle does not exist; it is not remembered.
Source: Bernoulli losses, as Sinopoli et al., Kalman filtering with intermittent observations (IEEE TAC 49, 2004);
Srikanthakumar, step 3 of section 1.3 asks for sensor failures.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Fault, Parameter
from worker.engine.kernels.maths import kernel, sample_number, uniform
from worker.engine.kernels.views import Sight
from worker.engine.physics import instants


class MissedDetection(NamedTuple):
    probability: Annotated[float, Parameter("", "Probability of missing an obstacle in a sample", 0.0, 1.0, "P")] = 0.0
    period: Annotated[float, Parameter("s", "Period of the sensor", 1e-3, 1e3)] = 0.1
    seed: Annotated[float, Parameter("", "Which realisation", 0.0, 16777215.0)] = 0.0


@kernel
def see(t: float, index: float, own: Any, v: Any, body: Any, p: MissedDetection) -> Sight:
    missed = uniform(p.seed, index, sample_number(t, p.period)) < p.probability
    return Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 if missed else 1.0)


component = Fault(
    name="missed_detection",
    title="Missed detection",
    path="perception",
    parameters=MissedDetection,
    kernel=see,
    switches=instants.samples,
)
