"""From components to a compiled loop: lays out the flat parameter vector, fills every slot, compiles or stays plain.

Start reading at `assemble`; `Loop` is what the rest of the worker flies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from worker.kernels import glue, loop
from worker.kernels.bind import Function, bind, compile_loop, digest, filled, plain
from worker.kernels.component import (
    Avoider,
    Controller,
    Criterion,
    Declared,
    Obstacle,
    Signal,
    Vehicle,
    declared,
)
from worker.kernels.lanes import LaneOps, lane_ops, plain_ops

Floats = NDArray[np.float64]

LANES = 16
"""The one width. Measured: 16 makes a full batch 1.3 times faster than 8 and a single flight 1.5 times slower; searches
fly batches (DECISIONS.md)."""

FLOWN = ("extend", "initial", "blank", "guide", "closed_loop", "envelope", "cost", "barred")


@dataclass(frozen=True)
class Section:
    """Where a component's parameters stand in the flat vector, and under which prefix a campaign names them."""

    prefix: str
    first: int
    parameters: tuple[Declared, ...]

    @property
    def last(self) -> int:
        return self.first + len(self.parameters)


@dataclass(frozen=True)
class Parts:
    """The components of one closed loop."""

    vehicle: Vehicle
    controller: Controller
    avoider: Avoider
    obstacles: tuple[Obstacle, ...]
    criterion: Criterion
    sampled: bool = False


class Flown:
    """What `Loop.fly` returns: costs (n,), NaN unless ok; status (n,) and when (n,) [s] as in `loop.fly`; trace."""

    def __init__(self, n: int, trace: Floats) -> None:
        self.costs: Floats = np.empty(n)
        self.status: Floats = np.empty(n)
        self.when: Floats = np.empty(n)
        self.trace = trace


class Loop:
    """One closed loop, ready to fly; compiled at its first flight unless `compiled` is False."""

    def __init__(self, parts: Parts, lanes: int = LANES, compiled: bool = True) -> None:
        self.parts = parts
        self.lanes = lanes
        self.compiled = compiled
        self.sections = _sections(parts)
        self.size = self.sections[-1].last
        self.extended = _extended(parts, self.sections)
        self.n_vehicle = len(parts.vehicle.states)
        self.n_state = self.n_vehicle + parts.controller.states
        self.n_held = parts.vehicle.dimension + parts.avoider.memory
        self.n_channels = len(parts.obstacles)
        self._glue = _glue(self)
        self._plain: dict[str, Any] = {}

    @cached_property
    def _fly(self) -> Any:
        return self._made(loop.fly, FLOWN)

    @cached_property
    def _observe(self) -> Any:
        return self._made(loop.observe, ("extend", "observation"))

    @property
    def size_extended(self) -> int:
        """Length of the parameter vector with all derived constants."""
        return max(self.size, *(place.last for place in self.extended.values()))

    @property
    def signals(self) -> tuple[Signal, ...]:
        """Columns that `observe` gives, in order."""
        pose = [Signal(n, n, "m") for n in ("x", "y", "z")] + [Signal(n, n, "rad") for n in ("roll", "pitch", "yaw")]
        channels = tuple(Signal(f"channel.{i}", f"y{i}", "") for i in range(self.n_channels))
        return tuple(pose) + self.parts.vehicle.inputs + self.parts.controller.signals + channels

    def fly(self, params: Floats, step: float, steps: int, every: int = 1, traced: int = 0) -> Flown:
        """Fly every row of params (n, size); `traced` flights keep their states. Threads may fly at the same time.

        step [s]; every: steps per guidance sample, for sampled guidance.
        """
        if not self.parts.sampled:
            every = 1 if self.parts.avoider.memory else steps + 1
        params = np.ascontiguousarray(params, dtype=np.float64)
        trace = np.full((traced, steps + 1, self.n_state + self.n_held), np.nan)
        flown = Flown(len(params), trace)
        with np.errstate(all="ignore"):
            self._fly(params, step, steps, every, flown.costs, flown.status, flown.when, trace)
        return flown

    def warm(self) -> None:
        """Compile, or load from the disk cache, ahead of the first flight, so that its time is not counted as work."""
        self.fly(np.zeros((1, self.size)), 1.0, 1, traced=1)

    def observe(self, states: Floats, params: Floats, step: float) -> Floats:
        """The columns of `signals` for traced states (rows, ...) of one flight with params (size,)."""
        seen = np.empty((len(states), len(self.signals)))
        with np.errstate(all="ignore"):
            self._observe(np.ascontiguousarray(states), np.ascontiguousarray(params), step, seen)
        return seen

    def part(self, name: str) -> Function:
        """A part of the glue in plain Python: bodies, initial, blank, guide, closed_loop, envelope, cost, barred.

        All take the extended vector of parameters, which `extend` makes.
        """
        if name not in self._plain:
            self._plain[name] = plain(self._glue[name])
        return self._plain[name]  # type: ignore[no-any-return]

    @property
    def digest(self) -> str:
        """Identifies the loop: everything that its flights depend on but the parameters, the step and the machine."""
        return digest(self._filled(loop.fly, FLOWN))

    def extend(self, params: Floats) -> tuple[float, ...]:
        """The flat parameters (size,) with all derived constants behind them, as the parts take them."""
        return self.part("extend")(tuple(float(v) for v in params))  # type: ignore[no-any-return]

    def assembly(self) -> str:
        """The machine code of the compiled loop, for the report of what vectorises."""
        code: dict[Any, str] = self._fly.inspect_asm()
        return "\n".join(code.values())

    def _made(self, template: Function, names: tuple[str, ...]) -> Any:
        bound = self._filled(template, names)
        if not self.compiled:
            return plain(bound)
        return compile_loop(bound, f"{self.parts.vehicle.name}_{template.__name__}_{self.lanes}")

    def _filled(self, template: Function, names: tuple[str, ...]) -> Function:
        return filled(template, {name: self._glue[name] for name in names} | _layout(self))


