"""Refuses an environment in which numba compiles nothing. It needs no compiler."""

from __future__ import annotations

import os

VARIABLE = "NUMBA_DISABLE_JIT"


class JitDisabledError(ImportError):
    """Numba is set to compile nothing; the message says what to do."""


def by_environment() -> bool:
    """Whether the environment variable is set, read as numba does: a number other than 0."""
    try:
        return bool(int(os.environ.get(VARIABLE) or 0))
    except ValueError:
        return False


def refuse(disabled: bool) -> None:
    """Raises `JitDisabledError` if it is disabled."""
    if disabled:
        raise JitDisabledError(
            f"numba's compiler is switched off, by {VARIABLE} or a file .numba_config.yaml; Clearance evaluates "
            f"compiled code only, since plain Python gives other last bits. Unset {VARIABLE}. "
            "`clearance explain FILE` prints a closed loop as plain Python, for a debugger"
        )
