"""numba makes the same machine code whether it works everything out again or remembers it."""

from __future__ import annotations

import math
import re
from typing import NamedTuple

import numba
import pytest
from numba import types
from numba.core.runtime.context import NRTContext
from numba.core.types.functions import BaseFunction

from worker.engine.kernels import numba_internals
from worker.engine.kernels.maths import FLAGS


class Pair(NamedTuple):
    first: float
    second: int


def code() -> str:
    """Machine code of functions that nothing else has compiled."""

    @numba.njit(forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, **FLAGS)
    def mixed(x, n, p):  # type: ignore[no-untyped-def]
        many = (*x, x[0] * n, float(n % 3), -x[1], abs(x[2]))
        high = (many[3] > 1.0) | (n == 2)
        low = many[4] if high else math.sqrt(x[0] ** 2 + p.first)
        return many, Pair(min(low, 3.0), n // 2)

    @numba.njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **FLAGS)
    def outer(x, n):  # type: ignore[no-untyped-def]
        kept, p = 0.0, Pair(0.5, 1)
        for i in range(n):
            many, p = mixed(x, i, p)
            kept += p.first + many[-1] * (1 + True)
        return kept, p

    outer.compile((types.UniTuple(types.float64, 3), types.int64))
    (text,) = outer.inspect_asm().values()
    instructions = (line for line in text.splitlines() if re.match(r"\t[a-z]", line))
    return re.sub(r"_ZN\w+|\d{6,}|_\d+", "#", "\n".join(instructions))  # names count what was compiled before


def test_the_machine_code_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    remembered = code()
    monkeypatch.setattr(BaseFunction, "get_call_type", numba_internals._type_of_call)
    monkeypatch.setattr(NRTContext, "get_meminfos", numba_internals._held_in)
    before = code()
    assert before == remembered
    assert len(before.splitlines()) > 50


def test_what_cannot_be_resolved_is_refused_every_time() -> None:
    @numba.njit
    def wrong(x):  # type: ignore[no-untyped-def]
        return x + "one"

    for _ in range(2):
        with pytest.raises(numba.TypingError, match="No implementation of function"):
            wrong(1.0)
