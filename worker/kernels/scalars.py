"""The plain form of a loop on Python's numbers instead of numpy's: the same bits in two thirds of the time.

One call of `numpy.floor` makes a numpy scalar, and so does all that is computed from it, at three times the cost.
Where Python's numbers raise and numpy's would be infinite or NaN, the simulation is repeated with numpy's.
Start reading at `quick`.
"""

from __future__ import annotations

import types
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from worker.kernels import maths
from worker.kernels.bind import Function, plain

LARGE = 1e300
KEPT = 256
"""How many samples of noise are kept: a sample is drawn again for every slope of its period."""


def floor(x: Any) -> Any:
    """`numpy.floor`; of a Python float that is finite, a Python float."""
    return x // 1.0 if type(x) is float and -LARGE < x < LARGE else np.floor(x)


def _pair(drawn: Callable[..., Any]) -> Callable[..., Any]:
    return lambda seed, stream, count: tuple(map(float, drawn(seed, stream, count)))


def _one(drawn: Callable[..., Any]) -> Callable[..., Any]:
    return lambda seed, stream, count: float(drawn(seed, stream, count))


def _kept(drawn: Callable[..., Any]) -> Callable[..., Any]:
    return lru_cache(KEPT)(drawn)


_NUMPY = types.ModuleType(np.__name__)
vars(_NUMPY).update(vars(np) | {"floor": floor})

INSTEAD: dict[Any, Any] = {
    np: _NUMPY,
    maths.normals: _kept(_pair(plain(maths.normals))),
    maths.uniform: _kept(_one(plain(maths.uniform))),
}
"""What the quick form uses in place of numpy and kernels."""


def quick(function: Function) -> Function:
    """The plain form of a function that writes all its results into arrays."""
    fast = plain(function, INSTEAD)

    def run(*arguments: Any) -> None:
        try:
            fast(*arguments)
        except ArithmeticError:
            plain(function)(*arguments)

    return run
