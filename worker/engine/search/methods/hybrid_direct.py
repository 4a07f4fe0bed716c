"""Hybrid DIRECT: DIRECT divides the box, then SQP descends from its best point and from its other promising centres.

Jones, Perttunen, Stuckman (1993) and Kraft (1988), joined as H-DIRECT: DIRECT quickly gets near the best valleys but
is slow to reach their minima, above all on a bound, which centres of rectangles never touch; SQP is the opposite.
DIRECT ends by its own rules or when its share of the budget is spent, so a larger budget changes the points: a finished
search cannot be extended. The best centre goes first and alone, the others follow side by side: low ones, far from
anything lower.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from worker.engine.search.base import Batch, Ended, Floats, Method, MethodLook, Parallel, Space
from worker.engine.search.methods import direct, sqp
from worker.engine.search.parts import basins


@dataclass(frozen=True)
class Options(direct.Options):
    """DIRECT's options, its share of the budget, and the settings of the descents."""

    share: Annotated[float, Field(gt=0, le=1, description="DIRECT's largest share of the budget")] = 0.7
    biased: Annotated[bool, Field(description="Divide as DIRECT-L does")] = False
    centres: Annotated[int, Field(ge=1, le=1000, description="Centres to descend from, including the best")] = 5
    differences: Literal["central", "forward"] = "central"
    difference: Annotated[float, Field(gt=0, le=0.1, description="Step of the finite differences")] = 1e-5
    gradients: Annotated[int, Field(ge=1, le=100_000, description="Maximum gradients per descent")] = 200


def search(space: Space, options: Options) -> Parallel:
    boxes = direct.Boxes(space.dimension)
    ending = yield from _divided(boxes, space, options)
    starts = _centres(boxes, options.centres)
    if len(starts) == 0:
        return Ended("no value", "DIRECT: {direct}; no centre had a value", direct=ending)
    settings = sqp.Options(
        differences=options.differences, difference=options.difference, iterations=options.gradients
    )  # fmt: skip
    text = yield from sqp.search(replace(space, starts=starts[:1]), settings)
    if len(starts) > 1:
        yield from sqp.search(replace(space, starts=starts[1:]), settings)
    return Ended(
        "members",
        "DIRECT: {direct}; SQP from {centres} centres, from the best of them: {sqp}",
        direct=ending,
        centres=len(starts),
        sqp=text,
    )


def _divided(boxes: direct.Boxes, space: Space, options: Options) -> Generator[Floats, Batch, str]:
    """DIRECT until it stops or requests more than its share; the first iterations are always completed."""
    dividing, spent = direct.divided(boxes, options, options.biased), 0
    try:
        points = next(dividing)
        while spent + len(points) <= options.share * space.budget or boxes.count <= 1:
            spent += len(points)
            points = dividing.send((yield points))
    except StopIteration as ended:
        rule: str = ended.value
        return rule
    finally:
        dividing.close()
    return Ended("share", "used its share of {evaluations} evaluations", evaluations=spent)


def _centres(boxes: direct.Boxes, at_most: int) -> Floats:
    """The centres to descend from (k, n), the best first."""
    count = boxes.count
    ranked = np.where(boxes.lost[:count], np.inf, boxes.value[:count])
    return boxes.centre[basins.promising(boxes.centre[:count], ranked, at_most)]


method = Method(
    name="hybrid_direct",
    title="Hybrid DIRECT",
    kind="global",
    how="Global, deterministic. Divides the box, then descends",
    source="Jones et al. 1993 and Kraft 1988",
    evaluations=3000,
    options=Options,
    search=search,
    repeats=True,
    family="division of the box",
    parallel="an iteration, then every descent on its own",
    suits="DIRECT's best, refined",
    look=MethodLook(colour="#2b8fcb", dark="#8ccbf2", marker="diamond", short="H-DIRECT"),
)
