"""Checks whether a campaign's step is small enough: simulates random points at the step and at half of it.

A point exceeds the tolerance if both differ by more than the validate stage allows: a fraction of d_min or a tenth of
the margin, whichever is less. A campaign that cannot meet this everywhere states in its notes how often and why, in a
paragraph that begins "Step adequacy: up to 12 of 200 random points exceed the tolerance" (`declared`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from campaigns import Campaign, library, load_file
from campaigns.limits import TOLERANCE_OF_MARGIN
from campaigns.results.base import OK
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.running.opening.opened import closed_loop

POINTS = 200
SEED = 2**21
"""The random stream of these points, distinct from those of the stages."""

DECLARED = re.compile(r"Step adequacy: up to (\d+) of (\d+) random points exceed the tolerance")


@dataclass(frozen=True)
class Adequacy:
    """Differences between simulations at half the step and at the step.

    largest, median: [unit of the criterion]; at: the point of the largest, by path; compared: number of points ok at
    both steps; exceeding: of those beyond the tolerance; differing: number of points ok at one step only; declared:
    fraction of points allowed by the notes.
    """

    campaign: str
    step: float
    points: int
    tolerance: float
    largest: float
    median: float
    at: dict[str, float]
    compared: int
    exceeding: int
    differing: int
    declared: float | None

    @property
    def ok(self) -> bool:
        """Whether points were compared and no more of them exceed the tolerance than the notes allow."""
        return self.compared > 0 and self.exceeding + self.differing <= (self.declared or 0.0) * self.points


def adequacy(name: str, loop: ClosedLoop, points: int = POINTS) -> Adequacy:
    """Simulate random points of the box at the campaign's step and at half of it, on one thread."""
    campaign, problem = loop.campaign, Problem(loop.campaign, loop)
    random = np.random.default_rng(np.random.SeedSequence(campaign.seed, spawn_key=(SEED,)))
    unit = random.random((points, problem.dimension))
    vectors = problem.vectors(unit)
    whole, half = (loop.simulate_vectors(vectors, step)[0] for step in (loop.step, loop.step / 2))
    both = (whole.status == OK) & (half.status == OK)
    costs = whole.costs[:, 0]
    apart = np.where(both, np.abs(half.costs[:, 0] - costs), 0.0)
    worst = int(np.argmax(apart))
    return Adequacy(
        campaign=name,
        step=loop.step,
        points=points,
        tolerance=campaign.stages.validate_.tolerance,
        largest=float(apart[worst]),
        median=float(np.median(apart[both])) if both.any() else 0.0,
        at=problem.named(unit[worst]),
        compared=int(np.count_nonzero(both)),
        exceeding=int(np.count_nonzero(apart > _allowed(problem, costs))),
        differing=int(np.count_nonzero((whole.status == OK) != (half.status == OK))),
        declared=declared(campaign),
    )


def declared(campaign: Campaign) -> float | None:
    """The fraction of random points that may exceed the tolerance according to the notes; None if not stated."""
    found = DECLARED.search(" ".join(campaign.notes.split()))
    return None if found is None else int(found[1]) / int(found[2])


def _allowed(problem: Problem, costs: Floats) -> Floats:
    tolerance = problem.campaign.stages.validate_.tolerance
    return np.minimum(tolerance * np.abs(costs), TOLERANCE_OF_MARGIN * np.abs(costs - problem.threshold))


def of_library() -> list[Adequacy]:
    """Every campaign of the library."""
    return [adequacy(name, closed_loop(load_file(file))) for name, file in library().items()]


def sentence(found: Adequacy) -> str:
    allowed = "" if found.declared is None else f" (its notes allow {100 * found.declared:g} %)"
    apart = f"; {found.differing} succeed at one of the two steps only" if found.differing else ""
    apart += "" if found.compared else "; no point has a value at both"
    return (
        f"{'ok ' if found.ok else 'NOT'} {found.campaign}: at half its step of {found.step:g} s, {found.exceeding} of "
        f"{found.points} random points exceed the tolerance{allowed}{apart}; largest {found.largest:.3g}, "
        f"median {found.median:.2g}"
    )
