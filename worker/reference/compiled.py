"""Compiles the reference integrator once, and every closed loop as a system for it to fly.

The components' plain Python functions are compiled again, strictly: no operation is reordered or fused, and the
elementary functions that have approximations in `kernels.maths` are the platform's. The integrator calls a system by
its address, so it is compiled once for all of them. Start reading at `system`.
"""

from __future__ import annotations

from functools import cache
from types import FunctionType
from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

from worker.kernels.bind import Function, compile_loop, digest, filled, identity, rebuilt
from worker.kernels.cache import kept_callback
from worker.kernels.lanes import lane_ops
from worker.reference import closed, flight, stepper
from worker.systems.closed_loop.assemble import LIBRARY, Loop

STRICT: dict[str, Any] = {"error_model": "numpy"}
"""A division by zero gives infinity, which ends the flight as not finite."""

BARE: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, **STRICT}
"""Of functions that are called by compiled code alone."""

PARTS = ("initial", "blank", "guide", "closed_loop", "envelope", "cost", "barred")

NUMBERS = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
SYSTEM = types.float64(types.int64, types.float64, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
"""(what, t, state, slope, channels, parameters) -> a number, as `stepper.call` says."""


def system(loop: Loop) -> Any:
    """A closed loop as a compiled function of C, kept on disk; its `address` is good for as long as it is kept."""
    return kept_callback(bound(loop), SYSTEM, **STRICT)


def bound(loop: Loop, keep: bool = True) -> Function:
    """A closed loop as a function to compile, its digest in its name; `keep`: noise is drawn once a stretch and kept.

    Noise changes only where a stretch begins. Drawn at each slope it took a quarter of a slope's time.
    """
    done: dict[int, Any] = {identity(kernel): _library(other) for kernel, other in LIBRARY.items()}
    drawn, kept = _noise(loop, done)
    done |= kept if keep else {}
    slots = {name: rebuilt(loop.kernel(name), done, _inlined) for name in PARTS} | {"drawn": drawn}
    counts = {"x": loop.n_state, "p": loop.size_extended + draws(loop), "g": loop.n_held}
    first, last = loop.channels.of["criterion"]
    slots |= {
        "N_X": counts["x"],
        "N_P": loop.size_extended,
        "N_D": draws(loop),
        "N_G": counts["g"],
        "N_Y": last - first,
        "Y0": first,
        "Y1": last,
    }
    slots["AHEAD"] = (0.0,) * first
    slots |= {f"load_{letter}": lane_ops(rows, 1).load for letter, rows in counts.items()}
    slots |= {"load_y": lane_ops(last - first, 1).load}
    slots |= {f"store_{letter}": lane_ops(counts[letter], 1).store for letter in "xg"}
    slots |= {"store_d": lane_ops(draws(loop), 1).store}
    slots |= {"store_y": lane_ops(last - first, 1).store}
    made = filled(closed.answer, slots)
    made.__qualname__ = f"{loop.parts.vehicle.name}_reference_{digest(made, STRICT)}"
    return made


def draws(loop: Loop) -> int:
    """How many numbers of noise a stretch keeps."""
    return sum(count for _, count in loop.drawing)


def _noise(loop: Loop, done: dict[int, Any]) -> tuple[Any, dict[int, Any]]:
    """What draws all noise, and by `identity` of what draws a part of it what reads that part where it is kept."""
    drawn, kept, at = _inlined(closed.none_drawn), {}, loop.size_extended
    for kernel, count in loop.drawing:
        drawn = _inlined(filled(closed.more_drawn, {"before": drawn, "one": rebuilt(kernel, dict(done), _inlined)}))
        kept[identity(kernel)] = _inlined(filled(closed.kept, {"D0": at, "D1": at + count}))
        at += count
    return drawn, kept


@cache
def integrator() -> Any:
    """`flight.fly` compiled, for any system by its address."""
    return compile_loop(rebuilt(flight.fly, {identity(stepper.call): _call}, _separate), "reference", STRICT)


def _separate(function: Function) -> Any:
    return function if function.__name__ == flight.fly.__name__ else njit(**BARE)(function)


def _inlined(function: Function) -> Any:
    return njit(forceinline=True, **BARE)(function)


def _library(function: Any) -> Any:
    return _inlined(function) if isinstance(function, FunctionType) else function


@intrinsic
def _call(context, system, what, t, b, at, to, y, p):  # type: ignore[no-untyped-def]
    """`stepper.call` of a system at an address."""
    signature = types.float64(system, types.int64, t, b, types.int64, types.int64, y, p)

    def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        system, what, t, b, at, to, y, p = arguments
        table, channels, given = (
            context.make_array(signature.args[k])(context, builder, value) for k, value in ((3, b), (6, y), (7, p))
        )
        width = builder.extract_value(table.shape, 1)
        rows = [builder.gep(table.data, [builder.mul(row, width)]) for row in (at, to)]
        double, number = ir.DoubleType(), ir.IntType(64)
        pointer = double.as_pointer()
        kind = ir.FunctionType(double, [number, double, pointer, pointer, pointer, pointer]).as_pointer()
        function = builder.inttoptr(system, kind)
        return builder.call(function, [what, t, *rows, channels.data, given.data])

    return signature, codegen
