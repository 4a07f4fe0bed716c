"""Confirms simulations by independent means: at half the step, and with the reference integrator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from campaigns.results.base import OK
from worker.engine.systems.base import Comparison, Confirmed, Floats
from worker.engine.systems.closed_loop.flights import Flights


@dataclass(frozen=True)
class Flight:
    """A simulation with the reference integrator: the criterion's value, or None and the reason.

    `reason` also states a coarse tolerance.
    """

    cost: float | None
    reason: str = ""


class Integrator(Protocol):
    """The reference integrator of one closed loop. It is injected, because it is built on top of this package."""

    name: str

    def simulate_all(
        self, vectors: Floats, cancelled: Callable[[], bool], counts: Sequence[int | None] | None
    ) -> Sequence[Flight]:
        """Simulate vectors (m, size); counts: each vector's deciding seed, if known. Fewer results if cancelled."""


Integrating = Callable[[Flights], Integrator]


def confirmed(
    flights: Flights,
    integrating: Integrating,
    vectors: Floats,
    seeds: Sequence[int | None],
    cancelled: Callable[[], bool],
) -> list[Confirmed]:
    """Every vector at the campaign's step, at half of it and with the reference integrator; empty if cancelled.

    A vector without a cost at the campaign's step is not given to the reference integrator: it may be too stiff for any
    explicit method.
    """
    step = flights.step
    (full, counts), (half, _) = (_costs(flights, vectors, seeds, s) for s in (step, step / 2))
    known = [i for i, cost in enumerate(full) if cost is not None]
    own, counting = [seeds[i] for i in known], [counts[i] for i in known]
    found = compared(flights, integrating, vectors[known], own, cancelled, counting)
    if len(found) < len(known):
        return []
    name = integrating(flights).name
    others = dict(zip(known, found, strict=True))
    lost = Comparison("integrator", name, None, "the evaluation failed")
    return [
        Confirmed(cost, (Comparison("half_step", "half the step", half[i], step=step / 2), others.get(i, lost)), step)
        for i, cost in enumerate(full)
    ]


def compared(
    flights: Flights,
    integrating: Integrating,
    vectors: Floats,
    seeds: Sequence[int | None],
    cancelled: Callable[[], bool],
    counts: Sequence[int | None] | None = None,
) -> list[Comparison]:
    """Every vector with the reference integrator; empty if cancelled. counts: as in `Integrator.simulate_all`."""
    counting = [None] * len(vectors) if counts is None else counts
    by_seed: dict[int | None, list[int]] = {}
    for i, seed in enumerate(seeds):
        by_seed.setdefault(seed, []).append(i)
    found: dict[int, Comparison] = {}
    for seed, indices in by_seed.items():
        integrator = integrating(flights.under(seed))
        simulated = integrator.simulate_all(vectors[indices], cancelled, [counting[i] for i in indices])
        if len(simulated) < len(indices):
            return []
        for i, flight in zip(indices, simulated, strict=True):
            found[i] = Comparison("integrator", integrator.name, flight.cost, flight.reason)
    return [found[i] for i in range(len(vectors))]


def _costs(
    flights: Flights, vectors: Floats, seeds: Sequence[int | None], step: float
) -> tuple[list[float | None], list[int | None]]:
    """The cost of every vector at this step [s], None if there is no cost; and the deciding seed, None for a mean."""
    found: list[float | None] = [None] * len(vectors)
    counts = list(seeds)
    for own in (False, True):
        rows = [i for i, seed in enumerate(seeds) if (seed is not None) == own]
        if rows:
            if own:
                drawn = np.array([seeds[i] for i in rows], dtype=np.int64)
                batch, _ = flights.simulate_vectors(vectors[rows], step, drawn)
            else:
                batch, _, worst = flights.simulate_realised(vectors[rows], step)
                for i, seed in zip(rows, worst or (), strict=worst is not None):
                    counts[i] = seed
            for i, cost, status in zip(rows, batch.costs[:, 0], batch.status, strict=True):
                found[i] = float(cost) if status == OK else None
    return found, counts
