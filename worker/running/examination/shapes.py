"""What a kernel must return, and what is wrong with what it returned."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from worker.engine.kernels.views import Body, Body3, Errors, Seen, Sight, Surroundings


@dataclass(frozen=True)
class Number:
    """One number; finite unless stated otherwise."""

    text: str = "a number"

    def wrong(self, value: Any) -> str:
        """What is wrong with a result, to complete "NAME returns ..."; empty if nothing is."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            return f"{_described(value)}, expected {self.text}"
        return "" if math.isfinite(value) else f"{_shown(value)}, expected a finite number"


@dataclass(frozen=True)
class Truth:
    """A result that is True or False."""

    text: str = "True or False"

    def wrong(self, value: Any) -> str:
        return "" if isinstance(value, bool | int | float) else f"{_described(value)}, expected {self.text}"


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

    def wrong(self, value: Any) -> str:
        if isinstance(value, list):
            return f"a list, expected {self.text}: write (a, b) in place of [a, b]"
        if not isinstance(value, tuple) or len(value) != len(self.names):
            return f"{_described(value)}, expected {self.text}"
        for name, each in zip(self.names, value, strict=True):
            found = Number().wrong(each)
            if found:
                return f"{found.partition(',')[0]} for {_named(name)}, expected a finite number"
        return ""


@dataclass(frozen=True)
class Record:
    """A NamedTuple of `worker.engine.kernels.views`."""

    kind: type

    @property
    def _fields(self) -> tuple[str, ...]:
        fields: tuple[str, ...] = self.kind._fields  # type: ignore[attr-defined]
        return fields

    @property
    def text(self) -> str:
        return f"{self.kind.__name__}({', '.join(self._fields)})"

    def wrong(self, value: Any) -> str:
        if not isinstance(value, self.kind):
            return f"{_described(value)}, expected {self.text}"
        assert isinstance(value, tuple)
        return Numbers(self._fields, self.kind.__name__).wrong(tuple(value))


@dataclass(frozen=True)
class Pair:
    """A result of two parts."""

    first: Number | Numbers | Record
    second: Numbers

    @property
    def text(self) -> str:
        return f"a pair of {self.first.text} and {self.second.text}"

    def wrong(self, value: Any) -> str:
        if not isinstance(value, tuple) or len(value) != 2:
            return f"{_described(value)}, expected {self.text}"
        for part, shape, of in zip(("first", "second"), (self.first, self.second), value, strict=True):
            if found := shape.wrong(of):
                return f"as its {part} result {found}"
        return ""


Shape = Number | Truth | Numbers | Record | Pair
BODY, BODY3, SIGHT, SEEN, ERRORS, SURROUNDINGS = map(Record, (Body, Body3, Sight, Seen, Errors, Surroundings))


def numbers(count: int, what: str) -> Numbers:
    """A tuple of so many numbers without names of their own."""
    return Numbers(tuple(str(k) for k in range(count)), what)


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
