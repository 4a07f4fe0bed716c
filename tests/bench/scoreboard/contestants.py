"""Who takes part in the score board: the search methods of Clearance, and the peers that are installed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from clearance.testing.searching import Function
from tests.bench.scoreboard.peers import PEERS
from tests.bench.scoreboard.searches import Trace, own_trace, peer_trace
from worker.engine.search.base import Method
from worker.running.catalogue.installed import methods

LIMITS = {"turbo": 500, "nevergrad": 5000, "optuna_tpe": 1000, "optuna_gp": 300}
"""Evaluations beyond which a contestant's own time grows to minutes a run; such a budget is left out for it."""
SHORT = 200
"""Evaluations per parameter up to which costly methods take part."""
AT_FIRST = {"auto"}
"""Methods that are costly for their first evaluations only, and take every budget."""


@dataclass(frozen=True)
class Contestant:
    """A method of ours or a peer, with options of a method other than the default ones."""

    name: str
    options: Mapping[str, object] = field(default_factory=dict)

    @property
    def plans(self) -> bool:
        """Whether its points depend on its budget, so that every budget is a run of its own."""
        library = PEERS.get(self.name)
        return library.plans if library else self._method.extend is None

    @property
    def title(self) -> str:
        """Its name on the page."""
        library = PEERS.get(self.name)
        return library.title if library else self._method.title

    def takes(self, evaluations: int, dimension: int) -> bool:
        """Whether it takes part at this budget."""
        short = self.name not in PEERS and self._method.costly and self.name not in AT_FIRST
        return evaluations <= LIMITS.get(self.name, evaluations) and not (short and evaluations > SHORT * dimension)

    def trace(self, function: Function, dimension: int, budget: int, seed: int, stop: float = -np.inf) -> Trace:
        """One run, until a value is at or below `stop`."""
        library = PEERS.get(self.name)
        if library:
            return peer_trace(library.search, function, dimension, budget, seed, stop)
        return own_trace(self._method, function, dimension, budget, seed, self.options, stop)

    def traces(
        self, function: Function, dimension: int, budgets: Sequence[int], seed: int, stop: float = -np.inf
    ) -> dict[int, Trace]:
        """A run for each budget that it takes; one run for all of them if its points do not depend on the budget."""
        sizes = sorted(size for size in budgets if self.takes(size, dimension))
        if self.plans:
            return {size: self.trace(function, dimension, size, seed, stop) for size in sizes}
        longest = self.trace(function, dimension, sizes[-1], seed, stop) if sizes else None
        return {size: longest for size in sizes if longest is not None}

    @property
    def _method(self) -> Method:
        return methods()[self.name]


def own_names() -> list[str]:
    """The methods of one criterion, cheap ones first."""
    return sorted((m.name for m in methods().values() if m.kind != "multi"), key=lambda n: (methods()[n].costly, n))


def fast(chosen: Iterable[str]) -> list[str]:
    """Those of the contestants that are not slow peers."""
    return [name for name in chosen if name not in PEERS or not PEERS[name].slow]


def names() -> list[str]:
    """All contestants, ours first; peers that are not installed too."""
    return [*own_names(), *PEERS]
