"""Polishes the minima of basins, also where the cost is rugged, and finds further ones from random points.

Descents by gradients come first, then a compass search. Where the compass has lowered a minimum, gradients were of no
use, and the compass ends in any small dip: an evolution strategy follows (`cma`), from the lowest such minima first.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from worker.engine.search.base import Batch, Floats, Search, side_by_side
from worker.engine.search.parts.basin import GAIN, ROUGH, SMALL, Basin, Rules, close, lower, lowered
from worker.engine.search.parts.cma import Strategy, default_population
from worker.engine.search.parts.descent import Settings

FINE = Settings(difference=1e-6, step_tolerance=1e-9, iterations=60, apart=True)
"""Settings of the descents that polish the minimum of a basin."""
STEP, SMALLEST = 1e-3, 1e-9
"""First and last step of the compass; the first is also the deviation of a strategy that follows it."""
FEW = 4
"""Strategies side by side from known minima."""
WIDE, WAVE, LEAST = 0.1, 8, 100
"""Deviation of the strategies from random points, how many are side by side, and what each may take per parameter."""

Part = Generator[Floats, Batch, None]


class Polish(NamedTuple):
    """room: how many evaluations strategies may take, asked when it matters; random: their numbers."""

    room: Callable[[], int]
    random: np.random.Generator


def polished(found: list[Basin], rules: Rules, polish: Polish) -> Part:
    """Polish every basin. `found` is up to date after every step; two that end at one place are one."""
    yield from lower(found, replace(FINE, gain=SMALL * rules.barrier))
    before = [(basin, basin.cost) for basin in found]
    yield from _poll(found, SMALL * rules.barrier)
    rugged = [basin for basin in found for b, cost in before if b is basin and cost - b.cost > rules.rugged]
    left = polish.room() if rugged else 0
    while rugged and left > 0:
        few = [basin for basin in rugged[:FEW] if any(basin is b for b in found)]
        del rugged[:FEW]
        each, parts = left // max(len(few), 1), zip(few, polish.random.spawn(len(few)), strict=True)
        left -= yield from _counted([_evolved(basin, found, STEP, each, rules, own) for basin, own in parts])
        found[:] = close(found, rules.distance)


def explored(
    known: list[Basin], below: float, rules: Rules, room: int, random: np.random.Generator
) -> Generator[Floats, Batch, list[Basin]]:
    """Minima that are not known, of costs below `below`: where descents from random points, and strategies from their
    ends, end. Takes about `room` evaluations, and begins none with fewer than `LEAST` per parameter for each start. A
    start that has no value leads nowhere."""
    fresh: list[Basin] = []
    least = LEAST * len(known[0].point)
    while room >= WAVE * least:
        each, streams = room // WAVE, random.spawn(WAVE)
        room -= yield from _counted([_anywhere(known, fresh, below, each, rules, own) for own in streams])
    return fresh


def _poll(basins: list[Basin], small: float) -> Part:
    """Compass search around every basin in parallel, for edges and kinks where gradients fail.

    It ends where no step changes the cost by more than `small`.
    """
    steps = np.full(len(basins), STEP)
    for _ in range(200):
        active = np.flatnonzero(steps >= SMALLEST)
        if len(active) == 0:
            break
        polls = [_compass(basins[i].point, steps[i]) for i in active]
        ranked = (yield np.concatenate(polls)).ranked().reshape(len(active), -1)
        for i, poll, values in zip(active, polls, ranked, strict=True):
            low = int(np.argmin(values))
            if values[low] < basins[i].cost:
                basins[i].point, basins[i].cost = poll[low].copy(), float(values[low])
            else:
                flat = values.max(initial=-np.inf) - basins[i].cost <= small
                steps[i] = 0.0 if flat else steps[i] / 4.0
    basins.sort(key=lambda b: b.cost)


def _compass(point: Floats, step: float) -> Floats:
    arms = step * np.concatenate([np.eye(len(point)), -np.eye(len(point))])
    return np.clip(point + arms, 0.0, 1.0)


def _anywhere(
    known: list[Basin], fresh: list[Basin], below: float, most: int, rules: Rules, random: np.random.Generator
) -> Search:
    """Descend from a random point; add the end to the fresh ones if it is low and close to no other."""
    basin = Basin(random.random(len(known[0].point)), np.inf, [])
    yield from lowered(basin, replace(ROUGH, gain=GAIN * rules.barrier))
    if np.isfinite(basin.cost) and not _close_to(basin, [*known, *fresh], rules):
        settled = yield from _evolved(basin, [*known, *fresh], WIDE, most, rules, random)
        if settled and basin.cost < below and not _close_to(basin, [*known, *fresh], rules):
            fresh.append(basin)
    return ""


def _evolved(
    basin: Basin, others: list[Basin], deviation: float, most: int, rules: Rules, random: np.random.Generator
) -> Search:
    """Lower a basin by a strategy until the costs of a generation are the same; the sentence is empty if it ends before
    that, because a lower basin is close or `most` evaluations are made."""
    population = 2 * default_population(len(basin.point))
    strategy = Strategy(basin.point, deviation, population, random)
    for _ in range(most // population):
        if _close_to(basin, [b for b in others if b.cost < basin.cost], rules):
            return ""
        points = strategy.ask()
        ranked = (yield points.copy()).ranked()
        low = int(np.argmin(ranked))
        if ranked[low] < basin.cost:
            basin.point, basin.cost = points[low].copy(), float(ranked[low])
        strategy.tell(ranked)
        if not np.isfinite(ranked[low]):
            return ""
        if strategy.ending is not None or ranked.max() - ranked[low] <= SMALL * rules.barrier:
            return "the costs of a generation are the same"
    return ""


def _close_to(basin: Basin, others: list[Basin], rules: Rules) -> bool:
    return any(np.abs(b.point - basin.point).max() < rules.distance / 3 for b in others)


def _counted(searches: list[Search]) -> Generator[Floats, Batch, int]:
    """Advance searches side by side; returns their evaluations."""
    parts, spent, answer = side_by_side(searches), 0, None
    try:
        while True:
            points = parts.send(answer) if answer is not None else next(parts)
            spent += len(points)
            answer = yield points
    except StopIteration:
        return spent
    finally:
        parts.close()
