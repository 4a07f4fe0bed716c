"""The field of an avoider: its demand over positions in a horizontal plane, at one instant of a simulation.

The avoider's kernels are evaluated in plain Python with the vehicle displaced at constant height. Its velocity and
attitude, the perceived obstacles and the avoider's memory stay as they were in the loop at that instant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.trace import SimulatedCase

UNITS = {"force": "N", "velocity": "m/s"}
MOST = 10_000
"""Largest number of positions per request."""


@dataclass(frozen=True)
class Field:
    """Demands in the scenario's world axes; z is 0 in the plane."""

    time: float
    """The step nearest to the requested time, at most the last one [s]."""
    place: Floats
    """True position of the vehicle (3,) [m]."""
    velocity: Floats
    """As navigation reports it (3,) [m/s]."""
    kind: str
    """force [N] or velocity [m/s]"""
    memory: int
    """Size of the avoider's memory."""
    own: Floats
    """The demand at the vehicle's position (3,)."""
    demand: Floats
    """The demand at every requested position (m, 3); NaN if not finite."""


def field(flights: Flights, case: SimulatedCase, time: float, positions: Floats) -> Field:
    """The demands at positions (m, 2), x and y [m] in world axes, at a time [s] of a simulated case.

    The navigation error at these positions is the one at the vehicle's actual position.
    """
    loop = flights.loop
    row = min(max(round(time / flights.step), 0), len(case.states) - 1)
    at, p = row * flights.step, loop.extend(case.vector)
    state = _numbers(case.states[row, : loop.n_state])
    # The loop evaluates the avoider at this step with the memory left by the step before.
    memory = loop.part("initial_guidance")(p) if row == 0 else _numbers(case.states[row - 1, loop.n_state :])
    dimension = flights.parts.vehicle.dimension
    avoider_demand_at = loop.part("avoider_demand_at")

    def demand_at(position: Sequence[float]) -> Floats:
        return np.array([*avoider_demand_at(at, state, memory, tuple(position), p), 0.0][:3], dtype=np.float64)

    with np.errstate(all="ignore"):
        _, believed, velocity, _ = loop.part("measurements")(at, state, p)
        true = loop.observe(case.states[row : row + 1], case.vector, flights.step)[0, :3]
        height = believed[2:dimension]
        error = np.array(believed[:2]) - true[:2]
        demand = np.array([_finite(demand_at, [*position, *height]) for position in (positions + error).tolist()])
        own = _finite(demand_at, believed)
    full = np.zeros(3)
    full[:dimension] = velocity
    avoider = flights.parts.avoider
    return Field(at, true, full, avoider.demand, avoider.memory, own, demand.reshape(len(positions), 3))


def _finite(demand_at: Any, position: Sequence[float]) -> Floats:
    """The demand at a position; NaN if plain Python raises where compiled code continues with infinity or NaN."""
    try:
        found: Floats = demand_at(position)
    except ArithmeticError:
        return np.full(3, np.nan)
    return np.where(np.isfinite(found), found, np.nan)


def _numbers(row: Floats) -> tuple[float, ...]:
    return tuple(float(v) for v in row)
