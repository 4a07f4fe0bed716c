"""Builds a loop from components: lays out the flat parameter vector, generates the code that connects the components,
fills the loop's slots, and compiles it unless plain Python is requested.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import cached_property
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from worker.engine.kernels import guidance, loop, maths
from worker.engine.kernels.bind import Function, compile_loop, filled, plain
from worker.engine.kernels.component import Signal
from worker.engine.kernels.digest import digest
from worker.engine.kernels.lanes import LaneOps, lane_ops, plain_ops
from worker.engine.kernels.layout import Parts, channels, sections, spans, states
from worker.engine.kernels.scalars import quick
from worker.engine.kernels.text.module import loaded
from worker.engine.kernels.text.written import written
from worker.engine.systems.base import Floats

LANES = 16
"""The lane width. Measured: 16 makes a full batch 1.3 times faster than 8 and a single simulation 1.5 times slower;
searches evaluate batches (DECISIONS.md)."""

SHARED = 16
"""How many loops a process stores for further runs."""

LIBRARY: dict[Any, Function] = {
    maths.sincos: lambda x: (math.sin(x), math.cos(x)),
    maths.atan2: math.atan2,
    maths.log: math.log,
}
"""The platform's functions for the elementary functions of `maths`."""

_COMPILED = nullcontext()

SLOTS = ("extend", "initial", "initial_guidance", "guide", "closed_loop", "settled", "envelope", "costs_of", "excluded")


class Simulations:
    """The output of `Loop.simulate`: costs (n, k) of k criteria, the deciding one first, NaN unless ok; status (n,) and
    when (n,) [s] as in `loop.fly`; trace."""

    def __init__(self, n: int, k: int, trace: Floats) -> None:
        self.costs: Floats = np.empty((n, k))
        self.status: Floats = np.empty(n)
        self.when: Floats = np.empty(n)
        self.trace = trace


