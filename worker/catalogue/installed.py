"""Discovers installed components, methods and simulators: one file each, or entry points of other packages.

A module in a folder of `worker.components` declares a component by its attribute `component`, a module of
`worker.search.methods` a method by `method`. The operator's own components are files of the folders that
CLEARANCE_COMPONENTS lists; one that cannot be used is skipped and reported. Simulators come from entry points
(`simulator`, or decorated functions) and from the operator's folders: descriptors, and Python files. `catalogue`
returns all of them as data for the service. Start reading there.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from functools import cache
from importlib.metadata import entry_points, version
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

from pydantic import TypeAdapter

from campaigns.catalogue import (
    Catalogue,
    ComponentEntry,
    MethodEntry,
    ParameterEntry,
    ReachEntry,
    Role,
    UnusableEntry,
)
from campaigns.looks import MethodLook, ObstacleLook, VehicleLook
from worker.catalogue import own
from worker.catalogue.described import Described
from worker.catalogue.descriptor import listed
from worker.catalogue.files import PythonFunction, listed_files
from worker.catalogue.function import Function, declared_in
from worker.catalogue.simulator import Program, Simulator
from worker.kernels.component import (
    Avoider,
    Component,
    Controller,
    Criterion,
    Declared,
    Environment,
    Fault,
    Obstacle,
    Vehicle,
    declared,
)
from worker.search.base import Method

FOLDERS = ("vehicles", "controllers", "avoiders", "obstacles", "environment", "faults", "criteria")


def components() -> dict[tuple[Role, str], Component]:
    """Every component of this installation by role and name; what cannot be used is skipped, see `skipped`."""
    return _found()[0]


def skipped() -> list[UnusableEntry]:
    """The components of packages and of the operator's folders that cannot be used, each with the reason."""
    return _found()[1]


def own_modules(used: Iterable[Component]) -> tuple[str, ...]:
    """The modules of the operator that declare these components, and those that they import."""
    paths = {f"{own.PACKAGE}.{file.stem}": file for file in own.files()}
    homes = {home for component in used if (home := _HOMES.get(id(component), "")).startswith(f"{own.PACKAGE}.")}
    return tuple(sorted({name for home in homes for name in own.modules_of(home, paths)})) if homes else ()


_HOMES: dict[int, str] = {}
"""The modules that declare the components, by the components' identity."""


@cache
def _found() -> tuple[dict[tuple[Role, str], Component], list[UnusableEntry]]:
    """Components that are shipped, then those of packages, then the operator's own; duplicate names are skipped."""
    found: dict[tuple[Role, str], Component] = {}
    wrong: list[UnusableEntry] = []
    for folder in FOLDERS:
        for module in _in_folder(f"worker.components.{folder}"):
            component = _component_of(module)
            if component is not None:
                _add(found, (component.role, component.name), component, module)
                _HOMES[id(component)] = module.__name__
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
    try:
        component = _component_of(importlib.import_module(name))
        if component is None:
            return "it has no `component`: declare one at the end of the module"
        _HOMES[id(component)] = name
        _component_entry(component)
    except (Exception, SystemExit) as error:
        return f"it cannot be loaded ({type(error).__name__}: {' '.join(str(error).split())[:300].rstrip('.')})"
    key = component.role, component.name
    if key in found:
        home = source_of(found[key]).__name__
        return f"{home} already declares the {component.role} {component.name!r}: rename one of them"
    found[key] = component
    return ""


def _component_of(module: ModuleType) -> Component | None:
    component = getattr(module, "component", None)
    kinds = (Vehicle, Controller, Avoider, Obstacle, Environment, Fault, Criterion)
    return component if isinstance(component, kinds) else None


@cache
def methods() -> dict[str, Method]:
    """Every search method of this installation by name; a duplicate name is an error."""
    found: dict[str, Method] = {}
    for module in _modules("worker.search.methods", group="clearance.methods"):
        method = getattr(module, "method", None)
        if isinstance(method, Method):
            _add(found, method.name, method, module)
    return found


@cache
def simulators() -> dict[str, Simulator | Program | PythonFunction]:
    """Every simulator of this installation by name; a duplicate name is an error.

    Packages come before the operator's folders, descriptors before Python files: another simulator of the same name is
    skipped.
    """
    found: dict[str, Simulator | Program | PythonFunction] = {}
    for entry in entry_points(group="clearance.simulators"):
        module = importlib.import_module(entry.module)
        for simulator in _simulators_of(module, entry.attr):
            _add(found, simulator.entry.name, simulator, module)
    for described in listed():
        if isinstance(described, Described):
            found.setdefault(described.descriptor.name, Program(described))
    for function in listed_files():
        if isinstance(function, PythonFunction):
            found.setdefault(function.declaration.name, function)
    return found


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
        components=[_component_entry(c) for c in components().values()],
        methods=[_method_entry(m) for m in methods().values()],
        simulators=[s.entry for s in simulators().values()],
        unusable=skipped(),
    )


