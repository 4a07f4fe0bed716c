"""Points of standard normal space with what their evaluation showed."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from campaigns.results.base import EXCLUDED, OK
from worker.engine.search.base import Batch

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
T = TypeVar("T")

Asking = Generator[Floats, Batch, T]
"""Yields points (m, n) of standard normal space, receives their `Batch`, returns what it was for."""


@dataclass(frozen=True)
class Evaluated:
    """Points (m, n), by how much each is above the threshold (NaN where there is no cost), and their status."""

    points: Floats
    margins: Floats
    status: NDArray[np.uint8]

    @property
    def violates(self) -> Bools:
        """A failed evaluation counts as a violation, because its outcome is unknown; an excluded draw does not."""
        return np.asarray((self.margins <= 0.0) | self.failed)

    @property
    def failed(self) -> Bools:
        return np.asarray((self.status != OK) & (self.status != EXCLUDED))

    @property
    def excluded(self) -> Bools:
        return np.asarray(self.status == EXCLUDED)

    def counted(self, inside: Bools) -> Evaluated:
        """The evaluations with no point outside counted as a violation; excluded ones stay excluded."""
        status = np.where(inside | self.excluded, self.status, OK).astype(np.uint8)
        return Evaluated(self.points, np.where(inside, self.margins, np.inf), status)

    def where(self, rows: Bools | NDArray[np.int64]) -> Evaluated:
        return Evaluated(self.points[rows], self.margins[rows], self.status[rows])

    def then(self, further: Evaluated) -> Evaluated:
        return Evaluated(
            np.concatenate([self.points, further.points]),
            np.concatenate([self.margins, further.margins]),
            np.concatenate([self.status, further.status]),
        )


@dataclass
class Allowance:
    """A cost at or below the threshold is a violation; how many evaluations are left."""

    threshold: float
    left: int


def evaluated(points: Floats, allowed: Allowance) -> Asking[Evaluated]:
    """Requests these points; none are not requested at all."""
    if not len(points):
        return Evaluated(points, np.empty(0), np.empty(0, dtype=np.uint8))
    batch = yield points
    allowed.left -= len(points)
    return Evaluated(points, np.where(batch.status == OK, batch.costs[:, 0] - allowed.threshold, np.nan), batch.status)