class Loop:
    """One closed loop, ready to simulate; compiled at its first simulation unless `compiled` is False."""

    def __init__(self, parts: Parts, lanes: int = LANES, compiled: bool = True) -> None:
        self.parts = parts
        self.lanes = lanes
        self.compiled = compiled
        self.sections = sections(parts)
        self.extended = spans(parts, self.sections)
        self.size = self.extended["trim"].last if "trim" in self.extended else self.sections[-1].last
        self.states = states(parts)
        self.n_state = self.states.total
        self.n_held = parts.vehicle.dimension * (1 + guidance.KEPT * parts.late) + parts.avoider.memory
        self.channels = channels(parts)
        self.text = written(parts)
        """The generated code that connects the components to the loop."""
        self.module = loaded(self.text, parts.vehicle.name)
        self._plain: dict[str, Callable[..., Any]] = {}

    @property
    def _slots(self) -> tuple[str, ...]:
        return (*SLOTS, *(name for name in ("stops", "turns") if getattr(self.channels, name)))

    @cached_property
    def _fly(self) -> Any:
        return self._made(loop.fly, self._slots)

    @cached_property
    def _observe(self) -> Any:
        return self._made(loop.observe, ("extend", "observation"))

    @cached_property
    def _ahead(self) -> Any:
        return self._made(loop.ahead, ("extend", "displaced"))

    @cached_property
    def _seen(self) -> int:
        """How many columns `observe` has."""
        return len(self.signals)

    @property
    def _quiet(self) -> AbstractContextManager[None]:
        """Compiled code gives no warnings of arithmetic; plain Python none within this."""
        return _COMPILED if self.compiled else np.errstate(all="ignore")

    @property
    def size_extended(self) -> int:
        """Length of the parameter vector with all derived constants."""
        return max(self.size, *(span.last for span in self.extended.values()))

    @property
    def signals(self) -> tuple[Signal, ...]:
        """The columns of `observe`, in order."""
        pose = [Signal(n, n, "m") for n in ("x", "y", "z")] + [Signal(n, n, "rad") for n in ("roll", "pitch", "yaw")]
        centres = [Signal(f"obstacle.{i}.{a}", a, "m") for i in range(len(self.parts.obstacles)) for a in "xyz"]
        channels = [Signal(f"channel.{i}", f"y{i}", "") for i in range(self.channels.total)]
        return (*pose, *self.parts.vehicle.inputs, *self.parts.controller.signals, *centres, *channels)

    def simulate(self, params: Floats, step: float, steps: int, every: int = 1, traced: int = 0) -> Simulations:
        """Simulate every row of params (n, size); the first `traced` ones store their states. Thread-safe.

        step [s]; every: steps per guidance sample, for sampled guidance.
        """
        if not self.parts.sampled:
            every = 1 if self.parts.avoider.memory else steps + 1
        params = np.ascontiguousarray(params, dtype=np.float64)
        trace = np.full((traced, steps + 1, self.n_state + self.n_held), np.nan)
        result = Simulations(len(params), len(self.parts.criteria), trace)
        # Comparisons inside components may lose a NaN, so rows with non-finite parameters are not simulated at all.
        finite: NDArray[np.bool_] = np.asarray(np.isfinite(params).all(axis=1))
        if not finite.all():
            fine = self.simulate(params[finite], step, steps, every, int(np.count_nonzero(finite[:traced])))
            result.costs[:], result.status[:], result.when[:] = np.nan, loop.NOT_FINITE, 0.0
            result.costs[finite], result.status[finite], result.when[finite] = fine.costs, fine.status, fine.when
            trace[finite[:traced]] = fine.trace
            return result
        with np.errstate(all="ignore"):
            self._fly(params, step, steps, every, result.costs, result.status, result.when, trace)
        return result

    def warm(self) -> None:
        """Compile, or load from the disk cache, so that this time is not counted as evaluation time."""
        self.simulate(np.zeros((1, self.size)), 1.0, 1, traced=1)

    def observe(self, states: Floats, params: Floats, step: float, first: int = 0) -> Floats:
        """The columns of `signals` for traced states (rows, ...), from step `first` on, of one simulation with params
        (size,)."""
        seen = np.empty((len(states), self._seen))
        with self._quiet:
            self._observe(np.ascontiguousarray(states), np.ascontiguousarray(params), step, first, seen)
        return seen

    def ahead(self, start: Floats, begin: float, rate: float, first: float, each: float, seen: Floats) -> Floats:
        """The channels of a vehicle that is moved along a straight line, at equal intervals.

        start: one after another the loop's state, place [m], velocity along the line and velocity as criteria see it
        [m/s], inputs, params; begin: the time at the place [s]; rate: 1, or 0 if time does not pass; first, each: the
        first instant after that, and the interval [s]; out: seen (rows, ...), which is returned.
        """
        with self._quiet:
            self._ahead(start, begin, rate, first, each, seen)
        return seen

    def bodies(self, time: float, state: Floats, place: Floats, p: tuple[float, ...]) -> Any:
        """The obstacles at a time [s] with the loop's state, as seen from a place; p: the extended parameters."""
        own = state[self.n_state - self.states.obstacles : self.n_state]
        return self.part("bodies")(time, tuple(map(float, own)), tuple(map(float, place)), p)

    def part(self, name: str) -> Function:
        """A function of the generated module in plain Python: bodies, initial, guide, closed_loop, cost, ...

        All take the extended parameter vector, which `extend` returns.
        """
        if name not in self._plain:
            self._plain[name] = plain(self.kernel(name))
        return self._plain[name]

    def kernel(self, name: str) -> Any:
        """The loop as a kernel, for other compiled code."""
        return vars(self.module)[name]

    @property
    def drawing(self) -> tuple[tuple[Any, int], ...]:
        """Kernels (t, extended parameters) -> noise that changes only at known instants; each with its sample count."""
        parts = enumerate(self.parts.environment)
        return tuple((self.kernel(f"drawn_{i}"), part.draws) for i, part in parts if part.draw is not None)

    @cached_property
    def digest(self) -> str:
        """Identifies the loop: everything that results depend on except the parameters, the step and the machine."""
        return digest(self.filled_template())

    def extend(self, params: Floats) -> tuple[float, ...]:
        """The flat parameters (size,) followed by all derived constants, as the functions of `part` take them."""
        return self.part("extend")(tuple(float(v) for v in params))  # type: ignore[no-any-return]

    def filled_template(self) -> Function:
        """The loop over time with its slots filled, as `loop.fly`; `bind.rebuilt` makes plain Python of it."""
        return self._filled(loop.fly, self._slots)

    def assembly(self) -> str:
        """The machine code of the compiled loop, for the vectorisation report."""
        code: dict[Any, str] = self._fly.inspect_asm()
        return "\n".join(code.values())

    def _made(self, template: Function, names: tuple[str, ...]) -> Any:
        bound = self._filled(template, names)
        if not self.compiled:
            return quick(bound)
        return compile_loop(bound, f"{self.parts.vehicle.name}_{template.__name__}_{self.lanes}")

    def _filled(self, template: Function, names: tuple[str, ...]) -> Function:
        return filled(template, {name: self.kernel(name) for name in names} | _layout(self))


