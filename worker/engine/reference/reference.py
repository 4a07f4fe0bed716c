"""Simulations with the reference integrator: the value of the deciding criterion, or why there is no value."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from worker.engine.reference.instants import Stretches, Timetable
from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.assemble import Loop
from worker.engine.systems.closed_loop.confirm import Flight
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.threads import usual_threads

NAME = "DOP853"

LOOKS = 200_000
"""The largest number of looks at obstacles that turn fast, for one simulation."""

_SYSTEMS: WeakKeyDictionary[Loop, Any] = WeakKeyDictionary()
"""Compiled systems and the integrator by loop, for as long as the loop exists."""


class Reference:
    """The reference integrator for one closed loop, compiled at first use; it is thread-safe."""

    name = NAME

    def __init__(self, flights: Flights) -> None:
        self.flights = flights
        self.timetable = Timetable(flights)

    def simulate(self, vector: Floats, counts: int | None = None) -> Flight:
        """Simulate one flat parameter vector (size,); the minimum over time comes from the dense output.

        If the worst of several realisations counts, only that one is simulated. counts: its seed, if known; otherwise
        the loop determines it at the campaign's step.
        """
        flights, realised = self.flights, self.flights.realisations
        if flights.parts.criterion.over == "crossing":
            return Flight(None, f"{NAME} does not locate crossings, which {flights.parts.criterion.title} needs")
        seeds = realised.seeds
        if realised.several and realised.combine == "worst":
            seeds = tuple(flights.simulate_realised(vector[None, :])[2] or ()) if counts is None else (counts,)
        simulated = [self._realised(realised.flight(vector[None, :], seed)[0]) for seed in seeds]
        for flight_, seed in zip(simulated, seeds, strict=True):
            if flight_.cost is None:
                return Flight(None, f"with seed {seed}: {flight_.reason}" if realised.several else flight_.reason)
        coarse = next((f.reason for f in simulated if f.reason), "")
        return Flight(float(np.mean([f.cost for f in simulated if f.cost is not None])), coarse)

    def simulate_all(
        self,
        vectors: Floats,
        cancelled: Callable[[], bool] = lambda: False,
        counts: Sequence[int | None] | None = None,
    ) -> list[Flight]:
        """Simulate vectors (m, size) on `usual_threads`. When cancelled, returns the results until then: fewer than m.

        counts: the deciding seed of each vector, as in `simulate`.
        """
        counts = [None] * len(vectors) if counts is None else counts
        threads = min(usual_threads(), len(vectors)) or 1
        simulated: list[Flight] = []
        if len(vectors):
            _ = self._system  # compile once, before the threads start
        with ThreadPoolExecutor(threads, thread_name_prefix="reference") as pool:
            while len(simulated) < len(vectors) and not cancelled():
                some = slice(len(simulated), len(simulated) + threads)
                simulated += pool.map(self.simulate, vectors[some], counts[some])
        return simulated

    @cached_property
    def _system(self) -> Any:
        from worker.engine.reference import compiled

        loop = self.flights.loop
        if loop not in _SYSTEMS:
            _SYSTEMS[loop] = compiled.system(loop), compiled.integrator()
        return _SYSTEMS[loop]

    def _realised(self, vector: Floats) -> Flight:
        loop, found = self.flights.loop, np.zeros(6)
        if not np.isfinite(vector).all():
            return Flight(None, f"{NAME} could not simulate it: a parameter is not a finite number")
        try:
            p = loop.extend(vector)
            stretches = self.timetable.of(p)
        except (ArithmeticError, ValueError) as error:
            return Flight(None, f"{NAME} could not simulate it: {error}")
        self._fly(p, stretches, found)
        return self._judged(found)

    def _fly(self, p: tuple[float, ...], stretches: Stretches, found: Floats) -> None:
        from worker.engine.reference import compiled, flight
        from worker.engine.reference.stepper import CHANNEL_ROWS, ROWS

        loop = self.flights.loop
        system, fly = self._system
        first, last = loop.channels.of["criterion"]
        states, channels = np.zeros((ROWS, loop.n_state)), np.zeros((CHANNEL_ROWS, last - first))
        parameters = np.array((*p, *(0.0,) * (compiled.draws(loop) + loop.n_held)))
        where = stretches.instants, stretches.asks, stretches.turns, stretches.before, stretches.patience
        control = np.zeros(5)
        control[flight.LOOK] = max(self.flights.look(p), self.timetable.horizon / LOOKS)
        fly(system.address, *where, states, channels, parameters, control, found)

    def _judged(self, found: Floats) -> Flight:
        from worker.engine.reference import flight  # imported late: a campaign's process must start fast

        cost, code, when, since, why, noticed = (float(v) for v in found)
        if code < flight.OK:
            return Flight(None, f"{NAME} could not simulate it: {_stuck(code == flight.STUCK, when)}")
        if code != flight.OK:
            _, reasons = self.flights.judge(np.array([code]), np.array([when]))
            return Flight(None, f"{NAME}: {reasons[0]}")
        if not np.isfinite(cost):
            return Flight(None, f"{NAME}: {self.flights.parts.criterion.quantity} is not a finite number")
        if why == flight.OK:
            return Flight(cost)
        stuck = _stuck(why == flight.STUCK, noticed)
        return Flight(cost, f"with a tolerance of {flight.COARSE:g} from t = {since:.6g} s: {stuck}")


def _stuck(chatters: bool, when: float) -> str:
    if chatters:
        return f"the loop chatters (switches back and forth without progress) from t = {when:.6g} s"
    return f"at t = {when:.6g} s the required step is below the floating-point spacing of time"
