"""What an avoider asks for elsewhere: its demand over places of a horizontal plane, at one instant of a flight.

The avoider's own kernels are asked, undecorated, with the vehicle displaced in the plane of its height; its velocity
and attitude, the obstacles as it perceives them and the avoider's memory stay as they were when the loop asked at that
instant. Start reading at `field`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from worker.systems.base import Floats
from worker.systems.closed_loop.flights import Flights
from worker.systems.closed_loop.trace import Flown

UNITS = {"force": "N", "velocity": "m/s"}
MOST = 10_000
"""Places of one request."""


@dataclass(frozen=True)
class Field:
    """Demands in the world axes of the flight; the plane's have no z."""

    time: float
    """The step nearest to the time asked for, or the flight's last [s]."""
    place: Floats
    """Where the vehicle truly is (3,) [m]."""
    velocity: Floats
    """As navigation reports it (3,) [m/s]."""
    kind: str
    """force [N] or velocity [m/s]"""
    memory: int
    """Numbers that the avoider remembers."""
    own: Floats
    """The demand where the vehicle is (3,)."""
    demand: Floats
    """At every place (m, 3); what is no number is NaN."""


def field(flights: Flights, flown: Flown, time: float, places: Floats) -> Field:
    """The demands at places (m, 2), x and y [m] of the flight's axes, at a time [s] of a flight.

    The vehicle is taken to be mistaken there by as much as it is where it flies.
    """
    loop = flights.loop
    row = min(max(round(time / flights.step), 0), len(flown.states) - 1)
    at, p = row * flights.step, loop.extend(flown.vector)
    state = _numbers(flown.states[row, : loop.n_state])
    # The loop asked at this step with the memory that the step before had left.
    memory = loop.part("blank")(p) if row == 0 else _numbers(flown.states[row - 1, loop.n_state :])
    dimension = flights.parts.vehicle.dimension
    asked_at = loop.part("asked_at")

    def asked(place: Sequence[float]) -> Floats:
        return np.array([*asked_at(at, state, memory, tuple(place), p), 0.0][:3], dtype=np.float64)

    with np.errstate(all="ignore"):
        _, believed, velocity, _ = loop.part("aware")(at, state, p)
        true = loop.observe(flown.states[row : row + 1], flown.vector, flights.step)[0, :3]
        height = believed[2:dimension]
        error = np.array(believed[:2]) - true[:2]
        demand = np.array([_finite(asked, [*place, *height]) for place in (places + error).tolist()])
        own = _finite(asked, believed)
    full = np.zeros(3)
    full[:dimension] = velocity
    avoider = flights.parts.avoider
    return Field(at, true, full, avoider.demand, avoider.memory, own, demand.reshape(len(places), 3))


def _finite(asked: Any, place: Sequence[float]) -> Floats:
    """The demand at a place; NaN where plain Python refuses the arithmetic that compiled code carries on with."""
    try:
        found: Floats = asked(place)
    except ArithmeticError:
        return np.full(3, np.nan)
    return np.where(np.isfinite(found), found, np.nan)


def _numbers(row: Floats) -> tuple[float, ...]:
    return tuple(float(v) for v in row)
