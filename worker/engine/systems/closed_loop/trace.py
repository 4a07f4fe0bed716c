"""The trace of a case: time, pose, states, commands and separation as columns, and the closest approach.

States come from the compiled loop itself, so a trace shows exactly the simulation that gave the cost.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from campaigns import thin
from campaigns.results.base import FAILED, STATUS
from campaigns.results.trace import Closest, Realisation, TraceColumn, TraceHead, TraceObstacle
from campaigns.stored.records import Trace
from worker.engine.systems.base import Floats, in_own_sign
from worker.engine.systems.closed_loop.flights import Flights

POSE = 6
PLACES, PIECES = 4, 1000
"""Steps within which the closest approach of a channel with kinks is looked for, and the parts of each."""
Group = Literal["time", "pose", "state", "command", "separation"]


def trace(flights: Flights, name: str, values: Mapping[str, float], rows: int | None = None) -> Trace:
    """Simulate one case and return its trace; if `rows` is given, thinned to about that many except near the closest
    approach.

    With several realisations it shows the worst; the reported cost is that of the evaluation.
    values: parameters by path; missing ones are nominal. Raises KeyError for an unknown path.
    """
    case = simulate(flights, values)
    states, vector = case.states, case.vector
    seen = Seen(flights, flights.loop.observe(states, vector, flights.step), vector)
    closest = _closest(flights, seen, case)
    kept = _kept(len(states), rows, closest)
    data = np.column_stack(
        (
            kept * flights.step,
            seen.pose[kept],
            states[kept][:, _further(flights)],
            seen.commands[kept],
            seen.moving[kept],
            seen.criterion(seen.channels[kept]),
        )
    )
    return Trace(name, _columns(flights), data, _head(flights, seen, values, case, closest))


@dataclass(frozen=True)
class SimulatedCase:
    """One simulated case: the worst of several realisations, with the evaluation's costs and status."""

    vector: Floats
    """Its flat parameters (size,)."""
    states: Floats
    """States and held guidance at every step (steps + 1 at most, ...), up to a failure."""
    status: int
    reason: str
    costs: Floats
    """Costs of the evaluation (1, k); NaN unless it is ok."""
    realisation: int
    own_cost: float
    """Cost of the realisation shown."""


def simulate(flights: Flights, values: Mapping[str, float]) -> SimulatedCase:
    """Simulate one case; values: parameters by path, missing ones are nominal. Raises KeyError for an unknown path."""
    vectors = flights.realisations.flights(flights.vector(values)[None, :])
    several = len(vectors) > 1
    result = flights.loop.simulate(vectors, flights.step, *flights.counts(flights.step), traced=0 if several else 1)
    codes, whys = flights.judge(result.status, result.when)
    batch, reasons = flights.realisations.combined(result.costs, codes, whys)
    shown = flights.realisations.worst(result.costs, codes)
    states = result.trace[0] if not several else _again(flights, vectors[shown])
    finite = np.isfinite(states).all(axis=1)
    states = states[: int(np.argmin(finite)) if not finite.all() else len(states)]
    if codes[shown] == FAILED:  # the loop checks only every 64 steps; rows after the failure are meaningless
        states = states[: round(float(result.when[shown]) / flights.step) + 1]
    return SimulatedCase(
        vector=vectors[shown],
        states=states,
        status=int(batch.status[0]),
        reason=reasons.get(0, ""),
        costs=batch.costs[:1],
        realisation=shown,
        own_cost=float(result.costs[shown, 0]),
    )


def _again(flights: Flights, vector: Floats) -> Floats:
    """The states of one realisation, simulated again on its own: traces of all realisations would need too much memory.

    Results depend only on the vector, so this is bit for bit the simulation that gave the cost.
    """
    result = flights.loop.simulate(vector[None, :], flights.step, *flights.counts(flights.step), traced=1)
    states: Floats = result.trace[0]
    return states


