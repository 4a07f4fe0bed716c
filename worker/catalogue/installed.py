"""Discovers installed components, methods and simulators: one file each, or entry points of other packages.

A module in a folder of `worker.components` declares a component by its attribute `component`, a module of
`worker.search.methods` a method by `method`. Simulators come from entry points (`simulator`, or decorated functions)
and from the operator's folders: descriptors, and Python files. `catalogue` returns all of them as data for the
service. Start reading there.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys
from collections.abc import Iterator
from dataclasses import asdict
from functools import cache
from importlib.metadata import entry_points, version
from types import ModuleType
from typing import Any, Literal

from pydantic import TypeAdapter

from campaigns.catalogue import Catalogue, ComponentEntry, MethodEntry, ParameterEntry, ReachEntry, Role
from campaigns.looks import MethodLook, ObstacleLook, VehicleLook
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


@cache
def components() -> dict[tuple[Role, str], Component]:
    """Every component of this installation by role and name; a duplicate name is an error."""
    found: dict[tuple[Role, str], Component] = {}
    for module in _modules(*(f"worker.components.{folder}" for folder in FOLDERS), group="clearance.components"):
        component = getattr(module, "component", None)
        if isinstance(component, (Vehicle, Controller, Avoider, Obstacle, Environment, Fault, Criterion)):
            _add(found, (component.role, component.name), component, module)
    return found


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
    )


def source_of(thing: Component | Method | Simulator | PythonFunction) -> ModuleType:
    """The module that declares a component or method, or opens a simulator."""
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
        package = importlib.import_module(folder)
        for info in sorted(pkgutil.iter_modules(package.__path__), key=lambda m: m.name):
            yield importlib.import_module(f"{folder}.{info.name}")
    for entry in entry_points(group=group):
        yield importlib.import_module(entry.module)


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
        options=TypeAdapter(method.options).json_schema(),
        look=None if method.look is None else MethodLook.model_validate(asdict(method.look)),
    )
