"""DIRECT-L: DIRECT with a bias towards the neighbourhood of its best point.

Gablonsky, Kelley, A locally-biased form of the DIRECT algorithm (J. Global Optim. 21, 2001): a rectangle's size is its
longest side, which gives fewer distinct sizes, and one rectangle per size is divided, the oldest of ties. Faster if
there are few local minima; otherwise as `direct`, on which it is based.
"""

from __future__ import annotations

from functools import partial

from campaigns.effort import Iterations
from worker.engine.search.base import Method, MethodLook, Search, Space
from worker.engine.search.methods import direct
from worker.engine.search.methods.direct import Options, extend

divide = partial(direct.divide, biased=True)


def search(space: Space, options: Options) -> Search:
    """One iteration is one request, as in `direct`."""
    return divide(space.dimension, options)[1]


method = Method(
    name="direct_l",
    title="DIRECT-L",
    kind="global",
    how="Global, deterministic. Divides the box near the best point",
    source="Gablonsky, Kelley 2001",
    evaluations=2000,
    options=Options,
    search=search,
    extend=extend,
    family="division of the box",
    whole_budget=True,
    effort=Iterations("iterations", each=2.5, growth=0.1, spread=(0.2, 18.0)),  # of 1 to 300, on up to 8 parameters
    parallel="an iteration",
    suits="few valleys, few parameters",
    divide=divide,
    look=MethodLook(colour="#003e6b", dark="#6f8fb4", marker="box"),
)
