"""Monte Carlo: random points from the campaign's distributions, one after another from one stream of numbers.

Metropolis and Ulam, The Monte Carlo method (1949). Guarantees nothing of the worst case; its points are an
independent sample declared before the run, so a statement on P(violation) may rest on them (Clopper and Pearson 1934).
An excluded point is drawn again and counted; a failed one is counted and never replaced.
"""

from __future__ import annotations

from dataclasses import dataclass

from worker.search.base import Method, Search, Space

BLOCK = 4096


@dataclass(frozen=True)
class Options:
    """Plain sampling has nothing to set; its number of samples is the budget."""


def search(space: Space, options: Options) -> Search:
    drawn = 0
    while drawn < space.budget:
        count = min(BLOCK, space.budget - drawn)
        yield space.quantile(space.random.random((count, space.dimension)))
        drawn += count
    return f"drew the {drawn} samples asked for"


method = Method(
    name="monte_carlo",
    title="Monte Carlo",
    kind="random",
    how="Random points, the reference method",
    source="Metropolis and Ulam 1949",
    evaluations=1000,
    options=Options,
    search=search,
)