def _values(flights: Flights, costs: Floats) -> dict[str, float | None]:
    """The value of every criterion by name, in its own sign; costs (1, k)."""
    names = [r.name for r in flights.results]
    return dict(zip(names, map(_known, in_own_sign(flights.results, costs)[0]), strict=True))


def _known(cost: float) -> float | None:
    return float(cost) if np.isfinite(cost) else None


class Seen:
    """A flight at some steps as `Loop.observe` shows it: pose, inputs and references, centres of the obstacles (rows,
    obstacles, 3), channels of all criteria."""

    def __init__(self, flights: Flights, columns: Floats, vector: Floats) -> None:
        self.flights, self.vector = flights, vector
        obstacles = flights.parts.obstacles
        last = columns.shape[1] - flights.loop.channels.total
        first = last - 3 * len(obstacles)
        self.pose, self.commands = columns[:, :POSE], columns[:, POSE:first]
        self.positions = columns[:, :3]
        self.centres = columns[:, first:last].reshape(len(columns), len(obstacles), 3)
        self.channels = columns[:, last:]
        self.deciding = self.channels[:, slice(*flights.loop.channels.of["criterion"])]
        """The channels of the deciding criterion; one per obstacle, if it is one of obstacles."""

    @property
    def moving(self) -> Floats:
        """The centres of the moving obstacles as columns."""
        moving = [i for i, o in enumerate(self.flights.parts.obstacles) if o.moving]
        return self.centres[:, moving, :].reshape(len(self.centres), 3 * len(moving))

    def criterion(self, channels: Floats) -> Floats:
        """The criterion's value for every row of channels."""
        cost, p = self.flights.loop.part("cost"), self.flights.loop.extend(self.vector)
        return np.array([cost(tuple(map(float, row)), p) for row in channels])

    def parameter(self, path: str) -> float:
        """The value of a parameter; 0 if the scenario has none of this path."""
        at = self.flights.paths.get(path)
        return 0.0 if at is None else float(self.vector[at])

    @property
    def goal(self) -> Floats:
        """The place of the goal [m]; not a number for an avoider with another kind of goal."""
        if "goal.x" not in self.flights.paths:
            return np.full(3, np.nan)
        return np.array([self.parameter(f"goal.{axis}") for axis in "xyz"])


def _further(flights: Flights) -> list[int]:
    """The indices of the vehicle's states that are not part of the pose."""
    vehicle = flights.parts.vehicle
    shown = {"x", "y", "z", "phi", "theta", "psi"} if vehicle.dimension == 3 else {"x", "y", "theta", "psi"}
    return [k for k, s in enumerate(vehicle.states) if s.name not in shown]


def _columns(flights: Flights) -> list[TraceColumn]:
    vehicle, signals, criterion = flights.parts.vehicle, flights.loop.signals, flights.parts.criterion

    def column(name: str, symbol: str, unit: str, group: Group) -> TraceColumn:
        return TraceColumn(name=name, symbol=symbol, unit=unit, group=group)

    commands = (*vehicle.inputs, *flights.parts.controller.signals)
    moving = [i for i, o in enumerate(flights.parts.obstacles) if o.moving]
    return [
        column("t", "t", "s", "time"),
        *(column(s.name, s.symbol, s.unit, "pose") for s in signals[:POSE]),
        *(column(s.name, s.symbol, s.unit, "state") for s in (vehicle.states[k] for k in _further(flights))),
        *(column(s.name, s.symbol, s.unit, "command") for s in commands),
        *(column(f"obstacle.{i}.{a}", a, "m", "pose") for i in moving for a in "xyz"),
        column("separation", "d", criterion.unit, "separation"),
    ]


def _closest(flights: Flights, seen: Seen, case: SimulatedCase) -> Closest | None:
    """Time, position and obstacle of the closest approach; its value is the cost, where there is one."""
    channels = seen.deciding
    if flights.parts.criterion.of != "obstacles" or channels.size == 0 or not np.isfinite(channels).all():
        return None
    row, obstacle, shift = _lowest(flights, seen, case)
    lowest = float(seen.criterion(seen.channels.min(axis=0, keepdims=True))[0])
    return Closest(
        time=(row + shift) * flights.step,
        row=row,
        value=case.own_cost if np.isfinite(case.own_cost) else lowest,
        position=_between(seen.positions, row, shift),
        speed=_speed(seen.positions, row, shift, flights.step),
        obstacle=obstacle,
        obstacle_position=_between(seen.centres[:, obstacle], row, shift),
    )


