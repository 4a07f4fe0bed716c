"""A problem of the bench: costs in standard normal space, of which those at or below zero are violations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Mode:
    """One mode of a problem: its probability, a point that violates by it, and by how much points do (<= 0)."""

    probability: float
    start: Floats
    limit: Callable[[Floats], Floats]


@dataclass(frozen=True)
class Problem:
    """A limit state with its probability; `published` is what its source states, `half` what it is used for.

    `modes` are those of a generated problem, without overlaps; a public problem has none: a search finds its starts.
    """

    name: str
    dimension: int
    costs: Callable[[Floats], Floats]
    probability: float
    half: str
    published: float | None = None
    source: str = ""
    modes: tuple[Mode, ...] = ()
