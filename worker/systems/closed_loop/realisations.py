"""The realisations of a campaign: every evaluation flies each of its seeds, and the worst or the mean of them counts.

A random component takes its noise from a hash of its own parameter `seed`; what a flight puts there is one number made
of the campaign's seed, the component's place in the scenario and the seed given to it, so that no two are alike.
Start reading at `Realisations`.
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
from worker.kernels.layout import Section
from worker.search.base import Batch
from worker.systems.base import Floats, Realised, Seeds

OWN = 2.0**24
PLACE = 2.0**8
"""How many seeds of its own, and how many places, are told apart; with MAX_SEED their product stays below 2^52."""

assert OWN * PLACE * MAX_SEED <= 2.0**52


@dataclass(frozen=True)
class Realisations(Realised):
    """Seeds, how their flights combine, and where in the flat vector each random component finds its seed."""

    places: tuple[int, ...] = ()

    @classmethod
    def of(cls, asked: Asked, sections: Sequence[Section]) -> Realisations:
        """The realisations of a campaign whose parameters are laid out in these sections."""
        places = [
            section.first + k
            for section in sections
            for k, parameter in enumerate(section.parameters)
            if parameter.name == SEED and section.prefix.startswith(("environment.", "faults."))
        ]
        return cls(tuple(asked.seeds), asked.combine, bool(places), tuple(places))

    def flights(self, vectors: Floats) -> Floats:
        """The vectors (k m, size) to fly for the vectors (m, size) of m evaluations: all of one seed, then the next."""
        if not self.places:
            return vectors if not self.several else np.concatenate([vectors] * len(self.seeds))
        return np.concatenate([self.flight(vectors, seed) for seed in self.seeds])

    def flight(self, vectors: Floats, seed: int | Seeds) -> Floats:
        """The vectors (m, size) of one realisation, or each of its own: seeds (m,)."""
        flown = vectors.copy()
        for number, place in enumerate(self.places):
            own = np.clip(np.floor(vectors[:, place]), 0.0, OWN - 1.0)
            flown[:, place] = (np.asarray(seed, dtype=np.float64) * PLACE + number) * OWN + own
        return flown

    def only(self, seed: int) -> Realisations:
        """The same components under one realisation alone."""
        return replace(self, seeds=(seed,), combine="worst")

    def combined(self, costs: Floats, status: NDArray[np.uint8], reasons: Mapping[int, str]) -> tuple[Batch, Any]:
        """The batch of m evaluations from their flights' costs (s m, k), status (s m,) and reasons, with its reasons.

        Each criterion is combined by itself: the worst of two may come from different flights. An evaluation is ok when
        all its flights are; otherwise its reason is that of the first that is not.
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
        said = {
            int(i): f"with seed {self.seeds[first[i]]}: {reasons[int(first[i] * len(one) + i)]}"
            for i in np.flatnonzero(joined != OK)
        }
        return Batch(np.where((joined == OK)[:, None], value, np.nan), joined), said

    def counting(self, costs: Floats, status: NDArray[np.uint8]) -> list[int]:
        """The seed of the worst flight of each of m evaluations, from their flights' costs (s m, k), status (s m,)."""
        states = status.reshape(len(self.seeds), -1)
        table = costs.reshape(*states.shape, -1)
        return [self.seeds[self.worst(table[:, i], states[:, i])] for i in range(states.shape[1])]

    def worst(self, costs: Floats, status: NDArray[np.uint8]) -> int:
        """Which of the flights of one evaluation to show: the first that failed, else the lowest cost.

        costs (s, k), of which the criterion that decides counts; status (s,).
        """
        if (status == FAILED).any():
            return int(np.argmax(status == FAILED))
        return int(np.argmin(np.where(status == OK, costs[:, 0], np.inf)))