def _lowest(flights: Flights, seen: Seen, case: SimulatedCase) -> tuple[int, int, float]:
    """The step, the obstacle, and the fraction of a step after it at which the loop has found its minimum."""
    loop, channels = flights.loop, seen.deciding
    row, obstacle = (int(i) for i in np.unravel_index(np.argmin(channels), channels.shape))
    vertex = row, obstacle, _vertex(channels[:, obstacle], row)
    if len(channels) < 2 or not (loop.channels.searched or loop.channels.stops):
        return vertex
    found = _searched(flights, seen, case)
    stops = loop.part("stops")(loop.extend(case.vector)) if loop.channels.stops else ()
    beside = any(abs(stop / flights.step - found[0] - 0.5) < 1.5 for stop in stops)
    return found if loop.channels.searched or beside else vertex


def _vertex(channel: Floats, row: int) -> float:
    """How many steps after the lowest sample of a channel (rows,) the parabola through three of them is lowest."""
    if len(channel) < 3:
        return 0.0
    middle = min(max(row, 1), len(channel) - 2)
    left, mid, right = (float(c) for c in channel[middle - 1 : middle + 2])
    bend = left - 2 * mid + right
    shift = middle - row + 0.5 * (left - right) / bend if bend > 0 else 0.0
    return shift if -min(row, 0.5) <= shift <= min(len(channel) - 1 - row, 0.5) else 0.0


def _searched(flights: Flights, seen: Seen, case: SimulatedCase) -> tuple[int, int, float]:
    """The step, the obstacle, and the fraction of the step at which a channel with kinks is lowest.

    Of a channel that changes no faster within a step than between its neighbours, only some steps can be that one, and
    those in which an obstacle turns or stops.
    """
    channels = seen.deciding
    least = least_within(channels)
    found = (np.inf, 0, 0, 0.0)
    places = [np.unravel_index(place, least.shape) for place in np.argsort(least, axis=None, kind="stable")[:PLACES]]
    for row, obstacle in (*((int(i), int(k)) for i, k in places), *_turned(flights, case, len(least))):
        columns = flights.loop.observe(
            _within(flights, case, row), case.vector, flights.step / PIECES, first=row * PIECES
        )
        inside = Seen(flights, columns, case.vector).deciding[:, obstacle]
        at = int(np.argmin(inside))
        found = min(found, (float(inside[at]), row, obstacle, at / PIECES))
    return found[1:]


def least_within(channels: Floats) -> Floats:
    """What channels (rows, ...) may fall to within each step if they change no faster than between the neighbours."""
    change = np.abs(channels[1:] - channels[:-1])
    change = np.concatenate([change[:1], change, change[-1:]])
    fastest = np.maximum(np.maximum(change[:-2], change[1:-1]), change[2:])
    least: Floats = 0.5 * (channels[:-1] + channels[1:] - fastest)
    return least


def _turned(flights: Flights, case: SimulatedCase, steps: int) -> list[tuple[int, int]]:
    """The steps in which obstacles turn or stop, each with the obstacle."""
    loop = flights.loop
    if not loop.channels.turns:
        return []
    turns = loop.part("turns")(loop.extend(case.vector))
    found = [(t / flights.step, i) for t, (i, _) in zip(turns, loop.channels.turns, strict=True)]
    return [(int(at), obstacle) for at, obstacle in found if 0.0 < at < steps]


