"""The layout of the flat parameter vector and of the loop's state.

Parameters: vehicle, controller, avoider, start, goal, criterion, then obstacles, environment, faults and further
criteria as the campaign lists them; then the vehicle's trim; then the constants that components derive. State: vehicle,
controller, actuators, environment, obstacles.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

from worker.engine.kernels.component import (
    Avoider,
    Component,
    Controller,
    Criterion,
    Declared,
    Derived,
    Environment,
    Fault,
    Obstacle,
    Vehicle,
    declared,
)


@dataclass(frozen=True)
class Placed:
    """A fault and, for an actuator fault, the index of the input that it acts on."""

    fault: Fault
    on: int = 0


@dataclass(frozen=True)
class Parts:
    """The components of one closed loop."""

    vehicle: Vehicle
    controller: Controller
    avoider: Avoider
    obstacles: tuple[Obstacle, ...]
    criterion: Criterion
    environment: tuple[Environment, ...] = ()
    faults: tuple[Placed, ...] = ()
    sampled: bool = False
    objectives: tuple[Criterion, ...] = ()
    """Further criteria besides the deciding one."""

    @property
    def criteria(self) -> dict[str, Criterion]:
        """All criteria by the prefix of their parameters, the deciding one first."""
        return {"criterion": self.criterion} | {f"objectives.{i}": c for i, c in enumerate(self.objectives)}

    @property
    def named(self) -> dict[str, Component]:
        """Every component by the prefix of its parameters."""
        found: dict[str, Component] = {"vehicle": self.vehicle, "controller": self.controller, "avoider": self.avoider}
        found |= self.criteria
        found |= {f"obstacles.{i}": o for i, o in enumerate(self.obstacles)}
        found |= {f"environment.{i}": e for i, e in enumerate(self.environment)}
        return found | {f"faults.{i}": placed.fault for i, placed in enumerate(self.faults)}

    @property
    def late(self) -> bool:
        """Whether a fault delays sampled guidance, so that earlier demands must be stored."""
        return self.sampled and any(f.fault.path == "guidance" for f in self.faults)


@dataclass(frozen=True)
class Span:
    """The position of a component's parameters or derived constants in the extended vector."""

    fields: type
    first: int
    last: int


@dataclass(frozen=True)
class Section(Span):
    """The position of a component's parameters, which come first in the vector, and their prefix in a campaign."""

    prefix: str
    parameters: tuple[Declared, ...]


def sections(parts: Parts) -> tuple[Section, ...]:
    """The sections of the flat vector, in order."""
    first, last = ("vehicle", "controller", "avoider"), list(parts.criteria)[1:]
    fields = {prefix: part.parameters for prefix, part in parts.named.items()}
    named = {prefix: fields[prefix] for prefix in first}
    named |= {"start": parts.vehicle.start, "goal": parts.avoider.goal}
    named |= {prefix: fields[prefix] for prefix in fields if prefix not in last}
    named |= {prefix: fields[prefix] for prefix in last}
    found: list[Section] = []
    for prefix, own in named.items():
        at, parameters = found[-1].last if found else 0, declared(own)
        found.append(Section(own, at, at + len(parameters), prefix, parameters))
    return tuple(found)


def derivations(parts: Parts, flat: Sequence[Section]) -> Iterator[tuple[Section, Derived]]:
    """The sections whose components derive constants from them, in order."""
    known = parts.named
    for section in flat:
        part = known.get(section.prefix)
        if part is not None and part.derived is not None:
            yield section, part.derived


def spans(parts: Parts, flat: Sequence[Section]) -> dict[str, Span]:
    """The span that each component receives; trim and derived constants follow all parameters."""
    end = flat[-1].last
    found: dict[str, Span] = {s.prefix: s for s in flat}
    if parts.vehicle.trim is not None:
        fields: Any = parts.vehicle.trim.fields
        found["trim"] = Span(fields, end, end + len(fields._fields))
        end = found["trim"].last
    for section, derived in derivations(parts, flat):
        constants: Any = derived.constants
        found[section.prefix] = Span(constants, end, end + len(constants._fields))
        end = found[section.prefix].last
    return found


@dataclass(frozen=True)
class States:
    """The number of states of each part, in the order of the state vector."""

    vehicle: int
    controller: int
    actuators: int
    environment: int
    obstacles: int

    @property
    def total(self) -> int:
        return self.vehicle + self.controller + self.actuators + self.environment + self.obstacles


def states(parts: Parts) -> States:
    """How many states each part of the loop has."""
    return States(
        len(parts.vehicle.states),
        parts.controller.states,
        sum(f.fault.states for f in parts.faults if f.fault.path == "actuator"),
        sum(e.states for e in parts.environment),
        sum(o.states for o in parts.obstacles),
    )


@dataclass(frozen=True)
class Channels:
    """The channels of all criteria, grouped by reduction: the size of each group, the range of each criterion."""

    refined: int
    searched: int
    steps: int
    crossing: int
    of: dict[str, tuple[int, int]]
    """First and last channel of each criterion by prefix, in channel order."""
    stops: tuple[int, ...] = ()
    """The obstacles whose stops the parabola of a channel does not follow."""
    turns: tuple[tuple[int, int], ...] = ()
    """The legs that divide the steps in which they end, if channels of obstacles are searched: obstacle, leg from 0."""

    @cached_property
    def total(self) -> int:
        return self.refined + self.searched + self.steps + self.crossing


def channels(parts: Parts) -> Channels:
    """The channels of each criterion: one, or one per obstacle."""
    of: dict[str, tuple[int, int]] = {}
    ends = [0]
    for over in ("refined", "searched", "steps", "crossing"):
        end = ends[-1]
        for prefix, criterion in parts.criteria.items():
            if _over(criterion, parts.obstacles) == over:
                of[prefix] = end, end + (len(parts.obstacles) if criterion.of == "obstacles" else 1)
                end = of[prefix][1]
        ends.append(end)
    refined, searched, steps, crossing = (end - begin for begin, end in pairwise(ends))
    followed = [criterion for criterion in parts.criteria.values() if criterion.of == "obstacles"]
    stop = any(_over(criterion, parts.obstacles) == "refined" for criterion in followed)
    stops = [i for i, o in enumerate(parts.obstacles) if stop and o.rate is not None and o.rate.stops]
    between = any(_over(criterion, parts.obstacles) in ("refined", "searched") for criterion in followed)
    turns = [(i, k) for i, o in enumerate(parts.obstacles) if between for k in range(_legs(o))]
    return Channels(refined, searched, steps, crossing, of, tuple(stops), tuple(turns))


def _legs(obstacle: Obstacle) -> int:
    """How many legs with known ends the path of an obstacle has."""
    rate = obstacle.rate
    if rate is None:
        return 0
    return 1 if rate.stops else max(0, len(rate.legs) - 1)


def _over(criterion: Criterion, obstacles: Sequence[Obstacle]) -> str:
    """How its channels are reduced: the parabola does not follow an obstacle that turns at a corner, unless all that
    it does is to stop at a known instant."""
    corners = any(o.rate is not None and o.rate.legs and not o.rate.stops for o in obstacles)
    return "searched" if criterion.over == "refined" and criterion.of == "obstacles" and corners else criterion.over
