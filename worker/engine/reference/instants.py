"""The instants that divide a simulation into stretches: guidance samples, discontinuities, and turns of obstacles."""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from worker.engine.kernels.component import Environment, Fault
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.flights import Flights

STRETCHES = 40
"""Number of stretches without sampled guidance; the coarse tolerance is used only from the stretch that got stuck."""

BEFORE = 1e-8
"""Fraction of a stretch by which slopes stay before its end, if there are discontinuities."""

APART = 1e-9
"""The smallest distance between instants [s]."""

STUCK, PER_STRETCH = 1_500, 0.1
"""Calls of the right-hand side within which a simulation must make progress: a constant, and a number per stretch."""


@dataclass(frozen=True)
class Stretches:
    """The stretches of one simulation: n + 1 instants [s]; whether guidance is sampled at the start of each of the n.

    turns: whether an obstacle turns or stops at the start or the end of each; before: fraction of a stretch by which
    slopes stay before its end; patience: calls within which it must progress.
    """

    instants: Floats
    asks: NDArray[np.bool_]
    turns: NDArray[np.bool_]
    before: float
    patience: int


class Timetable:
    """The stretches of a closed loop's simulations; cached for simulations with the same switching instants."""

    def __init__(self, flights: Flights) -> None:
        self.flights = flights
        self.horizon = flights.campaign.given_scenario.horizon
        self.ticks = _ticks(flights, self.horizon)
        self._last: tuple[set[float], set[float], Stretches] | None = None

    def of(self, p: tuple[float, ...]) -> Stretches:
        """The stretches of a simulation with these extended parameters. Thread-safe."""
        switches = _switches(self.flights, p, self.horizon)
        turns = {t for t in self.flights.turns(p) if 0.0 < t < self.horizon}
        last = self._last
        if last is None or last[:2] != (switches, turns):
            last = self._last = (switches, turns, self._made(switches, turns))
        return last[2]

    def _made(self, switches: set[float], turns: set[float]) -> Stretches:
        instants, sampled = _joined(self.ticks, switches | turns), set(self.ticks)
        asks = np.array([t in sampled for t in instants[:-1]])
        patience = STUCK + round(PER_STRETCH * len(asks))
        at = np.zeros(len(instants), dtype=np.bool_)
        for t in turns:  # one that is joined to another instant is there
            at |= np.abs(np.array(instants) - t) <= APART
        before = BEFORE if switches or at.any() else 0.0
        return Stretches(np.array(instants), asks, at[:-1] | at[1:], before, patience)


def _switches(flights: Flights, p: tuple[float, ...], horizon: float) -> set[float]:
    """The instants of discontinuities of faults and the environment.

    With sampled guidance, perception between samples has no effect, so its switches are left out.
    """
    parts, spans = flights.parts, flights.loop.extended
    found: set[float] = set()
    for prefix, part in parts.named.items():
        if not isinstance(part, Fault | Environment) or part.switches is None:
            continue
        if isinstance(part, Environment) or not parts.sampled or part.path in ("navigation", "actuator"):
            at = spans[prefix]
            found.update(part.switches(at.fields(*p[at.first : at.last]), horizon))
    return found


def _joined(ticks: list[float], switches: set[float]) -> list[float]:
    """Ticks and switches in order; at the same instant a tick takes precedence, and the earlier of two switches."""
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
    steps, each = round(horizon / flights.step), round(period / flights.step)
    return [k * period for k in range(-(-steps // each))] + [horizon]
