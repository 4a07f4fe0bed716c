"""Two basins: an analytic separation over two offsets, with two minima, of which one is lower.

No equations of motion: separation = 8 - 5 exp(-|p - a|^2 / 0.02) - 3.5 exp(-|p - b|^2 / 0.02) - 0.2 x, with
a = (0.2, 0.7), b = (0.75, 0.25). Beyond y = 0.98 it has no value.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

from campaigns.catalogue import ParameterEntry, ResultEntry, SimulatorEntry
from campaigns.results.base import FAILED, OK
from worker.engine.search.base import Batch
from worker.engine.systems.base import Floats, Reasons, Seeds
from worker.engine.systems.simulators.declared.simulator import Simulator
from worker.engine.systems.simulators.simulated import Simulated

BROKEN = 0.98

ENTRY = SimulatorEntry(
    name="two_basins",
    title="Two basins",
    text=__doc__ or "",
    parameters=[
        ParameterEntry(name="x", symbol="x", unit="m", low=-1.0, high=2.0, default=0.5, text="Offset along the track"),
        ParameterEntry(name="y", symbol="y", unit="m", low=-1.0, high=2.0, default=0.45, text="Offset across it"),
    ],
    results=[
        ResultEntry(name="separation", title="Separation", quantity="d_sep", unit="m", worse="low", text="A distance"),
        ResultEntry(name="effort", title="Effort", quantity="effort", unit="J", worse="high"),
    ],
)


def separation(x: Floats, y: Floats) -> Floats:
    """[m]"""
    first = 5.0 * np.exp(-((x - 0.2) ** 2 + (y - 0.7) ** 2) / 0.02)
    second = 3.5 * np.exp(-((x - 0.75) ** 2 + (y - 0.25) ** 2) / 0.02)
    return 8.0 - first - second - 0.2 * x


class TwoBasins(Simulated):
    """Evaluates the formula; the digest is that of this file."""

    @property
    def digest(self) -> str:
        return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        x, y = vectors.T
        broken = y > BROKEN
        costs = np.where(broken, np.nan, separation(x, y))[:, None]
        status = np.where(broken, FAILED, OK).astype(np.uint8)
        return Batch(costs, status), {int(i): f"no value for y = {y[i]:g} m" for i in np.flatnonzero(broken)}


simulator = Simulator(ENTRY, lambda opening: TwoBasins(ENTRY, opening))
