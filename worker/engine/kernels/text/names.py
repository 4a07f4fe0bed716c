"""Names of kernels and types in the generated code, qualified by their module: `unicycle.derivative`."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from types import ModuleType
from typing import Any

from worker.engine.kernels.component import Component

OWN = re.compile(r"^d?x.$|_\d+$")
"""Names that look like the generated code's own variables: dxv, obstacle_0."""


class UnnamedError(TypeError):
    """A component has a kernel or a type that cannot be imported by name; the message states which and what to do."""


class Names:
    """The modules that a text imports, by local name; `taken` are the other names that it uses."""

    def __init__(self, taken: frozenset[str]) -> None:
        self._taken = taken
        self._short: dict[str, str] = {}

    def of(self, thing: Any, component: Component) -> str:
        """The qualified name of a component's kernel or type; UnnamedError if no module has a name for it."""
        for home in _homes(thing, component):
            for name in (thing.__name__, *vars(home)):
                if name.isidentifier() and vars(home).get(name) is thing:
                    return f"{self.module(home.__name__)}.{name}"
        raise UnnamedError(
            f"{component.role} {component.name!r}: {thing.__name__!r} is not found by name in module "
            f"{thing.__module__}; define kernels and parameters at the top of a module that can be imported"
        )

    def module(self, full: str) -> str:
        """The local name of a module: its last name, with as many parent names as make it unique."""
        if full not in self._short:
            parts = full.split(".")
            named = ["_".join(parts[-count:]) for count in range(1, len(parts) + 1)]
            named.append(f"{parts[-1]}_module{len(self._short)}")
            used = self._taken.union(self._short.values())
            self._short[full] = next(name for name in named if name not in used and not OWN.search(name))
        return self._short[full]

    def imports(self) -> list[str]:
        """The import statements of the text."""
        lines = []
        for full, short in sorted(self._short.items()):
            package, _, last = full.rpartition(".")
            line = f"from {package} import {last}" if package else f"import {last}"
            lines.append(line if short == last else f"{line} as {short}")
        return lines


def _homes(thing: Any, component: Component) -> Iterator[ModuleType]:
    """The modules that may name a component's kernel or type: its own, then those of the component."""
    named = [thing.__module__, *(kernel.__module__ for kernel in _kernels(component))]
    yield from (sys.modules[name] for name in dict.fromkeys(named) if name in sys.modules)
    yield from [m for m in list(sys.modules.values()) if getattr(m, "__dict__", {}).get("component") is component]


def _kernels(part: Any) -> Iterator[Any]:
    """The kernels of a component, including those of its derived constants."""
    for field in fields(part):
        value = getattr(part, field.name)
        for each in value.values() if isinstance(value, dict) else (value,):
            if is_dataclass(each) and not isinstance(each, type):
                yield from _kernels(each)
            elif callable(each) and not isinstance(each, type):
                yield each
