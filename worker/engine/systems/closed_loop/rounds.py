"""How a vehicle goes round: whither that carries it, whether its rounds grow, and the wide circle of a slight turn.

What repeats its velocity after a while is carried by as much as it moved in that time, to within small fractions of a
round. To an arc alone v' = (w x + s) (v - u) is fitted: a circle at a steady rate w in what moves at u, such as air,
that swells by s. Start reading at `rounds`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from worker.engine.kernels.cached import compiled
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop import samples

LEAST = 1e-3
"""Rounds that move or grow by this fraction of their extent have not stayed."""
ALIKE, SLOWS = 0.5, 0.7
"""By what fraction of their mean rounds may differ that are all carried on, or grow; and of what they were carried at
first that is left where that becomes less."""
LOOSE, EVEN = 0.5, 1.0 / 6.0
"""Of what moves about irregularly: what `LEAST` is of rounds, from the first to the last quarter of the time in which
it is seen; of that, the least part from each quarter to the next."""
ACROSS = 2.0, 0.25
"""The same, along a line along which it hardly moves about."""
AGAIN, APART = 0.01, 0.25
"""Velocities have returned whose mean square difference is this fraction of the largest one, after it was that much."""
TWICE = 4.0
"""The largest one is so many times the mean square of late velocities at most: what was under way differs by more."""
ALONE, ONCE, AMONG = 5.0, 0.5, 0.2
"""By how many times what differs within it the last round moved on, and grew, if it alone is known; and if others
are."""
FITS = 0.02
"""The largest difference of velocity changes from those of a circle, as a fraction of them."""
COUNTED = 128
"""So many velocities of a round are compared, about."""
SHORTEST = 4
"""Rounds are taken together that are shorter than the late part by this factor."""
FEWEST = 8
"""Places that show a round, at least."""


class Rounds(NamedTuple):
    """centre: of the last round (3,) [m]; reach: the largest distance from that [m]; carried: how it moves on (3,)
    [m/s]; aside: by how much that changed [m/s]; lasts: how long with that velocity, to get as far as it will [s];
    grows: how fast the rounds do [m/s]."""

    centre: Floats
    reach: float
    carried: Floats
    aside: float = 0.0
    lasts: float = math.inf
    grows: float = 0.0

    def nearest(self, centres: Floats, drift: Floats) -> tuple[float, float]:
        """The smallest distance of rounds that are carried on from what is at places (n, 3) and moves on, less than 0
        within; and when [s]."""
        relative, velocity = centres - self.centre, self.carried - drift
        speed = float(np.linalg.norm(velocity))
        along = relative @ velocity / (speed or 1.0)
        across = np.sqrt(np.maximum((relative * relative).sum(axis=1) - along * along, 0.0))
        # The distance from a line falls as what may be aside of it grows, until they do so equally fast.
        faster = max(speed * speed - self.aside * self.aside, 0.0)
        times = np.full(len(centres), self.lasts)
        if faster > 0.0:
            times = np.clip((along + across * self.aside / math.sqrt(faster)) / speed, 0.0, self.lasts)
        elif self.aside == 0.0:
            times = np.zeros(len(centres))
        elif math.isinf(self.lasts):
            return -self.reach, float(samples.lengths(relative).min()) / self.aside
        found = samples.lengths(relative - times[:, None] * velocity) - self.aside * times
        k = int(np.argmin(found))
        return float(found[k]) - self.reach, float(times[k])


def rounds(places: Floats, late: int, each: float, goal: Floats | None = None) -> Rounds | None:
    """Those of a vehicle at places (n, 3) at equal intervals [s], that kept about a place in the last so many of them;
    None if they stay where they are. goal: to which it is guided (3,) [m]."""
    if len(places) < FEWEST:
        return None
    moved = places[1:] - places[:-1]
    count = _returning(moved, max(FEWEST, late // SHORTEST), len(moved) // 2, late)
    if count:
        return _repeated(places, count, late, each, goal)
    return fitted(places[-late - 1 :], each) if _circular(moved[-late:]) else _irregular(places[-late - 1 :], each)


def fitted(places: Floats, each: float) -> Rounds | None:
    """The circle of which places are an arc, if it is carried on, or grows."""
    moved = (places[1:] - places[:-1]) / each
    turn, swells, rest, residual = _fit(moved, each)
    rate = float(np.linalg.norm(turn))
    if rate == 0.0 or residual > FITS:
        return None
    along = turn / rate
    across = (np.cross(turn, rest) - swells * (rest - (rest @ along) * along)) / (rate**2 + swells**2)
    carried = across + float((moved @ along).mean()) * along
    own = moved[-1] - carried
    reach, around, least = float(np.linalg.norm(own)) / rate, 2.0 * math.pi / rate, LEAST + residual
    grows = swells * around > least
    if not grows and around * float(np.linalg.norm(carried)) <= least * 2.0 * math.pi * reach:
        return None
    centre = places[-1] + np.cross(turn, own) / rate**2
    return Rounds(centre, reach, carried, grows=swells * reach if grows else 0.0)


def bend(places: Floats, each: float) -> Floats | None:
    """The angular velocity (3,) [rad/s] of a vehicle that turns evenly by a small angle; None if it does not."""
    moved = (places[1:] - places[:-1]) / each
    if len(moved) < FEWEST or not samples.lengths(moved).all():
        return None
    angles = np.arctan2(samples.lengths(np.cross(moved, moved[-1])), moved @ moved[-1])
    evenly = np.linspace(angles[0], 0.0, len(angles))
    # The less it turns, the longer it takes to go round, for which that has to stay the same.
    if angles[0] < LEAST or np.abs(angles - evenly).max() * 2.0 * math.pi > FITS * angles[0] * angles[0]:
        return None
    found: Floats = np.cross(moved[0], moved[-1])
    rate = float(angles[0]) / (each * (len(moved) - 1))
    return np.asarray(found * (rate / float(np.linalg.norm(found))))


def onto(place: Floats, velocity: Floats, turn: Floats, times: Floats) -> Floats:
    """The places (n, 3) of what goes round with a velocity and an angular velocity [rad/s], at some times [s]."""
    rate = float(np.linalg.norm(turn))
    along = (velocity @ turn) * turn / rate**2
    sine, rest = np.sin(rate * times) / rate, (1.0 - np.cos(rate * times)) / rate**2
    found: Floats = place + np.outer(times, along) + np.outer(sine, velocity - along)
    return found + np.outer(rest, np.cross(turn, velocity))


def _repeated(places: Floats, count: int, late: int, each: float, goal: Floats | None) -> Rounds | None:
    """Those of what returns to its velocity after about so many intervals. What differs from round to round, as about a
    goal, is not carried on: only what every one does, or all of the last one, if it was not about the goal."""
    several = _alike(places, count, max(1, min(math.ceil(2 * late / count), (len(places) - 1) // count - 1)))
    until = [places[: len(places) - k * count] for k in range(several, -1, -1)]
    found = [_period(part, count, each) for part in until[1:]]
    moved, (now, lasts, rest), last = np.array([each[0] for each in found]), found[-1], places[-count:]
    centre = last.mean(axis=0)
    reach = float(samples.lengths(last - centre).max())
    usual, least = moved.mean(axis=0), _least(rest, places[-2 * count - 1 : -count - 1], reach)
    apart = float(np.linalg.norm(usual))
    among = several > 1 and bool((samples.lengths(moved - usual) <= ALIKE * apart).all()) and apart > least
    alone = goal is None or not float(np.linalg.norm(goal - centre)) <= reach
    carried = among or (alone and float(np.linalg.norm(now)) > LEAST * reach + ALONE * _size(rest))
    spreads = np.array([_spread(part, count, usual * (each / lasts)) for part in until])
    growth = float(spreads[-1] - spreads[0])
    most = LEAST * reach + (AMONG if several > 1 else ONCE) * _size(rest)
    grows = growth > most and bool((np.diff(spreads) >= ALIKE * growth / several).all()) and (alone or several > 1)
    if not carried and not grows:
        return None
    half = count // 2
    differs = 2.0 * (rest[-half:].mean(axis=0) - rest[:half].mean(axis=0))
    slows = _slows(moved) if among else 0.5 * _slows(np.array([now - 0.25 * differs, now + 0.25 * differs]))
    differs = now - moved[-2] if among else differs
    # What changes along the way makes it come sooner or later, not aside.
    square = float(now @ now)
    aside = float(np.linalg.norm(differs - (differs @ now) / square * now if square else differs)) / lasts
    return Rounds(centre, reach, now / lasts, aside, lasts * slows, growth / (several * lasts) * grows)


def _least(rest: Floats, begun: Floats, reach: float) -> float:
    """What rounds that stay seem to move by at most [m]: of changes that are as large as the places from which they
    begin are far out, as of a spiral, only the second order."""
    away = begun - begun.mean(axis=0)
    linear = away @ np.linalg.lstsq(away.T @ away, away.T @ rest, rcond=None)[0]
    return LEAST * reach + _size(linear) ** 2 / reach + AMONG * _size(rest - linear)


def _alike(places: Floats, count: int, most: int) -> int:
    """How many rounds have the velocities of those before them, at most so many; one has."""
    moved = places[1:] - places[:-1]
    for k in range(1, most):
        now, before = (moved[len(moved) - (k + j + 1) * count : len(moved) - (k + j) * count] for j in (0, 1))
        if len(before) < count or _size(now - before) > math.sqrt(TWICE * AGAIN) * _size(now):
            return k
    return most


def _size(vectors: Floats) -> float:
    """The root mean square length of vectors (n, 3)."""
    return math.sqrt(float((vectors * vectors).sum(axis=1).mean()))


def _slows(moved: Floats) -> float:
    """How many rounds as long as the last one is what is carried on less and less still gets."""
    half = len(moved) // 2
    if half == 0:
        return math.inf
    before, now = (float(np.linalg.norm(part.mean(axis=0))) for part in (moved[:half], moved[-half:]))
    return (len(moved) - half) / math.log(before / now) if 0.0 < now < SLOWS * before else math.inf


@compiled
def _period(places: Floats, count: int, each: float) -> tuple[Floats, float, Floats]:
    """By how much what returns to its velocity moved in that time (3,) [m], the time [s], which is no whole number of
    intervals, and by how much more it moved from every place of the round before (count, 3) [m]."""
    moved, speed, usual = np.empty((count, 3)), np.empty((count, 3)), np.zeros((2, 3))
    for i in range(count):
        at = len(places) - 1 - count + i
        for k in range(3):
            moved[i, k] = places[at, k] - places[at - count, k]
            speed[i, k] = (places[at + 1, k] - places[at - 1, k]) / (2.0 * each)
            usual[0, k] += moved[i, k] / count
            usual[1, k] += speed[i, k] / count
    product, square = 0.0, 0.0
    for i in range(count):
        for k in range(3):
            product += (moved[i, k] - usual[0, k]) * (speed[i, k] - usual[1, k])
            square += (speed[i, k] - usual[1, k]) ** 2
    longer = product / square if square > 0.0 else 0.0
    for i in range(count):
        for k in range(3):
            moved[i, k] -= usual[0, k] + longer * (speed[i, k] - usual[1, k])
    return usual[0] - longer * usual[1], count * each - longer, moved


@compiled
def _spread(places: Floats, count: int, drift: Floats) -> float:
    """The root mean square distance of the last so many places from their mean, less what they move in each interval
    (3,) [m]."""
    total, square, first = np.zeros(3), 0.0, len(places) - count
    for i in range(count):
        for k in range(3):
            away = places[first + i, k] - places[first, k] - i * drift[k]
            total[k] += away
            square += away * away
    return math.sqrt(max(square / count - (total[0] ** 2 + total[1] ** 2 + total[2] ** 2) / count**2, 0.0))


def _irregular(places: Floats, each: float) -> Rounds | None:
    """Those of what never returns to its velocity, if in every quarter of the time it was farther on, or wider."""
    quarter = len(places) // 4
    if quarter < 2:
        return None
    parts = places[-4 * quarter :].reshape(4, quarter, 3)
    centres, spreads = parts.mean(axis=1), np.array([_spread(part, quarter, np.zeros(3)) for part in parts])
    last, time = parts[3] - centres[3], 3.0 * quarter * each
    reach = float(samples.lengths(last).max())
    goes = _onward(centres, LOOSE * reach, EVEN)
    if not goes.any():
        # Across the plane or the line about which it moves, as upwards, it shows sooner.
        for way in np.linalg.eigh(last.T @ last)[1].T:
            least = max(ACROSS[0] * float(np.abs(last @ way).max()), LEAST * reach)
            goes = goes + _onward((centres @ way)[:, None] * way, least, ACROSS[1])
    growth = float(spreads[3] - spreads[0])
    grows = growth > LOOSE * float(spreads[0]) and bool((np.diff(spreads) >= EVEN * growth).all())
    if not goes.any() and not grows:
        return None
    return Rounds(centres[3], reach, goes / time, grows=growth / time if grows else 0.0)


def _onward(centres: Floats, least: float, evenly: float) -> Floats:
    """By how much the centres of four quarters (4, 3) moved on (3,) [m]; 0 if that's not more than the least, or less
    than evenly in one of them."""
    moved: Floats = centres[3] - centres[0]
    parts = (centres[1:] - centres[:-1]) @ moved >= evenly * float(moved @ moved)
    return moved if float(np.linalg.norm(moved)) > least and parts.all() else 0.0 * moved


def _circular(moved: Floats) -> bool:
    return len(moved) >= FEWEST and _fit(moved, 1.0)[-1] <= FITS


def _fit(velocities: Floats, each: float) -> tuple[Floats, float, Floats, float]:
    """The angular velocity (3,) [rad/s], the swelling [1/s] and the constant (3,) that fit v' = w x v + s v + c best,
    and how well."""
    x, y, z = (0.5 * (velocities[1:] + velocities[:-1])).T
    changes = (velocities[1:] - velocities[:-1]) / each
    none, one = np.zeros(len(x)), np.ones(len(x))
    equations = (none, z, -y, x, one, none, none), (-z, none, x, y, none, one, none), (y, -x, none, z, none, none, one)
    system, known = np.concatenate([np.stack(each, axis=1) for each in equations]), changes.T.ravel()
    size, square = float(np.linalg.norm(known)), system.T @ system
    if size == 0.0 or not np.isfinite(square).all():
        return np.zeros(3), 0.0, np.zeros(3), 0.0 if size == 0.0 else math.inf
    found = np.linalg.lstsq(square, system.T @ known, rcond=None)[0]
    residual = float(np.linalg.norm(system @ found - known)) / size
    chord = float(np.linalg.norm(found[:3])) * each / 2.0
    # Differences of chords turn faster than what they are chords of.
    found *= math.atan(chord) / chord if chord else 1.0
    return found[:3], float(found[3]), found[4:], residual


@compiled
def _returning(velocities: Floats, least: int, most: int, late: int) -> int:
    """The lowest number of intervals, of so many at least and at most, after which velocities (n, 3) are what they
    were; 0 if there is none."""
    differ, top, square = np.zeros(most + 2), 0.0, 0.0
    for i in range(max(0, len(velocities) - late), len(velocities)):
        for k in range(3):
            square += velocities[i, k] * velocities[i, k]
    for lag in range(1, most + 1):
        every, found, count = max(1, lag // COUNTED), 0.0, 0
        for i in range(len(velocities) - 1, len(velocities) - 1 - lag, -every):
            for k in range(3):
                difference = velocities[i, k] - velocities[i - lag, k]
                found += difference * difference
            count += 1
        differ[lag] = found / count
        top = max(top, differ[lag])
    top = min(top, TWICE * square / max(1, min(late, len(velocities))))
    differ[most + 1] = differ[most]
    away = False
    for lag in range(1, most + 1):
        away = away or differ[lag] >= APART * top
        returned = away and lag >= least and differ[lag] <= AGAIN * top
        if returned and differ[lag] <= min(differ[lag - 1], differ[lag + 1]):
            return lag
    return 0
