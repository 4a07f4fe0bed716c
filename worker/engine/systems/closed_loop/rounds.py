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
LOOSE, EVEN = 0.5, 1.0 / 6.0
"""The same, of what moves about irregularly, from the first to the last quarter of the time in which it is seen; of
that, the least part from each quarter to the next."""
ACROSS = 2.0, 0.25
"""The same, along a line along which it hardly moves about."""
AGAIN, APART = 0.01, 0.25
"""Velocities have returned whose mean square difference is this fraction of the largest one, after it was that much."""
TWICE = 4.0
"""The largest one is so many times the mean square of late velocities at most: what was under way differs by more."""
FITS = 0.02
"""The largest difference of velocity changes from those of a circle, as a fraction of them."""
SLOWS = 1.0 / math.log(2.0)
"""In so many rounds at most what becomes slower gets as far as it will: in each it is halved."""
COUNTED = 128
"""So many velocities of a round are compared, about."""
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


def rounds(places: Floats, late: int, each: float) -> Rounds | None:
    """Those of a vehicle at places (n, 3) at equal intervals [s], that kept about a place in the last so many of them;
    None if they stay where they are."""
    if len(places) < FEWEST:
        return None
    moved = places[1:] - places[:-1]
    count = _returning(moved, len(moved) // 2, late)
    if count >= FEWEST:
        return _repeated(places, count, each)
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
    if angles[0] < LEAST or np.abs(angles - evenly).max() > 2.0 * FITS * angles[0]:
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


def _repeated(places: Floats, count: int, each: float) -> Rounds | None:
    """Those of what returns to its velocity after about so many intervals."""
    moved, lasts, rest = _period(places, count, each)
    last, before = places[-count:], places[-2 * count : -count]
    centre, apart = last.mean(axis=0), float(np.linalg.norm(moved))
    reach = float(samples.lengths(last - centre).max())
    least = LEAST * reach + 0.5 * _size(rest)
    growth = _spread(last) - _spread(before)
    grows = growth > least and not _slower(growth, before, places[-3 * count : -2 * count])
    if not grows and apart <= min(least, _least(rest, places[-2 * count - 1 : -count - 1], reach)):
        return None
    half, goes = count // 2, math.inf
    differs = 2.0 * (rest[-half:].mean(axis=0) - rest[:half].mean(axis=0))
    if len(places) > 3 * count and _again(places[:-count], count):
        earlier = _period(places[:-count], count, each)[0]
        # What was fast in the round before, and is steady within the last one, goes on.
        slows, lately = _falls(earlier, moved), 0.5 * _falls(moved - 0.25 * differs, moved + 0.25 * differs)
        goes = lasts * slows if slows < SLOWS and lately < 2.0 * slows else math.inf
        differs = moved - earlier
    aside = float(np.linalg.norm(differs)) / lasts
    return Rounds(centre, reach, moved / lasts, aside, goes, growth / lasts if grows else 0.0)


def _least(rest: Floats, begun: Floats, reach: float) -> float:
    """What rounds that stay seem to move by at most [m]: of changes that are as large as the places from which they
    begin are far out, as of a spiral, only the second order."""
    away = begun - begun.mean(axis=0)
    linear = away @ np.linalg.lstsq(away, rest, rcond=None)[0]
    return LEAST * reach + _size(linear) ** 2 / reach + 0.5 * _size(rest - linear)


def _falls(before: Floats, now: Floats) -> float:
    """In how many times the time between them what had one velocity and then another gets as far as it will."""
    slower = float(np.linalg.norm(now)) / (float(np.linalg.norm(before)) or 1e-300)
    return -1.0 / math.log(max(slower, 1e-300)) if slower < 1.0 else math.inf


def _again(places: Floats, count: int) -> bool:
    """Whether velocities were in the last so many intervals what they were before."""
    moved = places[1:] - places[:-1]
    now = moved[-count:]
    return _size(now - moved[-2 * count : -count]) <= math.sqrt(TWICE * AGAIN) * _size(now)


def _slower(growth: float, before: Floats, earlier: Floats) -> bool:
    """Whether rounds grew by twice as much before."""
    return len(earlier) == len(before) and 2.0 * growth < _spread(before) - _spread(earlier)


def _period(places: Floats, count: int, each: float) -> tuple[Floats, float, Floats]:
    """By how much what returns to its velocity moved in that time (3,) [m], the time [s], which is no whole number of
    intervals, and by how much more it moved from every place of the round before (count, 3) [m]."""
    velocity = (places[2:] - places[:-2]) / (2.0 * each)
    moved, velocity = places[-count - 1 : -1] - places[-2 * count - 1 : -count - 1], velocity[-count:]
    mean, usual = moved.mean(axis=0), velocity.mean(axis=0)
    varies = velocity - usual
    size = float((varies * varies).sum())
    longer = float(((moved - mean) * varies).sum()) / size if size else 0.0
    return mean - longer * usual, count * each - longer, moved - mean - longer * varies


def _spread(places: Floats) -> float:
    """The root mean square distance of places from their mean [m]."""
    return _size(places - places.mean(axis=0))


def _size(vectors: Floats) -> float:
    """The root mean square length of vectors (n, 3)."""
    return math.sqrt(float((vectors * vectors).sum(axis=1).mean()))


def _irregular(places: Floats, each: float) -> Rounds | None:
    """Those of what never returns to its velocity, if in every quarter of the time it was farther on, or wider."""
    quarter = len(places) // 4
    if quarter < 2:
        return None
    parts = places[-4 * quarter :].reshape(4, quarter, 3)
    centres, spreads = parts.mean(axis=1), np.array([_spread(part) for part in parts])
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
    size = float(np.linalg.norm(known))
    if size == 0.0:
        return np.zeros(3), 0.0, np.zeros(3), 0.0
    found = np.linalg.lstsq(system, known, rcond=None)[0]
    residual = float(np.linalg.norm(system @ found - known)) / size
    chord = float(np.linalg.norm(found[:3])) * each / 2.0
    # Differences of chords turn faster than what they are chords of.
    found *= math.atan(chord) / chord if chord else 1.0
    return found[:3], float(found[3]), found[4:], residual


@compiled
def _returning(velocities: Floats, most: int, late: int) -> int:
    """After how many intervals velocities (n, 3) are what they were, at most so many; of several times, the longest in
    the late ones. 0 if they never are."""
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
    away, once, often = False, 0, 0
    for lag in range(1, most + 1):
        away = away or differ[lag] >= APART * top
        returns = away and differ[lag] <= AGAIN * top and differ[lag] <= min(differ[lag - 1], differ[lag + 1])
        if returns and (once == 0 or lag <= late):
            once, often = once or lag, lag
    return often
