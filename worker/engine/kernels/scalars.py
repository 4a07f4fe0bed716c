"""The plain form of a loop on Python's numbers instead of numpy's: the same bits in little more than half of the time.

One call of `numpy.floor` makes a numpy scalar, and so does all that is computed from it, at three times the cost.
Where Python's numbers raise and numpy's would be infinite or NaN, the simulation is repeated with numpy's. Where
Python's could be complex, numpy's are used.
"""

from __future__ import annotations

import dis
import types
from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any

import numpy as np

from worker.engine.kernels import maths
from worker.engine.kernels.bind import Function, identity, plain, rebuilt

LARGE = 1e300
KEPT = 256
"""How many samples of noise are stored: a sample is drawn again for every slope of its period."""


def floor(x: Any) -> Any:
    """`numpy.floor`; of a Python float that is finite, a Python float."""
    return x // 1.0 if type(x) is float and -LARGE < x < LARGE else np.floor(x)


def _pair(drawn: Callable[..., Any]) -> Callable[..., Any]:
    return lambda seed, stream, count: tuple(map(float, drawn(seed, stream, count)))


def _one(drawn: Callable[..., Any]) -> Callable[..., Any]:
    return lambda seed, stream, count: float(drawn(seed, stream, count))


_NUMPY = types.ModuleType(np.__name__)
vars(_NUMPY).update(vars(np) | {"floor": floor})


def instead() -> dict[Any, Any]:
    """The functions that the quick form uses in place of numpy and kernels, made of the kernels as they are now."""
    return {
        np: _NUMPY,
        maths.normals: lru_cache(KEPT)(_pair(plain(maths.normals))),
        maths.uniform: lru_cache(KEPT)(_one(plain(maths.uniform))),
    }


def quick(function: Function) -> Function:
    """The plain form of a function that writes all its results into arrays."""
    codes: list[types.CodeType] = []

    def noted(made: Function) -> Function:
        codes.append(made.__code__)
        return made

    fast = rebuilt(function, {identity(kernel): other for kernel, other in instead().items()}, noted)
    if any(map(_takes_roots, codes)):
        return plain(function)  # type: ignore[no-any-return]

    thorough = cache(lambda: plain(function))

    def run(*arguments: Any) -> None:
        try:
            fast(*arguments)
        except ArithmeticError:
            thorough()(*arguments)

    return run


_POWERS = [
    bytes((step.opcode, step.arg or 0))
    for text in ("a ** b", "a **= b")
    for step in dis.get_instructions(compile(text, "", "exec"))
    if step.opname == "BINARY_OP"
]


def _takes_roots(code: types.CodeType) -> bool:
    """Whether it raises anything to a power that is no whole number: numpy's root of a negative number is NaN."""
    if any(_takes_roots(inner) for inner in code.co_consts if isinstance(inner, types.CodeType)):
        return True
    if not any(power in code.co_code for power in _POWERS):
        return False
    before: dis.Instruction | None = None
    for step in dis.get_instructions(code):
        if step.opname == "BINARY_OP" and step.argrepr.startswith("**"):
            power = before.argval if before and before.opname.startswith("LOAD_") else None
            if not isinstance(power, int | float) or power % 1:
                return True
        before = step
    return False