def _sections(parts: Parts) -> tuple[Section, ...]:
    named: list[tuple[str, type]] = [
        ("vehicle", parts.vehicle.parameters),
        ("controller", parts.controller.parameters),
        ("avoider", parts.avoider.parameters),
        ("start", parts.vehicle.start),
        ("goal", parts.avoider.goal),
        ("criterion", parts.criterion.parameters),
        *((f"obstacles.{i}", o.parameters) for i, o in enumerate(parts.obstacles)),
    ]
    sections: list[Section] = []
    for prefix, fields in named:
        first = sections[-1].last if sections else 0
        sections.append(Section(prefix, first, declared(fields)))
    return tuple(sections)


@dataclass(frozen=True)
class Place:
    """Where a component's kernels find their parameters or derived constants in the extended vector."""

    fields: type
    first: int
    last: int


def _extended(parts: Parts, sections: Sequence[Section]) -> dict[str, Place]:
    """The places of vehicle, controller and avoider; derived constants stand behind all parameters."""
    end = sections[-1].last
    places: dict[str, Place] = {}
    for section in sections[:3]:
        part = getattr(parts, section.prefix)
        if part.derived is None:
            places[section.prefix] = Place(part.parameters, section.first, section.last)
        else:
            fields = part.derived.constants
            places[section.prefix] = Place(fields, end, end + len(fields._fields))
            end = places[section.prefix].last
    return places


def _layout(made: Loop) -> dict[str, Any]:
    lanes, n_x, n_p, n_g, n_y = made.lanes, made.n_state, made.size, made.n_held, made.n_channels
    rows = {
        "X": n_x, "A": n_x, "B": n_x, "C": n_x, "P": made.size_extended, "G": n_g,
        "Y0": n_y, "Y1": n_y, "Y2": n_y, "LOW": n_y, "STATUS": 1, "WHEN": 1,
    }  # fmt: skip
    n_e = made.size_extended
    slots: dict[str, Any] = {"N_X": n_x, "N_P": n_p, "N_E": n_e, "N_G": n_g, "N_Y": n_y, "LANES": lanes}
    offset = 0
    for name, count in rows.items():
        slots[name] = offset * lanes
        offset += count
    slots["SIZE"] = offset * lanes
    ops = lane_ops if made.compiled else plain_ops
    x, p, g, y = (_ops(ops, n, lanes) for n in (n_x, n_e, n_g, n_y))
    return slots | {
        "load_x": x.load, "store_x": x.store, "advance": x.advance, "combine": x.combine,
        "load_p": p.load, "store_p": p.store, "load_raw": _ops(ops, n_p, lanes).load,
        "load_g": g.load, "store_g": g.store, "load_y": y.load, "store_y": y.store,
    }  # fmt: skip


