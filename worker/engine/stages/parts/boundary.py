"""The distance from nominal to the boundary of a violation: along each parameter, and straight to the worst case.

Every ray is sampled in equal steps; the interval before the first violation is then bisected, or before the first
failure on a ray without a violation. What is between two samples may be missed; the result states the number of steps.
`after` requests all evaluations around a finding.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace

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
    """From the nominal point to `end`; the boundary is between the fractions `clear` and `beyond` of the ray.

    cost: at `beyond`; NaN if no evaluation violates and the boundary is that of a failure. failed: the first fraction
    at which an evaluation failed.
    """

    end: Floats
    path: str
    towards: str
    clear: float = 0.0
    beyond: float = np.inf
    cost: float = np.nan
    failed: float = np.inf

    @property
    def violates(self) -> bool:
        """Whether an evaluation violates: then failures before it are no boundary."""
        return bool(np.isfinite(self.cost))

    def see(self, fraction: float, failed: bool, cost: float, threshold: float) -> None:
        """Narrow the interval by one evaluation inside it."""
        if failed:
            self.failed = min(self.failed, fraction)
        if cost <= threshold or (failed and not self.violates):
            self.beyond, self.cost = fraction, cost
        else:
            self.clear = fraction


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
    costs, failed = batch.costs[:, 0], _failed(batch)
    if failed[0] or costs[0] <= problem.threshold:
        statement = sentences.NOMINAL_BEYOND
        return Boundary(tolerance=TOLERANCE, looks=SAMPLES, rays=[], line=None, statement=statement)
    parts = (values[1:].reshape(len(rays), SAMPLES) for values in (costs, failed))
    for ray, values, without in zip(rays, *parts, strict=True):
        violates = values <= problem.threshold
        if (hit := violates if violates.any() else without).any():
            first = int(np.argmax(hit))
            ray.beyond, ray.clear, ray.cost = float(fractions[first]), first / SAMPLES, float(values[first])
        if without.any():
            ray.failed = float(fractions[np.argmax(without)])
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


def _failed(batch: Batch) -> NDArray[np.bool_]:
    """Which evaluations failed: those without a value that are not excluded."""
    return np.asarray((batch.status != EXCLUDED) & (batch.status != OK))


def _halved(problem: Problem, nominal: Floats, rays: list[_Ray]) -> Generator[Floats, Batch, None]:
    """Bisect the intervals of all rays, in one batch per step, until each is within tolerance."""
    while wide := [ray for ray in rays if (ray.beyond - ray.clear) * np.abs(ray.end - nominal).max() > TOLERANCE]:
        middles = [(ray.clear + ray.beyond) / 2 for ray in wide]
        batch = yield np.concatenate([_at(nominal, ray, np.array([m])) for ray, m in zip(wide, middles, strict=True)])
        for ray, middle, failed, cost in zip(wide, middles, _failed(batch), batch.costs[:, 0], strict=True):
            ray.see(middle, bool(failed), float(cost), problem.threshold)


def _described(problem: Problem, nominal: Floats, rays: list[_Ray]) -> Boundary:
    *single, line = [_ray(problem, nominal, ray) for ray in rays]
    failures = [_ray(problem, nominal, replace(ray, beyond=ray.failed, cost=np.nan)) for ray in rays]
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


def _ray(problem: Problem, nominal: Floats, ray: _Ray) -> Ray:
    """The evaluation at the boundary: `share` of the range, `way` along the ray, value, cost (None if it failed)."""
    if not np.isfinite(ray.beyond):
        return Ray(path=ray.path, towards=ray.towards)
    point = _at(nominal, ray, np.array([ray.beyond]))[0]
    named, before = problem.named(point), problem.named(nominal)
    value = named.get(ray.path)
    return Ray(
        path=ray.path,
        towards=ray.towards,
        kind="violation" if ray.violates else "failure",
        way=ray.beyond,
        share=float(np.abs(point - nominal).max()),
        cost=ray.cost if ray.violates else None,
        value=value,
        distance=None if value is None else abs(value - before[ray.path]),
        parameters=named,
    )
