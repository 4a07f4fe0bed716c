"""From components to a compiled loop: lays out the flat parameter vector, fills every slot, compiles or stays plain.

Start reading at `assemble`; `Loop` is what the rest of the worker flies.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from worker.kernels import glue, guidance, links, loop, maths
from worker.kernels.bind import Function, bind, compile_loop, digest, filled, plain
from worker.kernels.chains import chains
from worker.kernels.component import Signal
from worker.kernels.lanes import LaneOps, lane_ops, plain_ops
from worker.kernels.layout import Parts, channels, derivations, places, sections, states

Floats = NDArray[np.float64]

LANES = 16
"""The one width. Measured: 16 makes a full batch 1.3 times faster than 8 and a single flight 1.5 times slower; searches
fly batches (DECISIONS.md)."""

LIBRARY: dict[Any, Function] = {
    maths.sincos: lambda x: (math.sin(x), math.cos(x)),
    maths.atan2: math.atan2,
    maths.log: math.log,
}
"""What the platform has in place of the elementary functions of `maths`."""

FLOWN = ("extend", "initial", "blank", "guide", "closed_loop", "settled", "envelope", "costs_of", "barred")


class Flown:
    """What `Loop.fly` returns: costs (n, k) of k criteria, the one that decides first, NaN unless ok; status (n,) and
    when (n,) [s] as in `loop.fly`; trace."""

    def __init__(self, n: int, k: int, trace: Floats) -> None:
        self.costs: Floats = np.empty((n, k))
        self.status: Floats = np.empty(n)
        self.when: Floats = np.empty(n)
        self.trace = trace


class Loop:
    """One closed loop, ready to fly; compiled at its first flight unless `compiled` is False."""

    def __init__(self, parts: Parts, lanes: int = LANES, compiled: bool = True) -> None:
        self.parts = parts
        self.lanes = lanes
        self.compiled = compiled
        self.sections = sections(parts)
        self.extended = places(parts, self.sections)
        self.size = self.extended["trim"].last if "trim" in self.extended else self.sections[-1].last
        self.states = states(parts)
        self.n_state = self.states.total
        self.n_held = parts.vehicle.dimension * (1 + guidance.KEPT * parts.late) + parts.avoider.memory
        self.channels = channels(parts)
        self._glue = _glue(self)
        self._plain: dict[tuple[str, bool], Any] = {}

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
        centres = [Signal(f"obstacle.{i}.{a}", a, "m") for i in range(len(self.parts.obstacles)) for a in "xyz"]
        channels = [Signal(f"channel.{i}", f"y{i}", "") for i in range(self.channels.total)]
        return (*pose, *self.parts.vehicle.inputs, *self.parts.controller.signals, *centres, *channels)

    def fly(self, params: Floats, step: float, steps: int, every: int = 1, traced: int = 0) -> Flown:
        """Fly every row of params (n, size); `traced` flights keep their states. Threads may fly at the same time.

        step [s]; every: steps per guidance sample, for sampled guidance.
        """
        if not self.parts.sampled:
            every = 1 if self.parts.avoider.memory else steps + 1
        params = np.ascontiguousarray(params, dtype=np.float64)
        trace = np.full((traced, steps + 1, self.n_state + self.n_held), np.nan)
        flown = Flown(len(params), len(self.parts.criteria), trace)
        with np.errstate(all="ignore"):
            self._fly(params, step, steps, every, flown.costs, flown.status, flown.when, trace)
        # Comparisons inside components may swallow a NaN: a flight of parameters that are no numbers is none.
        wrong = ~np.isfinite(params).all(axis=1)
        flown.costs[wrong], flown.status[wrong], flown.when[wrong] = np.nan, loop.NOT_FINITE, 0.0
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

    def part(self, name: str, library: bool = False) -> Function:
        """A part of the glue in plain Python: bodies, initial, blank, guide, asked_at, closed_loop, envelope, cost, ...

        All take the extended vector of parameters, which `extend` makes. With `library` they call the platform's
        elementary functions, in place of those of `maths`.
        """
        if (name, library) not in self._plain:
            self._plain[name, library] = plain(self._glue[name], LIBRARY if library else None)
        return self._plain[name, library]  # type: ignore[no-any-return]

    def kernel(self, name: str) -> Any:
        """The same part as a kernel, for other compiled code."""
        return self._glue[name]

    @property
    def drawing(self) -> tuple[tuple[Any, int], ...]:
        """Kernels (t, extended parameters) -> noise that changes at known instants alone; each with its count."""
        return self._glue["drawing"]  # type: ignore[no-any-return]

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


def _layout(made: Loop) -> dict[str, Any]:
    lanes, n_x, n_p, n_g, n_y = made.lanes, made.n_state, made.size, made.n_held, made.channels.total
    n_k = len(made.parts.criteria)
    rows = {
        "X": n_x, "A": n_x, "B": n_x, "C": n_x, "P": made.size_extended, "G": n_g,
        "Y0": n_y, "Y1": n_y, "Y2": n_y, "LOW": n_y, "K": n_k, "STATUS": 1, "WHEN": 1,
    }  # fmt: skip
    n_e = made.size_extended
    slots: dict[str, Any] = {"N_X": n_x, "N_P": n_p, "N_E": n_e, "N_G": n_g, "N_Y": n_y, "LANES": lanes}
    slots |= {"N_R": made.channels.refined, "N_S": made.channels.steps, "N_K": n_k}
    slots["SETTLES"] = made.parts.vehicle.settle is not None
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
        "store_k": _ops(ops, n_k, lanes).store,
        "magnitude_x": x.magnitude, "magnitude_y": y.magnitude,
    }  # fmt: skip


def _ops(make: Any, rows: int, lanes: int) -> LaneOps:
    return make(rows, lanes)  # type: ignore[no-any-return]


def _glue(made: Loop) -> dict[str, Any]:
    """The parts of the glue that the loop calls, every slot filled."""
    slots = _constants(made) | _components(made.parts) | chains(made.parts, made.extended)
    slots["kept"] = _filled(guidance.four_kept if made.parts.late else guidance.none_kept, slots)
    slots["demand"] = _filled(_demand(made.parts), slots)
    slots |= _translation(made.parts, slots)
    parts = {"extend": _extend(made)} | {name: slots[name] for name in ("bodies", "costs_of", "on_sample", "drawing")}
    names = (
        "aware",
        "asked_at",
        "guide",
        "blank",
        "initial",
        "closed_loop",
        "settled",
        "envelope",
        "cost",
        "barred",
        "observation",
    )
    for name in names:
        parts[name] = slots[name] = _filled(getattr(glue, name), slots)
    return parts


def _demand(parts: Parts) -> Function:
    if not parts.sampled:
        return guidance.asked
    return guidance.waited if parts.late else guidance.held


def _steer(parts: Parts) -> Any:
    """The avoider's kernel; of one that weighs the obstacles, with them all in a row."""
    avoider = parts.avoider
    if avoider.weigh is None:
        return avoider.steer
    weighed = bind(links.unweighed, {"first": avoider.first})
    for i in range(len(parts.obstacles)):
        weighed = bind(links.more_weighed, {"weigh": avoider.weigh, "before": weighed, "INDEX": i})
    return bind(guidance.steered, {"decide": avoider.steer, "weighed": weighed})


