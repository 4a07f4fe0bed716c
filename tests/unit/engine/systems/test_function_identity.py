"""What identifies a function: equal for equal code and values, different for others, and unknown rather than wrong."""

from __future__ import annotations

import functools
import math
import random
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.simulators import two_basins
from worker.engine.systems.simulators.identity import identified

SCALE = 2.0
VARIED = 'x in {1, 2, "c", "d"}'
"""Its set is ordered differently in every process."""


def made(offset: Any, text: str = "x + offset") -> Callable[..., Any]:
    """A function of this text, as a notebook would define it, with a value around it."""
    space: dict[str, Any] = {"np": np, "math": math}
    exec(f"def outer(offset):\n    def fly(x):\n        return {text}\n    return fly", space)
    function: Callable[..., Any] = space["outer"](offset)
    return function


def guarded(begins: str) -> Callable[..., Any]:
    """A function with a table, of which an unknown key is an error or not, by where its `try` begins."""
    space: dict[str, Any] = {"table": {1.0: 2.0}}
    exec(f"def fly(x):\n    {begins}\n    except KeyError:\n        value = 0.0\n    return value", space)
    function: Callable[..., Any] = space["fly"]
    return function


def with_attribute(k: float) -> Callable[..., Any]:
    def fly(x: float) -> float:
        return x * fly.k  # type: ignore[attr-defined]

    fly.k = k  # type: ignore[attr-defined]
    return fly


def scaled(x: float) -> float:
    return SCALE * x


def nested(x: float) -> list[float]:
    return [scaled(x) for _ in range(2)]


def test_equal_functions_are_equal() -> None:
    assert identified(made(1.0)) == identified(made(1.0))
    assert identified(made(1.0)).unknown == ""
    assert len(identified(made(1.0)).digest) == 64


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (made(1.0), made(1.5)),
        (made(1.0), made(1)),
        (made(1.0), made(1.0, "x - offset")),
        (made(1.0), made(1.0, "x + offset + 0.1")),
        (made([1, 2]), made([1, 3])),
        (made([1, 2]), made((1, 2))),
        (made({"a": 1}), made({"a": 2})),
        (made(np.zeros(3)), made(np.array([0.0, 0.0, 1e-300]))),
        (made(np.zeros(3)), made(np.zeros(3, dtype=np.float32))),
        (made(functools.partial(scaled, x=1.0)), made(functools.partial(scaled, x=2.0))),
        (made(1.0, "math.sin(x)"), made(1.0, "math.cos(x)")),
        (made(1.0, "(lambda: x + 1)()"), made(1.0, "(lambda: x + 2)()")),
        (made(1.0, "x in {1, 2}"), made(1.0, "x in {1, 3}")),
        (made({"a": 1, "b": 2}), made({"b": 2, "a": 1})),
        (guarded("value = table[x]\n    try:\n        pass"), guarded("try:\n        value = table[x]")),
        (with_attribute(2.0), with_attribute(0.25)),
    ],
)
def test_different_functions_are_different(one: Callable[..., Any], other: Callable[..., Any]) -> None:
    first, second = identified(one), identified(other)
    assert first.unknown == second.unknown == ""
    assert first.digest != second.digest


def test_a_ufunc_that_somebody_made_is_not_known_by_its_name() -> None:
    assert identified(made(np.frompyfunc(scaled, 1, 1), "offset(x)")).unknown
    assert not identified(made(np.sin, "offset(x)")).unknown


def test_what_it_calls_is_part_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    before = identified(nested)
    monkeypatch.setitem(globals(), "SCALE", 2.5)
    assert before.unknown == ""
    assert identified(nested).digest != before.digest
    assert identified(two_basins.separation).unknown == ""


class Model:
    def fly(self, x: float) -> float:
        return x


@pytest.mark.parametrize(
    ("function", "unknown"),
    [
        (made(object()), "offset"),
        (made([1, object()]), "offset[1]"),
        (made(random.Random(1)), "offset"),
        (made(np.random.default_rng(1).normal), "offset"),
        (made(np.array([object()])), "offset"),
        (made(two_basins), "the module tests.simulators.two_basins"),
        (made(Model), "offset"),
        (Model().fly, "the object of the method fly"),
        (functools.partial(Model().fly), "partial (function)"),
    ],
)
def test_what_cannot_be_read_exactly_is_named(function: Callable[..., Any], unknown: str) -> None:
    assert unknown in identified(function).unknown or "method" in identified(function).unknown


def test_circles_and_depth_end() -> None:
    circle: list[Any] = [1]
    circle.append(circle)
    assert identified(made(circle)).unknown == ""
    deep: list[Any] = []
    for _ in range(2000):
        deep = [deep]
    assert identified(made(deep)).unknown != ""


@pytest.mark.nightly
def test_it_is_the_same_in_every_process() -> None:
    program = (
        "from tests.unit.engine.systems.test_function_identity import VARIED, identified, made\n"
        "print(identified(made({'a', 'b'}, VARIED)).digest)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, env={"PYTHONHASHSEED": "7"}
    )
    assert done.stdout.strip() == identified(made({"a", "b"}, VARIED)).digest
