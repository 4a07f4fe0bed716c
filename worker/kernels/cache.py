"""Compiled functions kept on disk across processes, by numba's own cache; what cannot be read counts as missing.

A kept function names the modules that it was made of. After an update that moved one of them it cannot be loaded: it
is compiled again and replaced, as if it had not been there. Start reading at `kept`.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba import config
from numba.core import sigutils
from numba.core.caching import FunctionCache
from numba.core.ccallback import CFunc


def cache_folder() -> Path:
    """Where compiled loops are kept: CLEARANCE_KERNEL_CACHE, else the user's cache folder."""
    given = os.environ.get("CLEARANCE_KERNEL_CACHE")
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(given) if given else (Path(base) if base else Path.home() / ".cache") / "clearance" / "kernels"


if not os.environ.get("NUMBA_CACHE_DIR"):
    config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]


class KernelCache(FunctionCache):
    """Numba's cache of one function."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kept function for a signature; None where there is none, or none that this version can load."""
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except (ImportError, AttributeError, EOFError, pickle.UnpicklingError):
            return None


class _KeptCallback(CFunc):
    def enable_caching(self) -> None:
        self._cache = KernelCache(self.__wrapped__)  # type: ignore[no-untyped-call]


def kept(function: Callable[..., Any], **flags: Any) -> Any:
    """A function compiled when it is first called, kept on disk."""
    made = numba.njit(**flags)(function)
    made._cache = KernelCache(function)  # type: ignore[no-untyped-call]
    return made


def kept_callback(function: Callable[..., Any], signature: Any, **flags: Any) -> Any:
    """A function of C, compiled at once, kept on disk; its `address` is good for as long as it is kept."""
    known = sigutils.normalize_signature(signature)  # type: ignore[no-untyped-call]
    made = _KeptCallback(function, known, locals={}, options=flags)
    made.enable_caching()
    made.compile()
    return made
