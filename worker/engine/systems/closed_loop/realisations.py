"""Noise realisations of a campaign: every evaluation simulates each seed, and the worst or the mean cost counts.

A random component takes its noise from a hash of its parameter `seed`. A simulation sets this parameter to a number
that combines the realisation's seed, the component's index in the scenario and its own seed, so that all are distinct.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.spec import MAX_SEED
from campaigns.asked.spec import Realisations as Asked
from campaigns.checked.check import SEED
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.results.draws import combined
from worker.engine.kernels.layout import Section
from worker.engine.search.base import Batch
from worker.engine.systems.base import Floats, Realised, Seeds

OWN = 2.0**24
INDEX = 2.0**8
"""Numbers of distinct own seeds and component indices; their product with MAX_SEED stays below 2^52."""

assert OWN * INDEX * MAX_SEED <= 2.0**52


@dataclass(frozen=True)
class Realisations(Realised):
    """Seeds, how their costs combine, and the index in the flat vector of each random component's seed."""

    seed_indices: tuple[int, ...] = ()

    @classmethod
    def of(cls, stated: Asked, sections: Sequence[Section]) -> Realisations:
        """The realisations of a campaign with these parameter sections."""
        indices = [
            section.first + k
            for section in sections
            for k, parameter in enumerate(section.parameters)
            if parameter.name == SEED and section.prefix.startswith(("environment.", "faults."))
        ]
        return cls(tuple(stated.seeds), stated.combine, bool(indices), tuple(indices))

    def flights(self, vectors: Floats) -> Floats:
        """The vectors (k m, size) to simulate for m evaluations with vectors (m, size), grouped by seed."""
        if not self.seed_indices:
            return vectors if not self.several else np.concatenate([vectors] * len(self.seeds))
        return np.concatenate([self.flight(vectors, seed) for seed in self.seeds])

    def flight(self, vectors: Floats, seed: int | Seeds) -> Floats:
        """The vectors (m, size) under one realisation, or each under its own: seeds (m,)."""
        realised = vectors.copy()
        for number, index in enumerate(self.seed_indices):
            own = np.clip(np.floor(vectors[:, index]), 0.0, OWN - 1.0)
            seeds = np.full(len(vectors), seed, dtype=np.int64)
            exact = (seeds.astype(np.float64) * INDEX + number) * OWN + own
            wide = seeds >= MAX_SEED  # those of a sample of any size; the product would not be exact
            realised[:, index] = np.where(wide, combined(seeds, number, own), exact) if wide.any() else exact
        return realised

    def only(self, seed: int) -> Realisations:
        """The realisations reduced to a single one."""
        return replace(self, seeds=(seed,), combine="worst")

    def combined(self, costs: Floats, status: NDArray[np.uint8], reasons: Mapping[int, str]) -> tuple[Batch, Any]:
        """The batch of m evaluations, with reasons, from s realisations' costs (s m, k), status (s m,) and reasons.

        Each criterion is combined separately: the worst values may come from different realisations. An evaluation is
        ok if all its realisations are; otherwise its reason is that of the first failed or excluded one.
        """
        if not self.several:
            return Batch(costs, status), dict(reasons)
        states = status.reshape(len(self.seeds), -1)
        table = costs.reshape(*states.shape, -1)
        bad = states != OK
        first = np.argmax(np.where(states == EXCLUDED, 1, 2) * bad, axis=0)
        one = np.arange(states.shape[1])
        joined = np.where(bad.any(axis=0), states[first, one], OK).astype(np.uint8)
        value = table.min(axis=0) if self.combine == "worst" else table.mean(axis=0)
        whys = {
            int(i): f"with seed {self.seeds[first[i]]}: {reasons[int(first[i] * len(one) + i)]}"
            for i in np.flatnonzero(joined != OK)
        }
        return Batch(np.where((joined == OK)[:, None], value, np.nan), joined), whys

    def counting(self, costs: Floats, status: NDArray[np.uint8]) -> list[int]:
        """The seed of the worst realisation of each of m evaluations, from costs (s m, k) and status (s m,)."""
        if not self.several:
            return [self.seeds[0]] * len(status)
        states = status.reshape(len(self.seeds), -1)
        return [self.seeds[i] for i in _shown(costs.reshape(*states.shape, -1)[..., 0], states)]

    def worst(self, costs: Floats, status: NDArray[np.uint8]) -> int:
        """The index of the realisation to show for one evaluation: the first failed one, else the lowest cost.

        costs (s, k), of which only the deciding criterion counts; status (s,).
        """
        return int(_shown(costs[:, :1], status[:, None])[0])


def _shown(costs: Floats, status: NDArray[np.uint8]) -> NDArray[np.intp]:
    """The index of the first failed realisation, else of the lowest cost, from (s, m) each."""
    failed = status == FAILED
    lowest = np.argmin(np.where(status == OK, costs, np.inf), axis=0)
    shown: NDArray[np.intp] = np.where(failed.any(axis=0), np.argmax(failed, axis=0), lowest)
    return shown
