"""Loads and stores one lane of a (rows, LANES) block of a flat buffer as a tuple of floats.

Offsets are compile-time constants and there is only one buffer, so LLVM can prove that lanes do not alias and
vectorises the lane loop. `plain_ops` has the same operations in Python, for simulations without the compiler.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


class LaneOps(NamedTuple):
    """load(buffer, base, lane) -> tuple; store(buffer, base, lane, tuple); advance(x, h, dx) -> x + h dx;
    combine(x, q, a, b, c, d) -> x + q (a + 2 b + 2 c + d); magnitude(x) -> the sum of absolute values."""

    load: Any
    store: Any
    advance: Any
    combine: Any
    magnitude: Any


@cache
def lane_ops(rows: int, lanes: int) -> LaneOps:
    """The compiled operations for tuples of `rows` floats at a width of `lanes`."""

    @intrinsic
    def load(context, buffer, base, lane):  # type: ignore[no-untyped-def]
        signature = types.UniTuple(types.float64, rows)(buffer, base, lane)  # type: ignore[no-untyped-call]

        def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
            first = builder.add(arguments[1], arguments[2])
            values = [
                builder.load(builder.gep(data, [builder.add(first, ir.Constant(first.type, k * lanes))]))
                for k in range(rows)
            ]
            return context.make_tuple(builder, signature.return_type, values)

        return signature, codegen

    @intrinsic
    def store(context, buffer, base, lane, values):  # type: ignore[no-untyped-def]
        signature = types.void(buffer, base, lane, values)

        def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
            first = builder.add(arguments[1], arguments[2])
            for k in range(rows):
                value = builder.extract_value(arguments[3], k)
                value = context.cast(builder, value, signature.args[3][k], types.float64)
                builder.store(value, builder.gep(data, [builder.add(first, ir.Constant(first.type, k * lanes))]))
            return context.get_dummy_value()

        return signature, codegen

    @intrinsic
    def advance(context, x, h, dx):  # type: ignore[no-untyped-def]
        signature = types.UniTuple(types.float64, rows)(x, h, dx)  # type: ignore[no-untyped-call]

        def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            x, h, dx = arguments
            fused = ("contract",)
            values = [
                builder.fadd(
                    builder.extract_value(x, k),
                    builder.fmul(h, builder.extract_value(dx, k), flags=fused),
                    flags=fused,
                )
                for k in range(rows)
            ]
            return context.make_tuple(builder, signature.return_type, values)

        return signature, codegen

    @intrinsic
    def combine(context, x, q, a, b, c, d):  # type: ignore[no-untyped-def]
        signature = types.UniTuple(types.float64, rows)(x, q, a, b, c, d)  # type: ignore[no-untyped-call]

        def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            x, q, a, b, c, d = arguments
            fused = ("contract",)
            values = []
            for k in range(rows):
                x_k, a_k, b_k, c_k, d_k = (builder.extract_value(v, k) for v in (x, a, b, c, d))
                middle = builder.fadd(b_k, c_k)
                ends = builder.fadd(a_k, d_k)
                total = builder.fadd(
                    ends, builder.fmul(ir.Constant(ir.DoubleType(), 2.0), middle, flags=fused), flags=fused
                )
                values.append(builder.fadd(x_k, builder.fmul(q, total, flags=fused), flags=fused))
            return context.make_tuple(builder, signature.return_type, values)

        return signature, codegen

    @intrinsic
    def magnitude(context, x):  # type: ignore[no-untyped-def]
        # Straight-line code: a loop over a long tuple compiles to a switch, which does not vectorise.
        signature = types.float64(types.UniTuple(types.float64, rows))  # type: ignore[no-untyped-call]

        def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            double = ir.DoubleType()
            absolute = builder.module.declare_intrinsic("llvm.fabs", [double])
            total = ir.Constant(double, 0.0)
            for k in range(rows):
                total = builder.fadd(total, builder.call(absolute, [builder.extract_value(arguments[0], k)]))
            return total

        return signature, codegen

    return LaneOps(load, store, advance, combine, magnitude)


def plain_ops(rows: int, lanes: int) -> LaneOps:
    """The operations on lanes in plain Python."""

    def load(buffer, base, lane):  # type: ignore[no-untyped-def]
        return tuple(buffer[base + lane : base + lane + rows * lanes : lanes].tolist())

    def store(buffer, base, lane, values):  # type: ignore[no-untyped-def]
        for k in range(rows):
            buffer[base + lane + k * lanes] = values[k]

    def advance(x, h, dx):  # type: ignore[no-untyped-def]
        return tuple([a + h * b for a, b in zip(x, dx, strict=True)])

    def combine(x, q, a, b, c, d):  # type: ignore[no-untyped-def]
        return tuple(
            [x_k + q * ((a_k + d_k) + 2.0 * (b_k + c_k)) for x_k, a_k, b_k, c_k, d_k in zip(x, a, b, c, d, strict=True)]
        )

    def magnitude(x):  # type: ignore[no-untyped-def]
        return sum(map(abs, x), 0.0)

    return LaneOps(load, store, advance, combine, magnitude)
