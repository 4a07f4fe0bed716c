"""The instants at which a flight begins a stretch of its own: samples of guidance, and whatever jumps.

Start reading at `Timetable`.
"""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from worker.systems.base import Floats
from worker.systems.closed_loop.flights import Flights

STRETCHES = 40
"""A flight without samples of guidance is integrated in so many stretches: only from the one where it stuck on is it
flown at the coarse tolerance."""

BEFORE = 1e-8
"""Fraction of a stretch by which its end is approached where something jumps there."""

APART = 1e-9
"""Instants are apart by more than this [s]."""

STUCK, PER_STRETCH = 5_000, 0.1
"""Calls of the right-hand side in which a flight must make headway: some, and some for every stretch of the flight."""


@dataclass(frozen=True)
class Stretches:
    """One flight's stretches: n + 1 instants [s]; whether guidance is sampled at the start of each of the n.

    before: by which fraction of a stretch its end is approached; patience: calls in which it must make headway.
    """

    instants: Floats
    asks: NDArray[np.bool_]
    before: float
    patience: int


class Timetable:
    """The stretches of a problem's flights; those of flights that switch alike are made once."""

    def __init__(self, flights: Flights) -> None:
        self.flights = flights
        self.horizon = flights.campaign.given_scenario.horizon
        self.ticks = _ticks(flights, self.horizon)
        self._last: tuple[set[float], Stretches] | None = None

    def of(self, p: tuple[float, ...]) -> Stretches:
        """The stretches of a flight with these extended parameters. Threads may ask at the same time."""
        switches, last = _switches(self.flights, p, self.horizon), self._last
        if last is None or last[0] != switches:
            last = self._last = (switches, self._made(switches))
        return last[1]

    def _made(self, switches: set[float]) -> Stretches:
        instants, sampled = _joined(self.ticks, switches), set(self.ticks)
        asks = np.array([t in sampled for t in instants[:-1]])
        patience = STUCK + round(PER_STRETCH * len(asks))
        return Stretches(np.array(instants), asks, BEFORE if switches else 0.0, patience)


def _switches(flights: Flights, p: tuple[float, ...], horizon: float) -> set[float]:
    """The instants at which a fault or the environment jumps.

    What perception does between the samples of guidance reaches nobody.
    """
    parts, places = flights.parts, flights.loop.extended
    inner = {f"faults.{i}": f.fault for i, f in enumerate(parts.faults) if f.fault.path in ("navigation", "actuator")}
    outer = {f"faults.{i}": f.fault for i, f in enumerate(parts.faults)}
    around = {f"environment.{i}": e for i, e in enumerate(parts.environment)}
    found: set[float] = set()
    for prefix, part in ((inner if parts.sampled else outer) | around).items():
        if part.switches is not None:
            at = places[prefix]
            found.update(part.switches(at.fields(*p[at.first : at.last]), horizon))
    return found


def _joined(ticks: list[float], switches: set[float]) -> list[float]:
    """Both in order; of a tick and a switch at the same instant the tick, of two switches the earlier."""
    joined = list(ticks)
    for t in sorted(switches):
        at = bisect(joined, t)
        if ticks[0] < t < ticks[-1] and min(t - joined[at - 1], joined[at] - t) > APART:
            joined.insert(at, t)
    return joined


def _ticks(flights: Flights, horizon: float) -> list[float]:
    period = flights.campaign.given_scenario.guidance.period
    if period == 0.0:
        if flights.parts.avoider.memory == 0:
            return [k * horizon / STRETCHES for k in range(STRETCHES)] + [horizon]
        period = flights.step
    return [k * period for k in range(round(horizon / period))] + [horizon]
