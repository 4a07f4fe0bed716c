"""The box of a question: the bounds of all values, and whether all cases of one box are cases of another one.

A violation exists in every question that asks the same within bounds around it. Read `Box.inside`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import lt

from campaigns.checked.lists import SAME

Document = tuple[str, Mapping[str, Sequence[float]]]
"""A part as plain JSON values."""
MOST_SLACK = 0.25
"""Whole numbers that differ, such as large seeds of a simulator, are different ones."""


@dataclass(frozen=True)
class Part:
    """The lowest and the highest value of every parameter of a part, by name; equal for a fixed one."""

    prefix: str
    """Of the paths of its parameters."""
    bounds: Mapping[str, Sequence[float]]

    def at(self, parameters: Mapping[str, float]) -> Part:
        values = {name: parameters.get(f"{self.prefix}.{name}") for name in self.bounds}
        fixed = {name: (value, value) for name, value in values.items() if value is not None}
        return Part(self.prefix, {**self.bounds, **fixed})

    def inside(self, other: Part) -> bool:
        if self.bounds.keys() != other.bounds.keys():
            return False
        return all(_inside(bound, other.bounds[name]) for name, bound in self.bounds.items())


@dataclass(frozen=True)
class Box:
    """All cases that a question asks of: the product of the bounds of its values."""

    kin: str
    """Digest of what is asked apart from values: boxes of another one have no case in common."""
    parts: Mapping[str, Sequence[Part]]
    """By what they are apart from values. Several that are the same are in any order."""

    def at(self, parameters: Mapping[str, float]) -> Box:
        """The box of one case, from its uncertain parameters by path."""
        return Box(self.kin, {what: [part.at(parameters) for part in parts] for what, parts in self.parts.items()})

    def inside(self, other: Box) -> bool:
        """Whether all cases of this box are cases of the other one."""
        if self.kin != other.kin or self.apart(other):
            return False
        return all(_matched(parts, other.parts[what]) for what, parts in self.parts.items())

    def apart(self, other: Box) -> bool:
        """Whether the values of a part that is like no other one of the box show that no case is in both: a quick look,
        as thousands of runs may be compared with as many."""
        (names, low, high), (others, other_low, other_high) = self._single, other._single
        return names != others or any(map(lt, high, other_low)) or any(map(lt, other_high, low))

    @cached_property
    def _single(self) -> tuple[int, list[float], list[float]]:
        """Of the parts that are like no other one: what tells their parameters, and their bounds with the slack."""
        single = ((what, parts[0].bounds) for what, parts in self.parts.items() if len(parts) == 1)
        bounds = sorted((what, name, bound[0], bound[1]) for what, each in single for name, bound in each.items())
        low = [low - _slack((low, high)) for _, _, low, high in bounds]
        high = [high + _slack((low, high)) for _, _, low, high in bounds]
        return hash(tuple((what, name) for what, name, *_ in bounds)), low, high

    def document(self) -> dict[str, list[Document]]:
        """Its parts as plain JSON values."""
        return {what: [(part.prefix, dict(part.bounds)) for part in parts] for what, parts in self.parts.items()}

    @staticmethod
    def of(kin: str, document: Mapping[str, Sequence[Document]]) -> Box:
        """The box whose parts have this document."""
        return Box(kin, {what: [Part(*part) for part in parts] for what, parts in document.items()})


def _inside(bound: Sequence[float], other: Sequence[float]) -> bool:
    slack = _slack(other)
    return other[0] - slack <= bound[0] and bound[1] <= other[1] + slack


def _slack(bound: Sequence[float]) -> float:
    return min(SAME * max(map(abs, bound)), MOST_SLACK)


def _matched(parts: Sequence[Part], others: Sequence[Part]) -> bool:
    """Whether each part is inside another one of its own: a perfect matching, by augmenting paths."""
    fits = [[k for k, other in enumerate(others) if part.inside(other)] for part in parts]
    taken: dict[int, int] = {}

    def place(i: int, tried: set[int]) -> bool:
        for k in fits[i]:
            if k not in tried:
                tried.add(k)
                if k not in taken or place(taken[k], tried):
                    taken[k] = i
                    return True
        return False

    return all(place(i, set()) for i in range(len(parts)))
