"""Functions that are only linked into their callers compute what they compute in plain Python."""

from __future__ import annotations

import math
from typing import Any

import numba
import pytest

from worker.engine.kernels.linked import linked


def root(x: float) -> float:
    return math.sqrt(x)


def norm(x: float, y: float) -> Any:
    return ROOT(x * x + y * y), -y


def longest(n: int) -> float:
    most = 0.0
    for k in range(n):
        length, _ = NORM(0.1 * k, 3.0 - k)
        most = max(most, length)
    return most


ROOT: Any = root
NORM: Any = norm


def test_levels_of_functions_give_the_bits_of_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = longest(9)
    monkeypatch.setitem(globals(), "ROOT", linked(root, forceinline=True))
    monkeypatch.setitem(globals(), "NORM", linked(norm))
    compiled = numba.njit(longest)
    assert compiled(9) == expected
    (code,) = compiled.inspect_asm().values()
    assert "sqrtsd" in code or "fsqrt" in code