def _translation(parts: Parts, slots: dict[str, Any]) -> dict[str, Any]:
    """Where a demand becomes the controller's: at the sample; but one that comes late is blended as it was given."""
    once = parts.sampled and not parts.late
    plainly = bind(guidance.as_demanded, {})
    if parts.controller.translate is None:
        return {"on_sample": plainly, "on_use": plainly}
    with_it = _filled(guidance.translated, slots | {"translate": parts.controller.translate[parts.avoider.demand]})
    return {"on_sample": with_it, "on_use": plainly} if once else {"on_sample": plainly, "on_use": with_it}


def _filled(template: Function, slots: dict[str, Any]) -> Any:
    return bind(template, {k: v for k, v in slots.items() if k in template.__globals__})


def _constants(made: Loop) -> dict[str, Any]:
    dimension, late = made.parts.vehicle.dimension, made.parts.late
    slots: dict[str, Any] = {
        **made.states.slots(),
        "N_X": made.n_state,
        "N_G": made.n_held,
        "DIMENSION": dimension,
        "NO_DEMAND": (0.0,) * dimension,
        "M1": dimension + made.parts.avoider.memory,
        "M2": made.n_held - dimension,
        "NOTHING_KEPT": (0.0,) * (guidance.KEPT * dimension * late),
    }
    letters = {"V": "vehicle", "C": "controller", "A": "avoider", "S": "start", "G": "goal", "K": "criterion"}
    for letter, prefix in letters.items():
        place = made.extended[prefix]
        slots[prefix.title()] = place.fields
        slots[f"{letter}0"], slots[f"{letter}1"] = place.first, place.last
    slots["Y0"], slots["Y1"] = made.channels.of["criterion"]
    return slots


def _components(parts: Parts) -> dict[str, Any]:
    kind = parts.avoider.demand
    names = ("begin", "derivative", "position", "velocity", "outside", "pose", "measured")
    return {
        **{name: getattr(parts.vehicle, name) for name in names},
        "settle": parts.vehicle.settle or glue.settle,
        "felt": parts.vehicle.felt or bind(glue.as_measured, {}),
        "prepare": parts.controller.prepare[kind],
        "command": parts.controller.command[kind],
        "references": parts.controller.references[kind],
        "steer": _steer(parts),
        "remember": parts.avoider.remember,
        "value": parts.criterion.value,
        "excluded": parts.criterion.excluded,
    }


def _extend(made: Loop) -> Any:
    """The kernel that appends what each component derives from its parameters."""
    extend = bind(links.as_given, {})
    balance = bind(links.no_balance, {})
    trim = made.extended.get("trim")
    if trim is not None:
        balance = bind(links.balanced, {"Trimmed": trim.fields, "T0": trim.first, "T1": trim.last})
    for section, derived in derivations(made.parts, made.sections):
        own = {"Given": section.fields, "derive": derived.derive, "E0": section.first, "E1": section.last}
        extend = bind(links.with_derived, own | {"before": extend, "balance": balance})
    return extend