def _within(flights: Flights, case: SimulatedCase, row: int) -> Floats:
    """States within a step as the loop interpolates them, by the cubic through both ends, with the held guidance."""
    n, step, loop = flights.loop.n_state, flights.step, flights.loop
    p, guidance = loop.extend(case.vector), tuple(map(float, case.states[row, n:]))
    ends = [case.states[row + k, :n] for k in (0, 1)]
    rates = [
        np.array(loop.part("closed_loop")((row + k) * step, tuple(map(float, end)), guidance, p)[0])
        for k, end in enumerate(ends)
    ]
    s = np.linspace(0.0, 1.0, PIECES + 1)[:, None]
    states = ends[0] + s * s * (3.0 - 2.0 * s) * (ends[1] - ends[0])
    states = states + step * s * (1.0 - s) * ((1.0 - s) * rates[0] - s * rates[1])
    return np.column_stack((states, np.broadcast_to(guidance, (len(s), len(guidance)))))


def _between(positions: Floats, row: int, shift: float) -> list[float]:
    """The position a number of steps after a row, on the parabola through three rows about it."""
    if shift == 0.0 or len(positions) < 3:
        return [float(c) for c in positions[row]]
    middle = min(max(row, 1), len(positions) - 2)
    shift += row - middle
    back, here, ahead = positions[middle - 1 : middle + 2]
    here = here + 0.5 * shift * (ahead - back) + 0.5 * shift**2 * (back - 2 * here + ahead)
    return [float(c) for c in here]


def _speed(positions: Floats, row: int, shift: float, step: float) -> float | None:
    """The speed over ground on the parabola through three rows about a row [m/s]; None of fewer."""
    if len(positions) < 3:
        return None
    middle = min(max(row, 1), len(positions) - 2)
    back, here, ahead = positions[middle - 1 : middle + 2]
    moved = 0.5 * (ahead - back) + (shift + row - middle) * (back - 2 * here + ahead)
    return _known(float(np.linalg.norm(moved)) / step)


def _kept(count: int, rows: int | None, closest: Closest | None) -> Any:
    if rows is None or count <= rows:
        return np.arange(count)
    return np.union1d(thin.even(count, max(rows - 21, 2)), thin.near(count, closest.row if closest else 0, 10))


def _free(seen: Seen, i: int) -> float | None:
    """Radius of the disc around an obstacle's centre that must stay free [m]; None if that region is not a disc."""
    criterion, reach = seen.flights.parts.criterion, seen.flights.parts.obstacles[i].reach
    if criterion.measured_to != "surface":
        return seen.parameter("criterion.threshold")
    if reach is None or len(reach.of) != 1:
        return None
    surface = reach.times * seen.parameter(f"obstacles.{i}.{reach.of[0]}")
    return surface + seen.parameter("criterion.threshold") + seen.parameter("criterion.body_radius")


def _head(
    flights: Flights, seen: Seen, values: Mapping[str, float], case: SimulatedCase, closest: Closest | None
) -> TraceHead:
    obstacles = [
        TraceObstacle(
            component=o.name,
            title=o.title,
            position=[float(c) for c in seen.centres[0, i]] if len(seen.centres) else [],
            radius=seen.parameter(f"obstacles.{i}.radius"),
            free_radius=_free(seen, i),
            moving=o.moving,
        )
        for i, o in enumerate(flights.parts.obstacles)
    ]
    realised, realisation = flights.realisations, None
    if realised.seed_indices:
        realisation = Realisation(
            seed=realised.seeds[case.realisation],
            seeds=len(realised.seeds),
            combine=realised.combine,
            cost=_known(case.own_cost),
        )
    return TraceHead(
        frame=flights.parts.vehicle.frame,
        vehicle=flights.parts.vehicle.name,
        obstacles=obstacles,
        start=[seen.parameter(f"start.{axis}") for axis in "xyz"],
        goal=[seen.parameter(f"goal.{axis}") for axis in "xyz"],
        threshold=seen.parameter("criterion.threshold"),
        parameters={path: seen.parameter(path) for path in flights.campaign.uncertain} | dict(values),
        closest=closest,
        status=STATUS[case.status],
        reason=case.reason,
        cost=_known(case.costs[0, 0]),
        values=_values(flights, case.costs),
        realisation=realisation,
    )
