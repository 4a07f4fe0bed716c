"""NLopt: any of its global methods without gradients, by name.

Johnson, The NLopt nonlinear-optimization package (2007): crs2_lm, controlled random search (Kaelo and Ali 2006);
isres, an evolution strategy (Runarsson and Yao 2005); esch, another (da Silva Santos 2010); ags, space-filling curves
(Sergeyev and Markin 1995), up to 10 parameters; direct and its variants, besides the project's own. The library
requests one point at a time, so batch simulators are used poorly.
It may end by itself; see the papers for its guarantees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import nlopt
from pydantic import Field

from worker.engine.search.base import Ended, Method, MethodLook, Search, Space
from worker.engine.search.parts.nlopt_calls import optimised

DIVIDES = (
    "direct", "direct_l", "direct_l_rand", "direct_noscal", "direct_l_noscal", "direct_l_rand_noscal",
    "orig_direct", "orig_direct_l",
)  # fmt: skip
FAMILIES = {"crs2_lm": "population", "isres": "population", "esch": "population", "ags": "space-filling curve"}
RANDOM = ("crs2_lm", "isres", "esch", "direct_l_rand", "direct_l_rand_noscal")
"""Those that draw random numbers, all that a thread runs from one stream."""
AGS_PARAMETERS = 10
"""The largest number of parameters that NLopt is built with for ags."""


@dataclass(frozen=True)
class Options:
    """The algorithm by NLopt's name for it, without GN_ and in small letters."""

    algorithm: Annotated[
        Literal[
            "crs2_lm", "isres", "esch", "ags", "direct", "direct_l", "direct_l_rand", "direct_noscal",
            "direct_l_noscal", "direct_l_rand_noscal", "orig_direct", "orig_direct_l",
        ],
        Field(description="NLopt's global method"),
    ] = "crs2_lm"  # fmt: skip
    population: Annotated[int, Field(ge=0, le=100_000, description="Of crs2_lm, isres and esch; 0: NLopt's own")] = 0
    tolerance: Annotated[
        float, Field(ge=0, le=0.1, description="Stop at this step, as a fraction of each range; 0: never")
    ] = 1e-10


def search(space: Space, options: Options) -> Search:
    """One point is one request."""
    if options.algorithm == "ags" and space.dimension > AGS_PARAMETERS:
        return Ended(
            "unsuited",
            "ags takes at most {most} parameters, this campaign has {parameters}: choose another",
            most=AGS_PARAMETERS,
            parameters=space.dimension,
        )

    def build() -> Any:
        optimiser = nlopt.opt(getattr(nlopt, f"GN_{options.algorithm.upper()}"), space.dimension)
        optimiser.set_xtol_abs(options.tolerance)
        optimiser.set_population(options.population)
        return optimiser

    return (yield from optimised(space, build, random=options.algorithm in RANDOM))


method = Method(
    name="nlopt_global",
    title="NLopt",
    kind="global",
    how="Global methods of a library, one point at a time",
    source="Johnson 2007",
    evaluations=2000,
    options=Options,
    search=search,
    family="library",
    families={"algorithm": {**FAMILIES, **dict.fromkeys(DIVIDES, "division of the box")}},
    most_parameters={"algorithm": {"ags": AGS_PARAMETERS}},
    parallel="one point",
    suits="comparison with published results",
    drawback="Of the targets of BBOB in 5 dimensions it reaches 0.55 at 1,000 n, CMA-ES 0.68",
    look=MethodLook(colour="#5d7d1f", dark="#9fd15f", marker="plus"),
)
