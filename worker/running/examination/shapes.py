"""What a kernel must return, and what is wrong with what it returned."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from worker.engine.kernels.views import Body, Body3, Errors, Seen, Sight, Surroundings


@dataclass(frozen=True)
class Number:
    """One number; finite unless stated otherwise."""

    text: str = "a number"


@dataclass(frozen=True)
class Truth:
    """A result that is True or False."""

    text: str = "True or False"


@dataclass(frozen=True)
class Numbers:
    """A tuple of numbers, each with a name."""

    names: tuple[str, ...]
    what: str

    @property
    def text(self) -> str:
        if not self.names:
            return f"() ({self.what})"
        return f"a tuple of {len(self.names)} ({self.what}: {', '.join(self.names)})"


@dataclass(frozen=True)
class Record:
    """A NamedTuple of `worker.engine.kernels.views`."""

    kind: type

    @property
    def text(self) -> str:
        fields: Sequence[str] = self.kind._fields  # type: ignore[attr-defined]
        return f"{self.kind.__name__}({', '.join(fields)})"


@dataclass(frozen=True)
class Pair:
    """A result of two parts."""

    first: Number | Numbers | Record
    second: Numbers

    @property
    def text(self) -> str:
        return f"a pair of {self.first.text} and {self.second.text}"


Shape = Number | Truth | Numbers | Record | Pair
BODY, BODY3, SIGHT, SEEN, ERRORS, SURROUNDINGS = map(Record, (Body, Body3, Sight, Seen, Errors, Surroundings))


def numbers(count: int, what: str) -> Numbers:
    """A tuple of so many numbers without names of their own."""
    return Numbers(tuple(str(k) for k in range(count)), what)


def wrong(value: Any, shape: Shape) -> str:
    """What is wrong with a result, to complete "NAME returns ..."; empty if nothing is."""
    check: Callable[[Any, Any], str] = _CHECKS[type(shape)]
    return check(value, shape)


def _number(value: Any, shape: Shape) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return f"{_described(value)}, expected {shape.text}"
    return "" if math.isfinite(value) else f"{_shown(value)}, expected a finite number"


def _truth(value: Any, shape: Truth) -> str:
    return "" if isinstance(value, bool | int | float) else f"{_described(value)}, expected {shape.text}"


def _numbers(value: Any, shape: Numbers) -> str:
    if isinstance(value, list):
        return f"a list, expected {shape.text}: write (a, b) in place of [a, b]"
    if not isinstance(value, tuple) or len(value) != len(shape.names):
        return f"{_described(value)}, expected {shape.text}"
    for name, each in zip(shape.names, value, strict=True):
        found = _number(each, Number())
        if found:
            return f"{found.partition(',')[0]} for {_named(name)}, expected a finite number"
    return ""


def _record(value: Any, shape: Record) -> str:
    if not isinstance(value, shape.kind):
        return f"{_described(value)}, expected {shape.text}"
    fields: tuple[str, ...] = shape.kind._fields  # type: ignore[attr-defined]
    assert isinstance(value, tuple)
    return _numbers(tuple(value), Numbers(fields, shape.kind.__name__))


def _pair(value: Any, shape: Pair) -> str:
    if not isinstance(value, tuple) or len(value) != 2:
        return f"{_described(value)}, expected {shape.text}"
    first = wrong(value[0], shape.first)
    if first:
        return f"as its first result {first}"
    second = wrong(value[1], shape.second)
    return f"as its second result {second}" if second else ""


def _named(name: str) -> str:
    return f"element {name}" if name.isdigit() else name


def _described(value: Any) -> str:
    if isinstance(value, tuple):
        kind = type(value).__name__
        return f"a tuple of {len(value)}" if kind == "tuple" else f"{kind} with {len(value)} fields"
    if value is None:
        return "None"
    if isinstance(value, bool | int | float):
        return f"the number {_shown(value)}"
    return f"a {type(value).__name__}"


def _shown(value: Any) -> str:
    return "NaN" if value != value else f"{value:g}" if isinstance(value, float) else str(value)


_CHECKS: dict[type, Any] = {Number: _number, Truth: _truth, Numbers: _numbers, Record: _record, Pair: _pair}
