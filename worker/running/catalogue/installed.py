"""Discovers installed components, methods and simulators: one file each, or entry points of other packages.

A module in a folder of `worker.engine.components` declares a component by its attribute `component`, a module of
`worker.engine.search.methods` a method by `method`. The operator's own components are files of the folders that
CLEARANCE_COMPONENTS lists; one that cannot be used is skipped and reported. Simulators come from entry points
(`simulator`, or decorated functions) and from the operator's folders: descriptors, and Python files. `catalogue`
returns all of them as data for the service. Start reading there.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib.metadata import entry_points, version
from pathlib import Path
from types import ModuleType
from typing import Any

from campaigns.catalogue import (
    Catalogue,
    ComponentEntry,
    Kind,
    Role,
    UnusableEntry,
)
from worker.engine.kernels.component import Component, Environment, Fault, unswitched
from worker.engine.search.base import Method
from worker.engine.systems.closed_loop.parts import Installed
from worker.engine.systems.simulators.declared.described import Described
from worker.engine.systems.simulators.declared.descriptor import listed
from worker.engine.systems.simulators.declared.function import Function, declared_in
from worker.engine.systems.simulators.declared.simulator import Simulator
from worker.running.catalogue import own
from worker.running.catalogue.entries import component_entry, method_entry
from worker.running.catalogue.files import PythonFunction, listed_files

FOLDERS = ("vehicles", "controllers", "avoiders", "obstacles", "environment", "faults", "criteria")


def components() -> dict[tuple[Role, str], Component]:
    """Every component of this installation by role and name; what cannot be used is skipped, see `skipped`."""
    return _found()[0]


def installed() -> Installed:
    """The installed components as a closed loop needs them."""
    return Installed(components(), catalogue())


def skipped() -> list[UnusableEntry]:
    """What packages and the operator's component folders declare and cannot be used, each with the reason."""
    return [*_found()[1], *_methods()[1], *_simulators()[1]]


def own_modules(used: Iterable[Component]) -> tuple[str, ...]:
    """The modules of the operator that declare these components, and those that they import."""
    paths = {f"{own.PACKAGE}.{file.stem}": file for file in own.files()}
    homes = {home for component in used if (home := _home(component)).startswith(f"{own.PACKAGE}.")}
    return tuple(sorted({name for home in homes for name in own.modules_of(home, paths)})) if homes else ()


_HOMES: dict[int, tuple[Component, str]] = {}
"""Components with the modules that declare them, by identity: a component is kept, so that no other gets its own."""
_SHIPPED: dict[int, ComponentEntry] = {}
"""What is shipped as data, by its identity: described once, however often simulators are looked for again."""


def _home(thing: object) -> str:
    return _HOMES[id(thing)][1] if id(thing) in _HOMES else ""


@cache
def _found() -> tuple[dict[tuple[Role, str], Component], list[UnusableEntry]]:
    """Components that are shipped, then those of packages, then the operator's own; duplicate names are skipped."""
    found: dict[tuple[Role, str], Component] = {}
    wrong: list[UnusableEntry] = []
    for folder in FOLDERS:
        for module in _in_folder(f"worker.engine.components.{folder}"):
            component = _component_of(module)
            if component is not None:
                _add(found, (component.role, component.name), component, module)
                _HOMES[id(component)] = component, module.__name__
    others: list[tuple[str, str, Path | None]] = [
        (entry.name, entry.module, None) for entry in entry_points(group="clearance.components")
    ]
    wrong += [own.unusable(None, text) for text in own.missing()]
    for one in own.examined():
        if one.text:
            wrong.append(one.entry)
        else:
            others.append((one.name, one.module, one.file))
    for name, home, file in others:
        reason = _added(found, home)
        if reason:
            wrong.append(own.unusable(file, reason if file else f"the package {home}: {reason}", name=name))
    return found, wrong


def _added(found: dict[tuple[Role, str], Component], name: str) -> str:
    """Add the component of another package or of the operator; the reason if that is not possible."""

    def add(module: ModuleType) -> str:
        component = _component_of(module)
        if component is None:
            return "it has no `component`: declare one at the end of the module"
        component_entry(component, module)
        key = component.role, component.name
        reason = _kept(found, key, component, f"the {component.role} {component.name!r}")
        if not reason:
            _HOMES[id(component)] = component, name
        return reason

    return _loaded(name, add)


def _component_of(module: ModuleType) -> Component | None:
    component = getattr(module, "component", None)
    return component if isinstance(component, Component) else None


def methods() -> dict[str, Method]:
    """Every search method of this installation by name; what cannot be used is skipped, see `skipped`."""
    return _methods()[0]


@cache
def _methods() -> tuple[dict[str, Method], list[UnusableEntry]]:
    """Methods that are shipped, then those of packages; duplicate names are skipped."""
    found: dict[str, Method] = {}
    for module in _in_folder("worker.engine.search.methods"):
        method = getattr(module, "method", None)
        if isinstance(method, Method):
            _add(found, method.name, method, module)

    def add(module: ModuleType, attribute: str) -> str:
        method = getattr(module, "method", None)
        if not isinstance(method, Method):
            return "it has no `method`: declare one at the end of the module"
        method_entry(method, module)
        return _kept(found, method.name, method, f"the method {method.name!r}")

    return found, _of_packages("method", add)


