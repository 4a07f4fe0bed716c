"""What is measured of a certified region: its part of the simulated one, and how far the model is from the loop."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from campaigns.certificates.polynomials import Polynomial
from campaigns.certificates.rays import ANGLES, EVERY, Floats, all_around, directions, drawn
from worker.engine.attraction.iteration import values
from worker.engine.attraction.region import Region
from worker.engine.attraction.simulated import Simulation


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