def source_of(thing: Component | Method | Simulator | PythonFunction) -> ModuleType:
    """The module that declares a component or method, or opens a simulator."""
    if id(thing) in _HOMES:
        return sys.modules[_HOMES[id(thing)]]
    if isinstance(thing, PythonFunction):
        return sys.modules[thing.place["module"]]
    function = thing.open if isinstance(thing, Simulator) else _function(thing)
    module = inspect.getmodule(getattr(function, "py_func", function))
    assert module is not None
    return module


def _function(thing: Component | Method) -> Any:
    return thing.search if isinstance(thing, Method) else _a_kernel(thing)


def _add(found: dict[Any, Any], key: Any, thing: Any, module: ModuleType) -> None:
    if key in found:
        raise ValueError(f"{module.__name__} declares {key!r}, which {source_of(found[key]).__name__} already declares")
    found[key] = thing


def _modules(*folders: str, group: str) -> Iterator[ModuleType]:
    for folder in folders:
        yield from _in_folder(folder)
    for entry in entry_points(group=group):
        yield importlib.import_module(entry.module)


def _in_folder(folder: str) -> Iterator[ModuleType]:
    package = importlib.import_module(folder)
    for info in sorted(pkgutil.iter_modules(package.__path__), key=lambda m: m.name):
        yield importlib.import_module(f"{folder}.{info.name}")


def _a_kernel(component: Component) -> Any:
    if isinstance(component, Vehicle):
        return component.begin
    if isinstance(component, Controller):
        return next(iter(component.command.values()))
    if isinstance(component, Avoider):
        return component.steer
    if isinstance(component, Obstacle):
        return component.body
    if isinstance(component, Environment):
        return component.blow
    return component.kernel if isinstance(component, Fault) else next(iter(component.sample.values()))


def _component_entry(component: Component) -> ComponentEntry:
    parameters = declared(component.parameters)
    if isinstance(component, Criterion) and component.worse == "low":
        parameters = parameters[1:]  # the threshold is a field of the campaign
    return ComponentEntry(
        role=component.role,
        name=component.name,
        title=component.title,
        dimension=_dimension(component),
        frame=component.frame if isinstance(component, Vehicle) else "enu",
        written_in=_written_in(component),
        moving=isinstance(component, Obstacle) and component.moving,
        parameters=[_parameter_entry(p) for p in parameters],
        starts=[_parameter_entry(p) for p in declared(component.start)] if isinstance(component, Vehicle) else [],
        goals=[_parameter_entry(p) for p in declared(component.goal)] if isinstance(component, Avoider) else [],
        fits=list(component.fits) if isinstance(component, Controller) else [],
        demand=component.demand if isinstance(component, Avoider) else "",
        demands=list(component.command) if isinstance(component, Controller) else [],
        inputs=[s.name for s in component.inputs] if isinstance(component, Vehicle) else [],
        path=component.path if isinstance(component, Fault) else "",
        quantity=component.quantity if isinstance(component, Criterion) else "",
        unit=component.unit if isinstance(component, Criterion) else "",
        worse=component.worse if isinstance(component, Criterion) else "",
        of=component.of if isinstance(component, Criterion) else "",
        measured_to=component.measured_to if isinstance(component, Criterion) else "",
        reach=_reach(component),
        look=_look(component),
        text=inspect.getdoc(source_of(component)) or "",
    )


def _dimension(component: Component) -> int | None:
    """2 or 3; None if it supports both."""
    if isinstance(component, Criterion):
        return next(iter(component.sample)) if len(component.sample) == 1 else None
    return component.dimension if isinstance(component, (Vehicle, Avoider, Obstacle)) else None


def _written_in(component: Component) -> Literal["", "enu", "ned"]:
    return "" if isinstance(component, Vehicle | Controller) else component.frame or ""


def _reach(component: Component) -> ReachEntry | None:
    if not isinstance(component, Obstacle) or component.reach is None:
        return None
    return ReachEntry(of=list(component.reach.of), times=component.reach.times)


def _look(component: Component) -> ObstacleLook | VehicleLook | None:
    if not isinstance(component, Obstacle | Vehicle) or component.look is None:
        return None
    known = {p.name for p in declared(component.start if isinstance(component, Vehicle) else component.parameters)}
    entry = ObstacleLook if isinstance(component, Obstacle) else VehicleLook
    look: ObstacleLook | VehicleLook = entry.model_validate(asdict(component.look))
    unknown = [name for name in look.named if name not in known]
    if unknown:
        raise ValueError(f"the look of {component.name} names {unknown[0]!r}, which is not one of its parameters")
    return look


def _parameter_entry(p: Declared) -> ParameterEntry:
    return ParameterEntry(
        name=p.name, symbol=p.symbol, unit=p.unit, low=p.low, high=p.high, default=p.default, text=p.text
    )


@cache
def _schema(options: type) -> dict[str, Any]:
    """The options of a method as data; the catalogue is put together again where a simulator is added."""
    return TypeAdapter(options).json_schema()


def _method_entry(method: Method) -> MethodEntry:
    return MethodEntry(
        name=method.name,
        title=method.title,
        kind=method.kind,
        text=inspect.getdoc(source_of(method)) or "",
        how=method.how,
        source=method.source,
        evaluations=method.evaluations,
        starts=method.starts,
        options=_schema(method.options),
        look=None if method.look is None else MethodLook.model_validate(asdict(method.look)),
    )
