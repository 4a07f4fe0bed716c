"""The region from which a loop returns to its trim in simulation, along rays: what a certified region is compared with.

A start counts as returning if it stays within the limits until its distance, in the norm of the linearised loop, has
fallen to 0.3. A ray ends at the first start that does not, of starts farther and farther from the trim. How far the
model is from the loop is measured at points of these rays.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns.certificates.polynomials import Polynomial
from campaigns.certificates.rays import ANGLES, EVERY, INSIDE, Floats, all_around, directions, drawn
from worker.engine.attraction.iteration import as_form, linear, linearised, values
from worker.engine.attraction.region import Region

FALL, TIMES = 0.3, 4.0
"""The fraction of the distance, and the time for it, in time constants of the slowest mode."""
WIDER, MOST, HALVINGS = 1.2, 25, 4
"""The factor between starts, how many, and bisections after them: ends are known to a hundredth."""
Returns = Callable[[Floats, Floats, float, float], NDArray[np.bool_]]


class Simulation:
    """A loop with an attractive origin."""

    def __init__(self, flow: list[Polynomial], returns: Returns) -> None:
        a = linearised(flow)
        scale = _balance(a)
        norm = as_form(linear(a * scale / scale[:, None]), len(flow))
        self._returns, self._norm = returns, norm / np.outer(scale, scale)
        self._seconds = TIMES / -float(np.linalg.eigvals(a).real.max())

    def returning(self, starts: Floats) -> NDArray[np.bool_]:
        return self._returns(starts, self._norm, FALL, self._seconds)

    def radii(self, rays: Floats, certified: Floats) -> Floats:
        """How far along each ray (m, n) starts return, from the certified radius on; infinite where no end was met, and
        less than the certified radius where a start inside does not."""
        low, high = np.full(len(rays), 0.0), np.full(len(rays), np.inf)
        for k in range(MOST):
            going = np.flatnonzero(np.isinf(high))
            radius = certified[going] * INSIDE * WIDER**k
            fine = self.returning(rays[going] * radius[:, None]) if len(going) else np.empty(0, bool)
            low[going[fine]], high[going[~fine]] = radius[fine], radius[~fine]
        ended = np.flatnonzero(np.isfinite(high))
        for _ in range(HALVINGS if len(ended) else 0):
            middle = (low[ended] + high[ended]) / 2.0
            fine = self.returning(rays[ended] * middle[:, None])
            low[ended], high[ended] = np.where(fine, middle, low[ended]), np.where(fine, high[ended], middle)
        return np.where(np.isfinite(high), low, np.inf)


def _balance(a: Floats) -> Floats:
    """Scales of the states by which their ranges along solutions of the linear loop are nearly equal."""
    scale = np.ones(len(a))
    for _ in range(6):
        spread = np.linalg.inv(as_form(linear(a * scale / scale[:, None]), len(a)))
        scale = scale * np.sqrt(np.diag(spread))
        scale /= scale[0]
    return scale


class Measured(NamedTuple):
    """Radii along the rays of the volume and of every section, as simulated."""

    simulated: Floats
    sections: dict[tuple[int, int], Floats]
    points: Floats
    """Deviations at which model and loop are compared: on each ray one inside the region and one at its boundary."""


def measured(region: Region, simulation: Simulation) -> Measured:
    """Simulated along the rays of `drawn`."""
    of = drawn(region.certificate.v, region.matrix)
    matrix, n = np.array([[float(c) for c in row] for row in region.matrix]), len(region.matrix)
    rays = all_around(n) @ matrix.T
    sections, some = {}, directions(2, ANGLES)[::EVERY]
    for (i, k), proved in of.sections.items():
        plane = np.zeros((len(some), n))
        plane[:, [i, k]] = some * np.array(of.reach)[[i, k]]
        sections[i, k] = simulation.radii(plane, proved[::EVERY])
    boundary = rays * of.certified[:, None]
    inside = boundary * np.random.default_rng(1).random((len(rays), 1))
    return Measured(simulation.radii(rays, of.certified), sections, np.concatenate([inside, boundary]))


def difference(flow: list[Polynomial], points: Floats, rates: Floats) -> float:
    """The largest difference of dx/dt from the rates, relative to the largest rate of the same state."""
    model = np.zeros_like(rates)
    for k, p in enumerate(flow):
        model[:, k] = values(p, points)
    largest = np.maximum(np.abs(rates).max(axis=0), 1e-300)
    return float((np.abs(model - rates).max(axis=0) / largest).max())
