"""The search for modes not known: from violations that no known mode explains, and by descents away from known ones.

Draws of two and three deviations meet a half-space in any dimension: Bucher, Asymptotic sampling for high-dimensional
reliability analysis (Probabilistic Engineering Mechanics 24, 2009). Descents that lead to a known design point end: Der
Kiureghian and Dakessian, Multiple design points in first and second-order reliability (Structural Safety 20, 1998).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from worker.engine.rare import design
from worker.engine.rare.evaluated import Allowance, Asking, Evaluated, Floats, evaluated
from worker.engine.rare.explained import explained
from worker.engine.rare.known import Known

DEVIATIONS = (2.0, 3.0)
DESCENTS, DESCENT_STEPS = 8, 3
DESCENT = np.array([0.5, 1.0, 1.5])
"""Parts of the step towards the projection at which a descent evaluates."""
SAME = 0.95
"""Cosine of the angle within which a descent leads to a known design point."""


def searched(
    sample: Evaluated, known: Known, random: np.random.Generator, allowed: Allowance, draws: int, keep: int
) -> Asking[int]:
    """Adds the modes found until `keep` evaluations are left; the number of violations left without explanation.

    It begins with a sample of the nominal density and as many `draws` of each larger deviation.
    """
    n = sample.points.shape[1]
    for deviation in DEVIATIONS:
        wide = yield from evaluated(deviation * random.standard_normal((draws, n)), allowed)
        sample = sample.then(wide)
    violations = _nearest_first(sample.where(sample.violates))
    left = yield from explained(violations, known, allowed, keep, origins=False)
    safe = sample.where(~sample.violates & ~sample.excluded)
    waiting = _order(safe, known)
    each = (1 + n + len(DESCENT)) * DESCENT_STEPS
    while len(waiting) and not left:
        count = min(DESCENTS, (allowed.left - keep - design.cost(n)) // each)
        if count < 1:
            break
        reached = yield from _descended(safe.where(waiting[:count]), known, allowed)
        waiting = waiting[count:]
        left = yield from explained(_nearest_first(reached), known, allowed, keep, origins=False)
    return left


def _order(safe: Evaluated, known: Known) -> NDArray[np.int64]:
    """The order in which descents start: in turns the lowest costs, and the lowest ones against what the known modes
    predict."""
    lowest = np.argsort(safe.margins, kind="stable")
    unexpected = np.argsort(safe.margins - known.expected(safe.points), kind="stable")
    turns = np.column_stack([lowest, unexpected]).ravel()
    return turns[np.sort(np.unique(turns, return_index=True)[1])]


def _nearest_first(seen: Evaluated) -> Floats:
    return seen.points[np.argsort(np.linalg.norm(seen.points, axis=1))]


def _descended(starts: Evaluated, known: Known, allowed: Allowance) -> Asking[Evaluated]:
    """The violations reached from safe points by steps towards the projections, without those of known modes."""
    here, reached = starts, starts.where(np.zeros(len(starts.points), dtype=bool))
    for _ in range(DESCENT_STEPS):
        if not len(here.points):
            break
        slopes = yield from design.gradients(here, allowed)
        cuts = design.linearised(here, slopes)
        sloping = np.array([cut is not None for cut in cuts])
        targets = np.array([design.target([cut] if cut else [], here.points[i]) for i, cut in enumerate(cuts)])
        near = known.cosines(targets)
        led = sloping & (near.max(axis=1) > SAME)
        np.add.at(known.reached, near[led].argmax(axis=1), 1)
        here, reached = yield from _steps(here.where(sloping & ~led), targets[sloping & ~led], reached, allowed)
    return reached


def _steps(
    here: Evaluated, targets: Floats, reached: Evaluated, allowed: Allowance
) -> Asking[tuple[Evaluated, Evaluated]]:
    """One step of every descent: where the cost fell, and the violations reached so far."""
    way = here.points + DESCENT[:, None, None] * (targets - here.points)
    seen = yield from evaluated(way.reshape(-1, way.shape[2]), allowed)
    ranked = np.where(seen.violates, -np.inf, np.nan_to_num(seen.margins, nan=np.inf)).reshape(len(DESCENT), -1)
    after = seen.where(ranked.argmin(axis=0) * len(here.points) + np.arange(len(here.points)))
    return after.where(~after.violates & (after.margins < here.margins)), reached.then(after.where(after.violates))
