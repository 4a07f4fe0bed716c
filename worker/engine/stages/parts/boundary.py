"""The distance from nominal to the boundary of a violation: along each parameter, and straight to the worst case.

Every ray is sampled in equal steps; the interval between the last clear evaluation and the first violation is then
bisected. A violation between two samples may be missed; the result states the number of steps. `after` requests all
evaluations around a finding.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from campaigns.claims.stages import surroundings as sentences
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.finding import Boundary, Ray
from campaigns.results.slices import Slices
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.stages.parts import slices
from worker.engine.systems.base import Floats

SAMPLES = 20
"""Steps on every ray."""

TOLERANCE = 1e-5
"""Fraction of each range to which a boundary is located."""


@dataclass
class _Ray:
    """From the nominal point to `end`; the boundary is between the fractions `clear` and `beyond` of the ray."""

    end: Floats
    path: str
    towards: str
    clear: float = 0.0
    beyond: float = np.inf
    cost: float = np.nan


Around = tuple[Slices, Boundary | None]


def after(problem: Problem, point: Floats, cost: float) -> Generator[Floats, Batch, Around]:
    """Slices through a finding and, if it violates, the distances to the boundary, otherwise None."""
    through = yield from slices.slices(problem, point)
    violated = cost <= problem.threshold
    return through, (yield from boundary(problem, point)) if violated else None


def boundary(problem: Problem, worst: Floats) -> Generator[Floats, Batch, Boundary]:
    """Along each parameter alone towards either bound, and along the straight line to the worst case."""
    nominal = np.clip(problem.nominal_point, 0.0, 1.0)
    rays = [*_along(problem, nominal), _Ray(worst, "", "the worst case")]
    fractions = np.arange(1, SAMPLES + 1) / SAMPLES
    points = np.concatenate([nominal[None, :], *(_at(nominal, ray, fractions) for ray in rays)])
    batch = yield points
    beyond = _beyond(batch, problem.threshold)
    if beyond[0]:
        statement = sentences.NOMINAL_BEYOND
        return Boundary(tolerance=TOLERANCE, looks=SAMPLES, rays=[], line=None, statement=statement)
    costs = batch.costs[1:, 0].reshape(len(rays), SAMPLES)
    for ray, hit, values in zip(rays, beyond[1:].reshape(len(rays), SAMPLES), costs, strict=True):
        if hit.any():
            first = int(np.argmax(hit))
            ray.beyond, ray.clear, ray.cost = float(fractions[first]), first / SAMPLES, float(values[first])
    yield from _halved(problem, nominal, [ray for ray in rays if np.isfinite(ray.beyond)])
    return _described(problem, nominal, rays)


def _along(problem: Problem, nominal: Floats) -> list[_Ray]:
    rays = []
    for k, r in enumerate(problem.ranges):
        for towards, bound in (("low", 0.0), ("high", 1.0)):
            if abs(nominal[k] - bound) > TOLERANCE:
                end = nominal.copy()
                end[k] = bound
                rays.append(_Ray(end, r.path, towards))
    return rays


def _at(nominal: Floats, ray: _Ray, fractions: Floats) -> Floats:
    return np.asarray(nominal + fractions[:, None] * (ray.end - nominal))


def _beyond(batch: Batch, threshold: float) -> NDArray[np.bool_]:
    """Violated or failed; an excluded evaluation is neither."""
    known = (batch.status == EXCLUDED) | (batch.status == OK)
    return np.asarray(~known | (batch.costs[:, 0] <= threshold))


def _halved(problem: Problem, nominal: Floats, rays: list[_Ray]) -> Generator[Floats, Batch, None]:
    """Bisect the intervals of all rays, in one batch per step, until each is within tolerance."""
    while wide := [ray for ray in rays if (ray.beyond - ray.clear) * np.abs(ray.end - nominal).max() > TOLERANCE]:
        middles = [(ray.clear + ray.beyond) / 2 for ray in wide]
        batch = yield np.concatenate([_at(nominal, ray, np.array([m])) for ray, m in zip(wide, middles, strict=True)])
        beyond = _beyond(batch, problem.threshold)
        for i, (ray, middle) in enumerate(zip(wide, middles, strict=True)):
            if beyond[i]:
                ray.beyond, ray.cost = middle, float(batch.costs[i, 0])
            else:
                ray.clear = middle


def _described(problem: Problem, nominal: Floats, rays: list[_Ray]) -> Boundary:
    *single, line = [_ray(problem, nominal, ray) for ray in rays]
    hits = [(r.share, problem.symbols[r.path], r.value) for r in single if r.share is not None and r.value is not None]
    nearest = min(hits, key=lambda hit: hit[0], default=None)
    statement = sentences.boundary(SAMPLES, nearest, line.way)
    return Boundary(tolerance=TOLERANCE, looks=SAMPLES, rays=single, line=line, statement=statement)


def _ray(problem: Problem, nominal: Floats, ray: _Ray) -> Ray:
    """The first evaluation beyond the boundary: `share` of the range, `way` along the ray, value, cost (None if it
    failed)."""
    if not np.isfinite(ray.beyond):
        return Ray(path=ray.path, towards=ray.towards)
    point = _at(nominal, ray, np.array([ray.beyond]))[0]
    named, before = problem.named(point), problem.named(nominal)
    failed = not np.isfinite(ray.cost)
    value = named.get(ray.path)
    return Ray(
        path=ray.path,
        towards=ray.towards,
        kind="failure" if failed else "violation",
        way=ray.beyond,
        share=float(np.abs(point - nominal).max()),
        cost=None if failed else ray.cost,
        value=value,
        distance=None if value is None else abs(value - before[ray.path]),
        parameters=named,
    )
