"""The possible improvement below DIRECT's best: an estimate from the observed slopes.

Jones, Perttunen, Stuckman (JOTA 79, 1993), section 2, Shubert's bound in several dimensions: a function that changes
along each parameter no faster than L_i is at least f(centre) - sum L_i side_i / 2 in a rectangle. The true L_i are
unknown; the largest slopes between neighbouring centres are used instead.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns.claims.stages.surroundings import possible_gain
from campaigns.results.search import Gap
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch, Floats, Method, Search

DIGITS = 12
"""Decimals by which centres are distinguished, enough for sides of 3^-24."""


def estimate(problem: Problem, method: Method, options: Any, columns: Columns) -> Gap | None:
    """The estimate from these stored evaluations; None if the method has no rectangles or none has a value, or if an
    evaluation beside a rectangle without a value is lower."""
    if method.divide is None:
        return None
    boxes, search = method.divide(columns.points.shape[1], options)
    slopes = _replayed(search, columns)
    kept = ~boxes.lost[: boxes.count]
    if not kept.any():
        return None
    half = 0.5 * 3.0 ** -boxes.depth[: boxes.count][kept].astype(np.float64)
    lowest = float((boxes.value[: boxes.count][kept] - half @ slopes).min())
    best = float(columns.ranked().min())
    if best < lowest:
        return None
    lost = int(np.count_nonzero(~kept))
    return Gap(
        rectangles=boxes.count,
        without_value=lost,
        slopes={r.path: float(s) / (r.high - r.low) for r, s in zip(problem.ranges, slopes, strict=True)},
        lower_bound=lowest,
        gap=best - lowest,
        statement=possible_gain(boxes.count, lost, problem.quantity, lowest, best, problem.unit),
    )


def _replayed(search: Search, columns: Columns) -> Floats:
    """Replay the search up to its last complete iteration; the largest slope observed along each side of the cube, also
    by the evaluations of an incomplete one."""
    known: dict[bytes, float] = {}
    slopes = np.zeros(columns.points.shape[1])
    points, done = next(search), 0
    try:
        while done < len(columns.status):
            batch = Batch(columns.costs[done : done + len(points)], columns.status[done : done + len(points)])
            done += len(points)
            values, ranked = np.full(len(points), np.nan), batch.ranked()
            values[: len(ranked)] = np.where(np.isfinite(ranked), ranked, np.nan)
            known |= {key.tobytes(): float(v) for key, v in zip(_keys(points), values, strict=True)}
            if len(points) > 1:
                _steepest(slopes, points, values, known)
            if len(ranked) < len(points):
                break
            points = search.send(batch)
    except StopIteration:
        pass
    finally:
        search.close()
    return slopes


def _keys(points: Floats) -> Floats:
    return np.round(points, DIGITS)


def _steepest(slopes: Floats, points: Floats, values: Floats, known: dict[bytes, float]) -> None:
    """Update the slopes with those between pairs of new centres and the centre between them."""
    low, high = points[0::2], points[1::2]
    middle = np.array([known.get(key.tobytes(), np.nan) for key in _keys((low + high) / 2)])
    side = np.argmax(np.abs(high - low), axis=1)
    step = np.abs(high - low).max(axis=1) / 2
    for value in (values[0::2], values[1::2]):
        slope = np.abs(value - middle) / step
        found = np.isfinite(slope)
        np.maximum.at(slopes, side[found], slope[found])
