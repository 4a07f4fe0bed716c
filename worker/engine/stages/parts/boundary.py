"""The distance from nominal to the boundary of a violation: along each parameter, and straight to the worst case.

Every ray is sampled in equal steps. The nearest violation among these and all stored evaluations on the ray, or the
nearest failure without one, is then located by bisection towards the evaluation before it. What is between two
evaluations may be missed; the sentence says so. `after` requests all evaluations around a finding.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from campaigns.claims.stages import surroundings as sentences
from campaigns.results.finding import Boundary, Ray
from campaigns.results.slices import Slices
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.stages.parts import slices
from worker.engine.stages.parts.rays import Evaluated, Line
from worker.engine.systems.base import Floats

SAMPLES = 20
"""Steps on every ray."""

TOLERANCE = 1e-5
"""Fraction of each range to which a boundary is located."""


@dataclass
class Located:
    """The rays of one finding as they were evaluated, that to the worst case last; none if nominal is no start."""

    rays: list[Line]

    def described(self, problem: Problem, stored: Iterable[Evaluated] = ()) -> Boundary:
        """The result, in which nothing stored on a ray is nearer; also what was evaluated after its bisection."""
        if not self.rays:
            statement = sentences.NOMINAL_BEYOND
            return Boundary(tolerance=TOLERANCE, looks=SAMPLES, rays=[], line=None, statement=statement)
        known = list(stored)
        for ray in self.rays:
            ray.see_stored(problem, known)
        return _described(problem, self.rays)


Around = tuple[Slices, Located | None]


def after(
    problem: Problem, point: Floats, cost: float, stored: Sequence[Evaluated] = ()
) -> Generator[Floats, Batch, Around]:
    """Slices through a finding and, if it violates, the distances to the boundary, otherwise None."""
    through = yield from slices.slices(problem, point)
    violated = cost <= problem.threshold
    return through, (yield from boundary(problem, point, stored)) if violated else None


def boundary(problem: Problem, worst: Floats, stored: Sequence[Evaluated] = ()) -> Generator[Floats, Batch, Located]:
    """Along each parameter alone towards either bound, and along the straight line to the worst case."""
    nominal = np.clip(problem.nominal_point, 0.0, 1.0)
    rays = [*_along(problem, nominal), Line(nominal, worst, "", "the worst case")]
    fractions = np.arange(1, SAMPLES + 1) / SAMPLES
    points = np.concatenate([nominal[None, :], *(ray.at(fractions) for ray in rays)])
    steps = Evaluated.of(points, (yield points))
    if steps.failed[0] or steps.costs[0] <= problem.threshold:
        return Located([])
    for k, ray in enumerate(rays):
        ray.see(fractions, steps.some(slice(1 + k * SAMPLES, 1 + (k + 1) * SAMPLES)), problem.threshold)
        ray.see_stored(problem, stored)
    yield from _halved(problem, rays)
    return Located(rays)


def _along(problem: Problem, nominal: Floats) -> list[Line]:
    rays = []
    for k, r in enumerate(problem.ranges):
        for towards, bound in (("low", 0.0), ("high", 1.0)):
            if abs(nominal[k] - bound) > TOLERANCE:
                end = nominal.copy()
                end[k] = bound
                rays.append(Line(nominal, end, r.path, towards))
    return rays


def _halved(problem: Problem, rays: Sequence[Line]) -> Generator[Floats, Batch, None]:
    """Bisect the intervals of all rays, in one batch per step, until each is within tolerance."""
    while wide := [ray for ray in rays if np.isfinite(ray.beyond) and ray.width > TOLERANCE]:
        middles = [np.array([(ray.clear + ray.beyond) / 2]) for ray in wide]
        points = np.concatenate([ray.at(middle) for ray, middle in zip(wide, middles, strict=True)])
        seen = Evaluated.of(points, (yield points))
        for k, (ray, middle) in enumerate(zip(wide, middles, strict=True)):
            ray.see(middle, seen.some(slice(k, k + 1)), problem.threshold)


def _described(problem: Problem, rays: Sequence[Line]) -> Boundary:
    *single, line = [_ray(problem, ray) for ray in rays]
    failures = [_at(problem, ray, "failure", ray.broken, ray.failed) for ray in rays if ray.broken is not None]
    violated = _nearest(problem, [ray for ray in single if ray.kind == "violation"])
    crossed = line.way if line.kind == "violation" else None
    statement = sentences.boundary(SAMPLES, violated, crossed, _nearest(problem, failures))
    return Boundary(tolerance=TOLERANCE, looks=SAMPLES, rays=single, line=line, statement=statement)


def _nearest(problem: Problem, rays: list[Ray]) -> sentences.Along | None:
    """The position of the nearest of these, if there is one: along a parameter, or on the line to the worst case."""
    near = min((ray for ray in rays if ray.share is not None), key=lambda ray: ray.share or 0.0, default=None)
    if near is None:
        return None
    if near.value is None:
        return sentences.Along(near.way or 0.0)
    return sentences.Along(near.share or 0.0, problem.symbols[near.path], near.value)


def _ray(problem: Problem, ray: Line) -> Ray:
    """The evaluation at the boundary, with its cost if it violates."""
    if ray.point is None:
        return Ray(path=ray.path, towards=ray.towards)
    found = _at(problem, ray, "violation" if ray.violates else "failure", ray.point, ray.beyond)
    return found.model_copy(update={"cost": ray.cost}) if ray.violates else found


def _at(problem: Problem, ray: Line, kind: Literal["failure", "violation"], point: Floats, way: float) -> Ray:
    """An evaluation on a ray: `share` of the range, `way` along the ray, value."""
    named, before = problem.named(point), problem.named(ray.nominal)
    value = named.get(ray.path)
    return Ray(
        path=ray.path,
        towards=ray.towards,
        kind=kind,
        way=way,
        share=float(np.abs(point - ray.nominal).max()),
        value=value,
        distance=None if value is None else abs(value - before[ray.path]),
        parameters=named,
    )
