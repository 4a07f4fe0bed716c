"""The physics, the search and the verdict.

Components, methods and simulators of operators and of other packages may still import the names of earlier versions
(`worker.kernels` for `worker.engine.kernels`): each is the same module, not a copy.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

PHYSICS = (
    "aerodynamics", "aircraft", "autopilot", "closest", "fields", "paths", "resolution", "shapes", "space", "trim",
)  # fmt: skip
"""What was in `worker.kernels` before it moved to `worker.physics`."""
EARLIER = {
    **{f"worker.kernels.{name}": f"worker.engine.physics.{name}" for name in PHYSICS},  # before the folder: first match
    "worker.catalogue.simulator": "worker.engine.systems.simulators.declared.simulator",
    **{
        f"worker.{name}": f"worker.{room}.{name}"
        for room, names in (
            ("engine", ("components", "kernels", "physics", "problem", "reference", "search", "stages", "systems")),
            ("running", ("catalogue", "opening")),
        )
        for name in names
    },
}
"""Where packages of earlier versions are today."""


def today(name: str) -> str:
    """The name of a module today; its own if that has not changed."""
    old = next((old for old in EARLIER if name == old or name.startswith(f"{old}.")), None)
    return name if old is None else EARLIER[old] + name.removeprefix(old)


class _Earlier:
    """Finds a module by its name in earlier versions, and leads to the module that it is now."""

    @staticmethod
    def find_spec(name: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> ModuleSpec | None:
        return ModuleSpec(name, _Earlier(), is_package=True) if today(name) != name else None  # type: ignore[arg-type]

    @staticmethod
    def create_module(spec: ModuleSpec) -> ModuleType:
        module = importlib.import_module(today(spec.name))
        spec.loader_state = module.__spec__  # the import system writes the spec of this name to the module
        return module

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """The module has been loaded by its name of today, which remains its name."""
        earlier = module.__spec__
        if earlier is not None and earlier.loader_state is not None:
            module.__spec__ = earlier.loader_state


sys.meta_path.insert(0, _Earlier)  # first: the path of an earlier package would lead to a second copy
