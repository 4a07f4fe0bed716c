"""Polishes the minima of basins, also where the cost is rugged, and finds further ones.

Descents by gradients come first, then a compass search. Where the compass has lowered a minimum, gradients were of no
use, and the compass ends in any small dip: an evolution strategy follows (`cma`), from the lowest such minima first.
Further minima are looked for where the coordinates of known ones meet, and from random points.
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
POPULATIONS = (2, 4, 8)
"""Of a strategy, as multiples of the usual one; the larger ones follow where the smaller end in a dip."""
WIDE, WAVE, LEAST = 0.1, 8, 100
"""Deviation of the strategies from random points, how many are side by side, and what each may take per parameter."""
CROSSED = 2000
"""Points of crossed coordinates in a round, at most."""

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
    yield from _strategies(found, rugged, rules, polish.room() if rugged else 0, polish.random, POPULATIONS[0])


def sharpened(found: list[Basin], same: float, rules: Rules, room: int, random: np.random.Generator) -> Part:
    """Lower those minima that are higher than the lowest by `same` at most: they may be as low. Strategies of larger
    populations follow, until nothing is between."""
    for larger in POPULATIONS:
        lowest = found[0].cost
        between = [b for b in found if SMALL * rules.barrier < b.cost - lowest <= same]
        room -= yield from _strategies(found, between, rules, room, random, larger)


def _strategies(
    found: list[Basin], waiting: list[Basin], rules: Rules, room: int, random: np.random.Generator, larger: int
) -> Generator[Floats, Batch, int]:
    """Strategies from these minima, a few at a time; `found` is up to date after each few. Returns the evaluations."""
    left = room
    while waiting and left > 0:
        few = [basin for basin in waiting[:FEW] if any(basin is b for b in found)]
        del waiting[:FEW]
        each, parts = left // max(len(few), 1), zip(few, random.spawn(len(few)), strict=True)
        left -= yield from _counted([_evolved(basin, found, STEP, each, rules, own, larger) for basin, own in parts])
        found[:] = close(found, rules.distance)
    return room - left


def crossed(
    known: list[Basin], same: float, rules: Rules, room: int, random: np.random.Generator
) -> Generator[Floats, Batch, list[Basin]]:
    """Minima that are not known, of costs up to `same`, from points that have some coordinates of one known minimum as
    low as that and the others of another: where parameters act independently, these are minima too."""
    points = _meeting(known, same, min(CROSSED, room // 2), rules, random)
    if not len(points):
        return []
    ranked = (yield points).ranked()
    low = np.flatnonzero(ranked <= same + rules.barrier)
    fresh = close([Basin(points[i].copy(), float(ranked[i]), []) for i in low], rules.distance)
    del fresh[room // 2 // (ROUGH.iterations * (points.shape[1] + 2)) :]
    for settings in (replace(ROUGH, gain=GAIN * rules.barrier), replace(FINE, gain=SMALL * rules.barrier)):
        yield from lower(fresh, settings)
        fresh = [b for b in close(fresh, rules.distance) if b.cost <= same and not _close_to(b, known, rules)]
    return fresh


def _meeting(known: list[Basin], same: float, most: int, rules: Rules, random: np.random.Generator) -> Floats:
    """Points (m, n) of crossed coordinates of the lowest minima that are close to no known one."""
    at, lowest = (np.array([b.point for b in known if b.cost <= limit]) for limit in (np.inf, same))
    n = at.shape[1]
    if len(lowest) < 2 or n < 2 or most < 1:
        return np.empty((0, n))
    parents = lowest[random.integers(len(lowest), size=(2, most))]
    points = np.where(random.random((most, n)) < 0.5, parents[0], parents[1])
    cells = np.floor(points / (rules.distance / 3)).astype(np.int64)
    points = points[np.sort(np.unique(cells, axis=0, return_index=True)[1])]
    near = [np.abs(at - point).max(axis=1).min() < rules.distance / 3 for point in points]
    return np.asarray(points[~np.array(near)])


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
    basin: Basin,
    others: list[Basin],
    deviation: float,
    most: int,
    rules: Rules,
    random: np.random.Generator,
    larger: int = POPULATIONS[0],
) -> Search:
    """Lower a basin by a strategy until the costs of a generation are the same; the sentence is empty if it ends before
    that, because a lower basin is close or `most` evaluations are made."""
    population = larger * default_population(len(basin.point))
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