_SHARED: OrderedDict[Any, Loop] = OrderedDict()
_SHARING = Lock()


def shared(parts: Parts, lanes: int = LANES, compiled: bool = True) -> Loop:
    """The loop of these parts; of the last `SHARED` ones the same for all, so that a second run in a process neither
    generates nor loads anything, unless something that its code uses has changed meanwhile. Thread-safe."""
    every = (parts.obstacles, parts.environment, parts.objectives)
    one = (parts.vehicle, parts.controller, parts.avoider, parts.criterion)
    faults = tuple((id(placed.fault), placed.on) for placed in parts.faults)
    # By identity: it lasts while the loop is stored, which refers to its parts.
    groups = tuple(tuple(map(id, group)) for group in (one, *every))
    key = groups, faults, parts.sampled, lanes, compiled
    with _SHARING:
        kept = _SHARED.get(key)
        if kept is None or digest(kept.filled_template()) != kept.digest:
            made = _SHARED[key] = Loop(parts, lanes, compiled)
            assert made.digest  # as it is before anything is compiled
        _SHARED.move_to_end(key)
        if len(_SHARED) > SHARED:
            _SHARED.popitem(last=False)
        return _SHARED[key]


def _layout(made: Loop) -> dict[str, object]:
    lanes, n_x, n_p, n_g, n_y = made.lanes, made.n_state, made.size, made.n_held, made.channels.total
    n_k = len(made.parts.criteria)
    channels, n_e = made.channels, made.size_extended
    rows = {
        "X": n_x, "A": n_x, "B": n_x, "C": n_x, "P": n_e, "G": n_g,
        "Y0": n_y, "Y1": n_y, "Y2": n_y, "LOW": n_y, "K": n_k, "STATUS": 1, "WHEN": 1,
    }  # fmt: skip
    n_q, n_u = made.parts.vehicle.dimension, len(made.parts.vehicle.inputs)
    n_s, n_t = len(channels.stops), len(channels.turns)
    searches = channels.searched > 0 or n_s > 0
    if searches:
        rows |= {"FROM": n_x, "RATE": n_x, "LAST": n_x, "HELD": n_g, "SEEN": n_y}
        rows |= dict.fromkeys(("NEAR", "LEFT", "RIGHT", "AT", "PREVIOUS"), 1) | {"STOP": n_s, "STOPPED": 1}
        rows |= {"TURN": n_t, "WITHIN": n_t, "LATEST": 1}
    slots: dict[str, object] = {"N_X": n_x, "N_P": n_p, "N_E": n_e, "N_G": n_g, "N_Y": n_y, "LANES": lanes}
    slots |= {"N_Q": n_q, "N_U": n_u, "REFINED": channels.refined, "SEARCHED": channels.refined + channels.searched}
    slots |= {"STEPS": n_y - channels.crossing, "N_K": n_k, "N_S": n_s, "N_T": n_t, "SEARCHES": searches}
    slots["SETTLES"] = made.parts.vehicle.settle is not None
    offset = 0
    for name, count in rows.items():
        slots[name] = offset * lanes
        offset += count
    slots["SIZE"] = offset * lanes
    ops: Callable[[int, int], LaneOps] = lane_ops if made.compiled else plain_ops
    x, p, g, y, q = (ops(n, lanes) for n in (n_x, n_e, n_g, n_y, n_q))
    return slots | {
        "load_x": x.load, "store_x": x.store, "advance": x.advance, "combine": x.combine,
        "load_p": p.load, "store_p": p.store, "load_raw": ops(n_p, lanes).load,
        "load_g": g.load, "store_g": g.store, "load_y": y.load, "store_y": y.store,
        "store_k": ops(n_k, lanes).store, "store_s": ops(n_s, lanes).store, "store_t": ops(n_t, lanes).store,
        "load_q": q.load, "advance_q": q.advance, "load_u": ops(n_u, lanes).load,
        "magnitude_x": x.magnitude, "magnitude_y": y.magnitude,
    }  # fmt: skip
