"""Compiled functions that are cached on disk, each by what it is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from worker.engine.kernels import numba_internals
from worker.engine.kernels.digest import stamp
from worker.engine.kernels.numba_internals import Function

F = TypeVar("F", bound=Callable[..., object])


def cached(function: Function, **flags: Any) -> Any:
    """A function that is compiled at its first call and cached."""
    return numba_internals.cached(function, stamp, **flags)


def cached_callback(function: Function, signature: Any, **flags: Any) -> Any:
    """A C callback, compiled now and cached; its `address` is valid for as long as the object exists."""
    return numba_internals.cached_callback(function, signature, stamp, **flags)


def compiled(function: F) -> F:
    """A function that computes to the bit what numpy would: neither contracted nor reordered."""
    made: Any = cached(function, error_model="numpy")
    return cast(F, made)
