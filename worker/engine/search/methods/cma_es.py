"""CMA-ES with restarts: samples from a normal distribution that adapts to the shape of the valley.

Hansen, The CMA evolution strategy: a tutorial (arXiv:1604.00772, 2016), compiled; restarts with twice the population
each time (Auger and Hansen, IPOP, CEC 2005) or, by default, alternating with small ones (Hansen, BIPOP, GECCO 2009; the
first run counts as a small one, as in pycma). A point without a value ranks last in its generation. Global by its
restarts.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from worker.engine.search.base import Batch, Floats, Method, MethodLook, Search, Space
from worker.engine.search.parts.cma import Normal, Strategy, default_population
from worker.engine.search.parts.lowest import Reported


@dataclass(frozen=True)
class Options:
    """Deviations are fractions of each parameter's range."""

    restarts: Annotated[
        Literal["bipop", "ipop"], Field(description="Alternate small and growing populations, or only growing ones")
    ] = "bipop"
    population: Annotated[int, Field(ge=0, le=10_000, description="First population; 0: 4 + 3 ln(n)")] = 0
    deviation: Annotated[float, Field(gt=0, le=1, description="Deviation of the first generation")] = 0.2
    growth: Annotated[float, Field(ge=1, le=10, description="Growth factor of the population at a restart")] = 2.0


def search(space: Space, options: Options) -> Search:
    """One generation is one request; it restarts until the budget ends."""
    return (yield from continued(space, options))


def continued(space: Space, options: Options, first: Normal | None = None) -> Search:
    """Search as `search` does; the first run continues from a distribution if one is given."""
    default = max(options.population or default_population(space.dimension), 4)
    large, spent = default, {"large": 0, "small": 0}
    if first is None:
        spent["small"] += yield from _descend(space, default, options.deviation)
    else:
        spent["small"] += yield from _run(space, Strategy.of(first, default, space.random))
    while True:
        if options.restarts == "bipop" and spent["small"] < spent["large"]:
            share = space.random.random() ** 2
            population = int(default * (0.5 * large / default) ** share)
            deviation = options.deviation * 10.0 ** (-2.0 * space.random.random())
            spent["small"] += yield from _descend(space, max(population, default), deviation, spent["large"] // 2)
        else:
            large = int(np.ceil(large * options.growth))
            spent["large"] += yield from _descend(space, large, options.deviation)


def _descend(space: Space, population: int, deviation: float, most: float = np.inf) -> Generator[Floats, Batch, int]:
    """One run of the strategy from a random point; returns its evaluations."""
    start = space.random.random(space.dimension)
    return (yield from _run(space, Strategy(start, deviation, population, space.random), most))


def _run(space: Space, running: Strategy, most: float = np.inf) -> Generator[Floats, Batch, int]:
    with Reported(space, running.state.mean.copy()) as best:
        best.text = "used its share of the evaluations"
        while best.evaluations < most:
            points = running.ask()
            values = (yield points.copy()).ranked()
            best.see(points, values)
            running.tell(values)
            if running.ending is not None:
                best.text = running.ending
                break
    return best.evaluations


method = Method(
    name="cma_es",
    title="CMA-ES",
    kind="global",
    how="Global by restarts. Adapts to the valley's shape",
    source="Hansen 2016, restarts Hansen 2009",
    evaluations=5000,
    options=Options,
    search=search,
    extend=lambda options, more: options,
    compiles=True,
    family="normal distribution",
    whole_budget=True,
    parallel="a generation",
    suits="curved valleys, some thousand evaluations",
    proposed=3,
    look=MethodLook(colour="#007a6c", dark="#46c9b8", marker="pentagon"),
)