def _ops(make: Any, rows: int, lanes: int) -> LaneOps:
    return make(rows, lanes)  # type: ignore[no-any-return]


def _glue(made: Loop) -> dict[str, Any]:
    parts, sections = made.parts, {s.prefix: s for s in made.sections}
    kind = parts.avoider.demand
    slots: dict[str, Any] = {
        "N_V": made.n_vehicle,
        "N_X": made.n_state,
        "N_G": made.n_held,
        "DIMENSION": parts.vehicle.dimension,
        "NO_DEMAND": (0.0,) * parts.vehicle.dimension,
        **{name.title(): made.extended[name].fields for name in ("vehicle", "controller", "avoider")},
        "Start": parts.vehicle.start,
        "Goal": parts.avoider.goal,
        "Criterion": parts.criterion.parameters,
        **{k: getattr(parts.vehicle, k) for k in ("begin", "derivative", "position", "velocity", "outside", "pose")},
        "prepare": parts.controller.prepare[kind],
        "command": parts.controller.command[kind],
        "references": parts.controller.references[kind],
        "steer": parts.avoider.steer,
        "remember": parts.avoider.remember,
        "sample": parts.criterion.sample,
        "value": parts.criterion.value,
        "excluded": parts.criterion.excluded,
    }
    letters = {"V": "vehicle", "C": "controller", "A": "avoider", "S": "start", "G": "goal", "K": "criterion"}
    for letter, prefix in letters.items():
        place = made.extended.get(prefix, sections[prefix])
        slots[f"{letter}0"], slots[f"{letter}1"] = place.first, place.last
    slots["bodies"], slots["samples"] = _chains(parts.obstacles, sections, slots)
    slots["demand"] = bind(glue.held, slots) if parts.sampled else bind(glue.asked, slots)
    made_parts: dict[str, Any] = {"bodies": slots["bodies"], "extend": _extend(made)}
    for name in ("guide", "blank", "initial", "closed_loop", "envelope", "cost", "barred", "observation"):
        made_parts[name] = slots[name] = bind(getattr(glue, name), {k: v for k, v in slots.items() if k in vars(glue)})
    return made_parts


def _extend(made: Loop) -> Any:
    """The kernel that appends what each component derives from its parameters."""
    extend = bind(glue.as_given, {})
    for section in made.sections:
        part = getattr(made.parts, section.prefix, None)
        if part is not None and getattr(part, "derived", None) is not None:
            own = {"Given": part.parameters, "derive": part.derived.derive, "E0": section.first, "E1": section.last}
            extend = bind(glue.with_derived, own | {"before": extend})
    return extend


def _chains(obstacles: Sequence[Obstacle], sections: dict[str, Section], slots: dict[str, Any]) -> tuple[Any, Any]:
    """One kernel that gives the tuple of all bodies, and one that gives the channels of all of them."""
    bodies: Any = bind(glue.no_bodies, {})
    samples: Any = None
    for i, obstacle in enumerate(obstacles):
        section = sections[f"obstacles.{i}"]
        own = {"body": obstacle.body, "Obstacle": obstacle.parameters, "B0": section.first, "B1": section.last}
        template = glue.first_body if i == 0 else glue.more_bodies
        bodies = bind(template, own if i == 0 else own | {"before": bodies})
        link = {"sample": slots["sample"]} | ({} if i == 0 else {"before": samples, "INDEX": i})
        samples = bind(glue.first_sample if i == 0 else glue.more_samples, link)
    return bodies, samples
