"""Compiles the reference integrator once, and every closed loop as a system for it.

The components' plain Python functions are compiled again without fast-math: no operation is reordered or fused, and
elementary functions are the platform's, not the approximations of `kernels.maths`. The integrator calls a system by
address, so that one compiled integrator serves all systems.
"""

from __future__ import annotations

from functools import cache
from types import FunctionType
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from worker.engine.kernels.bind import Function, compile_loop, filled, identity, rebuilt
from worker.engine.kernels.cached import cached_callback
from worker.engine.kernels.digest import digest
from worker.engine.kernels.lanes import lane_ops
from worker.engine.kernels.numba_internals import linked
from worker.engine.reference import closed, flight, stepper
from worker.engine.systems.closed_loop.assemble import LIBRARY, Loop

STRICT: dict[str, str] = {"error_model": "numpy"}
"""A division by zero gives infinity, which ends the simulation as not finite."""

PARTS = ("initial", "initial_guidance", "guide", "closed_loop", "envelope", "cost", "excluded")

NUMBERS = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
SYSTEM = types.float64(types.int64, types.float64, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
"""(what, t, state, slope, channels, parameters) -> a number, as described in `stepper.call`."""


def system(loop: Loop) -> Any:
    """A closed loop as a compiled C callback, cached on disk; its `address` is valid while the object exists."""
    return cached_callback(bound(loop), SYSTEM, **STRICT)


def bound(loop: Loop, keep: bool = True) -> Function:
    """A closed loop as a function to compile, with its digest in its name; keep: draw noise once per stretch.

    Noise changes only where a stretch begins. Drawing it for every slope took a quarter of the slope's time.
    """
    done: dict[int, Any] = {
        identity(kernel): _inlined(other) if isinstance(other, FunctionType) else other
        for kernel, other in LIBRARY.items()
    }
    drawn, stored = _noise(loop, done)
    done |= stored if keep else {}
    slots = {name: rebuilt(loop.kernel(name), done, _inlined) for name in PARTS} | {"drawn": drawn}
    first, last = loop.channels.of["criterion"]
    sizes = {"x": loop.n_state, "d": draws(loop), "g": loop.n_held, "y": last - first}
    slots |= {f"N_{letter.upper()}": size for letter, size in sizes.items()}
    slots |= {"N_P": loop.size_extended, "Y0": first, "Y1": last, "AHEAD": (0.0,) * first}
    sizes["p"] = loop.size_extended + draws(loop)
    slots |= {f"load_{letter}": lane_ops(sizes[letter], 1).load for letter in "xpgy"}
    slots |= {f"store_{letter}": lane_ops(sizes[letter], 1).store for letter in "xdgy"}
    made = filled(closed.answer, slots)
    made.__qualname__ = f"{loop.parts.vehicle.name}_reference_{digest(made, STRICT)}"
    return made


def draws(loop: Loop) -> int:
    """The number of noise samples stored per stretch."""
    return sum(count for _, count in loop.drawing)


def _noise(loop: Loop, done: dict[int, Any]) -> tuple[Any, dict[int, Any]]:
    """The function that draws all noise; and the functions that read stored noise, by `identity` of what drew it."""
    drawn, stored, at = _inlined(closed.none_drawn), {}, loop.size_extended
    for kernel, count in loop.drawing:
        drawn = _inlined(filled(closed.more_drawn, {"before": drawn, "one": rebuilt(kernel, dict(done), _inlined)}))
        stored[identity(kernel)] = _inlined(filled(closed.stored, {"D0": at, "D1": at + count}))
        at += count
    return drawn, stored


@cache
def integrator() -> Any:
    """`flight.fly`, compiled for any system by address."""
    return compile_loop(rebuilt(flight.fly, {identity(stepper.call): _call}, _separate), "reference", STRICT)


def _separate(function: Function) -> Any:
    return function if function.__name__ == flight.fly.__name__ else linked(function, **STRICT)


def _inlined(function: Function) -> Any:
    return linked(function, forceinline=True, **STRICT)


@intrinsic
def _call(context, system, what, t, b, at, to, y, p):  # type: ignore[no-untyped-def]
    signature = types.float64(system, types.int64, t, b, types.int64, types.int64, y, p)

    def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        system, what, t, b, at, to, y, p = arguments
        table, channels, parameters = (
            context.make_array(signature.args[k])(context, builder, value) for k, value in ((3, b), (6, y), (7, p))
        )
        width = builder.extract_value(table.shape, 1)
        rows = [builder.gep(table.data, [builder.mul(row, width)]) for row in (at, to)]
        double, number = ir.DoubleType(), ir.IntType(64)
        pointer = double.as_pointer()
        kind = ir.FunctionType(double, [number, double, pointer, pointer, pointer, pointer]).as_pointer()
        function = builder.inttoptr(system, kind)
        return builder.call(function, [what, t, *rows, channels.data, parameters.data])

    return signature, codegen
