"""The state of code generation for a scenario: positions of its components' numbers, functions, wrapped lines."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from worker.engine.kernels.component import Component
from worker.engine.kernels.layout import Parts, channels, sections, spans, states
from worker.engine.kernels.text.names import Names

WIDTH = 120

VARIABLES = """
vehicle controller avoider start goal criterion trim kernel t x g p q v u o e a own position first found seen memory
want weighed errors sight there pose speed when then late earlier env felt more arrives around
"""
"""The generated code's own variables, besides numbered and two-letter ones; no module gets one of these names."""


class Scenario:
    """One scenario while its code is generated, function by function."""

    def __init__(self, parts: Parts, described: dict[str, str]) -> None:
        self.parts, self.dimension, self.described = parts, parts.vehicle.dimension, described
        self.sections = sections(parts)
        self.spans = spans(parts, self.sections)
        self.channels, self.states = channels(parts), states(parts)
        self.names = Names(frozenset([*described, *VARIABLES.split()]))
        self.obstacles = [f"obstacles.{i}" for i in range(len(parts.obstacles))]
        self.environment = [f"environment.{i}" for i in range(len(parts.environment))]
        self.faults: dict[str, list[str]] = {}
        """The faults on each path."""
        for i, placed in enumerate(parts.faults):
            self.faults.setdefault(placed.fault.path, []).append(f"faults.{i}")
        self.inputs = {f"faults.{i}": placed.on for i, placed in enumerate(parts.faults)}
        self.component: dict[str, Any] = parts.named | {
            "start": parts.vehicle, "goal": parts.avoider, "trim": parts.vehicle,
        }  # fmt: skip
        self.state = _slices(asdict(self.states), "x")
        """The slice of the loop's state that each kind of component has."""
        self.functions: list[Function] = []

    def function(self, head: str) -> Function:
        """Start a new function of the text."""
        self.functions.append(Function(self, head))
        return self.functions[-1]

    def name(self, prefix: str, thing: Any) -> str:
        """The qualified name of a kernel or a type of the component with this prefix."""
        component: Component = self.component[prefix]
        return self.names.of(thing, component)

    def view(self, name: str) -> str:
        """The qualified name of an attribute of `views`."""
        return f"{self.names.module('worker.engine.kernels.views')}.{name}"

    def space(self, vector: str) -> str:
        """The expression for a vector of the loop's dimension as one in space."""
        return vector if self.dimension == 3 else f"({vector}[0], {vector}[1], 0.0)"

    @property
    def senses(self) -> bool:
        """Whether faults alter how obstacles are perceived."""
        return bool(self.faults.keys() & {"perception", "timing"})

    def each(self, prefixes: Iterable[str], state: str, first: int = 0) -> dict[str, str]:
        """The slice of a state that each component has, from a position on."""
        return _slices({prefix: self.component[prefix].states for prefix in prefixes}, state, first)


def _slices(counts: dict[str, int], state: str, first: int = 0) -> dict[str, str]:
    found = {}
    for name, count in counts.items():
        found[name] = f"{state}[{first}:{first + count}]" if count else "()"
        first += count
    return found


class Function:
    """One function of the text while it is generated: its lines, and the parameters that they take from p."""

    def __init__(self, scenario: Scenario, head: str) -> None:
        self._scenario, self._head = scenario, head
        self._taken: dict[str, str] = {}
        self._lines: list[str] = []

    def own(self, prefix: str) -> str:
        """The variable that holds a component's parameters or derived constants."""
        at = self._scenario.spans[prefix]
        self._taken[prefix] = f"{variable(prefix)} = {self._scenario.name(prefix, at.fields)}(*p[{at.first}:{at.last}])"
        return variable(prefix)

    def call(self, prefix: str, kernel: Any, *arguments: str) -> str:
        """A call of a component's kernel, with its parameters as last argument."""
        return f"{self._scenario.name(prefix, kernel)}({', '.join([*arguments, self.own(prefix)])})"

    def add(self, *lines: str) -> None:
        self._lines.extend(lines)

    def __str__(self) -> str:
        name, described = self._head.partition("(")[0], self._scenario.described
        description = described[name if name in described else name.rpartition("_")[0]]
        body = [f'"""{description}"""', *self._taken.values(), *self._lines]
        return "\n".join(["@kernel", f"def {self._head}:", *(folded(f"    {line}") for line in body)])


def variable(prefix: str) -> str:
    """The name of a component's variable: obstacle_0, environment_1, vehicle."""
    kind, _, number = prefix.partition(".")
    return f"{kind.removesuffix('s')}_{number}" if number else kind


def tupled(values: Iterable[str]) -> str:
    """The expression for a tuple of these values."""
    every = list(values)
    return f"({every[0]},)" if len(every) == 1 else f"({', '.join(every)})"


def folded(line: str) -> str:
    """A line of the text; if too long, wrapped with the assigned or returned expression in parentheses."""
    if len(line) <= WIDTH:
        return line
    head, joint, rest = line.partition("return ") if "return " in line else line.partition(" = ")
    inner = textwrap.fill(
        rest, WIDTH, initial_indent=" " * 8, subsequent_indent=" " * 8, break_long_words=False, break_on_hyphens=False
    )
    return f"{head}{joint}(\n{inner}\n    )"