def simulators() -> dict[str, Simulator | Described | PythonFunction]:
    """Every simulator of this installation by name; a package's that cannot be used is skipped, see `skipped`.

    Packages come before the operator's folders, descriptors before Python files: another simulator of the same name is
    skipped.
    """
    return _simulators()[0]


def forget_simulators() -> None:
    """Look for simulators again: the operator's folders may have changed."""
    _simulators.cache_clear()
    catalogue.cache_clear()


@cache
def _simulators() -> tuple[dict[str, Simulator | Described | PythonFunction], list[UnusableEntry]]:
    found: dict[str, Simulator | Described | PythonFunction] = {}

    def add(module: ModuleType, attribute: str) -> str:
        declared = _simulators_of(module, attribute)
        if not declared:
            wanted = f"no simulator named {attribute!r}" if attribute else "no simulator"
            return f"it declares {wanted}: decorate a function with @clearance.simulator"
        refused = [_kept(found, s.entry.name, s, f"the simulator {s.entry.name!r}") for s in declared]
        return "; ".join(filter(None, refused))

    wrong = _of_packages("simulator", add)
    for described in listed():
        if isinstance(described, Described):
            found.setdefault(described.descriptor.name, described)
    for function in listed_files():
        if isinstance(function, PythonFunction):
            found.setdefault(function.declaration.name, function)
    return found, wrong


def _of_packages(kind: Kind, add: Callable[[ModuleType, str], str]) -> list[UnusableEntry]:
    """Add what the entry points of other packages name; those that cannot be used, with the reason."""
    wrong = []
    for entry in entry_points(group=f"clearance.{kind}s"):
        reason = _loaded(entry.module, lambda module: add(module, entry.attr))  # noqa: B023
        if reason:
            wrong.append(own.unusable(None, f"the package {entry.module}: {reason}", name=entry.name, kind=kind))
    return wrong


def _loaded(name: str, add: Callable[[ModuleType], str]) -> str:
    """Import a module and add what it declares; the reason if that is not possible."""
    try:
        return add(importlib.import_module(name))
    except (Exception, SystemExit) as error:
        return f"it cannot be loaded ({type(error).__name__}: {' '.join(str(error).split())[:300].rstrip('.')})"


def _kept(found: dict[Any, Any], key: Any, thing: Any, called: str) -> str:
    """Add what another package or the operator declares; the reason if something else has its name."""
    if key in found:
        return f"{source_of(found[key]).__name__} already declares {called}: rename one of them"
    found[key] = thing
    return ""


def _simulators_of(module: ModuleType, attribute: str) -> list[Simulator | PythonFunction]:
    """What an entry point names: an attribute, else `simulator`, else every decorated function of the module."""
    named = getattr(module, attribute or "simulator", None)
    if isinstance(named, Simulator):
        return [named]
    functions = {attribute or "simulator": named} if isinstance(named, Function) else declared_in(module)
    return [
        PythonFunction(f.declaration, {"module": module.__name__, "name": name}, f.call)
        for name, f in functions.items()
        if not attribute or name == attribute
    ]


@cache
def catalogue() -> Catalogue:
    """Components, methods and simulators as data: units, limits, defaults, and text from their files."""
    return Catalogue(
        version=version("clearance"),
        components=[_entry(component) for component in components().values()],
        methods=[method_entry(m, source_of(m)) for m in methods().values()],
        simulators=[s.entry for s in simulators().values()],
        unusable=skipped(),
    )


def _entry(component: Component) -> ComponentEntry:
    """A component as data, of criteria that are not shipped with the digest of their code; shipped faults that read
    the time and declare no switches do not jump."""
    home = _home(component)
    if home.startswith("worker.engine.components.") and not home.startswith(f"{own.PACKAGE}."):
        if id(component) not in _SHIPPED:
            _SHIPPED[id(component)] = component_entry(component, source_of(component))
        return _SHIPPED[id(component)]
    entry = component_entry(component, source_of(component))
    if isinstance(component, Fault | Environment):
        return entry.model_copy(update={"unswitched": unswitched(component)})
    if component.role != "criterion":
        return entry
    paths = {f"{own.PACKAGE}.{file.stem}": file for file in own.files()}
    code = own.code_of(home, paths) if home.startswith(f"{own.PACKAGE}.") else own.code_of_package(home)
    return entry.model_copy(update={"computed_by": code})


def source_of(thing: Component | Method | Simulator | PythonFunction) -> ModuleType:
    """The module that declares a component or method, or opens a simulator."""
    if home := _home(thing):
        return sys.modules[home]
    if isinstance(thing, PythonFunction):
        return sys.modules[thing.place["module"]]
    assert isinstance(thing, Method | Simulator)
    module = inspect.getmodule(thing.search if isinstance(thing, Method) else thing.open)
    assert module is not None
    return module


def _add(found: dict[Any, Any], key: Any, thing: Any, module: ModuleType) -> None:
    if key in found:
        raise ValueError(f"{module.__name__} declares {key!r}, which {source_of(found[key]).__name__} already declares")
    found[key] = thing


def _in_folder(folder: str) -> Iterator[ModuleType]:
    package = importlib.import_module(folder)
    for info in sorted(pkgutil.iter_modules(package.__path__), key=lambda m: m.name):
        yield importlib.import_module(f"{folder}.{info.name}")
