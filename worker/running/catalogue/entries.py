"""Components and search methods as data of the catalogue: units, limits, defaults, looks, text."""

from __future__ import annotations

import ast
import inspect
import textwrap
from dataclasses import asdict
from functools import cache
from types import ModuleType
from typing import Any

from pydantic import BaseModel, TypeAdapter

from campaigns.catalogue import ComponentEntry, MethodEntry, OrderEntry, ParameterEntry, RateEntry, ReachEntry
from campaigns.looks import MethodLook, ObstacleLook, VehicleLook
from worker.engine.kernels.component import (
    Avoider,
    Component,
    Controller,
    Criterion,
    Declared,
    Obstacle,
    Rate,
    Reach,
    Vehicle,
    declared,
)
from worker.engine.search.base import Method


def component_entry(component: Component, module: ModuleType) -> ComponentEntry:
    """A component as data; its text is that of the module that declares it."""
    parameters = declared(component.parameters)
    if isinstance(component, Criterion) and component.worse == "low":
        parameters = parameters[1:]  # the threshold is a field of the campaign
    controller = component if isinstance(component, Controller) else None
    obstacle = component if isinstance(component, Obstacle) else None
    own = _shared(component, ComponentEntry) | {
        "dimension": _dimension(component),
        "frame": component.frame if isinstance(component, Vehicle) else "enu",
        "written_in": "" if isinstance(component, Vehicle | Controller) else component.frame or "",
        "parameters": [_parameter_entry(p) for p in parameters],
        "starts": [_parameter_entry(p) for p in declared(component.start)] if isinstance(component, Vehicle) else [],
        "goals": [_parameter_entry(p) for p in declared(component.goal)] if isinstance(component, Avoider) else [],
        "fits": list(controller.fits) if controller else [],
        "demands": list(controller.command) if controller else [],
        "about_trim": [s for s, _, _ in controller.about_trim.states] if controller and controller.about_trim else [],
        "inputs": [s.name for s in component.inputs] if isinstance(component, Vehicle) else [],
        "reach": _shared(obstacle.reach, ReachEntry) if obstacle and obstacle.reach else None,
        "rate": _shared(obstacle.rate, RateEntry) if obstacle and obstacle.moving and obstacle.rate else None,
        "own_rule": isinstance(component, Criterion) and _own_rule(component),
        "orders": [OrderEntry.model_validate(asdict(order)) for order in getattr(component, "orders", ())],
        "look": _look(component),
        "text": inspect.getdoc(module) or "",
    }
    return ComponentEntry.model_validate(own)


def _own_rule(criterion: Criterion) -> bool:
    """Whether it excludes by another rule than that its value starts at or below the threshold; also if its text cannot
    be read, because then no reason can be stated."""
    if criterion.excluded is None:
        return False
    function: Any = getattr(criterion.excluded, "py_func", criterion.excluded)
    try:
        made = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    except (OSError, TypeError, SyntaxError):
        return True
    named = function.__globals__.get("value") is criterion.value
    body = made.body if isinstance(made, ast.FunctionDef) else []
    rule = [node for node in body if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))]
    names = [argument.arg for argument in made.args.args] if isinstance(made, ast.FunctionDef) else []
    usual = f"return value({', '.join(names)}) <= {names[-1] if names else ''}.threshold"
    return not named or [ast.unparse(node) for node in rule] != [usual]


def _shared(thing: Component | Method | Declared | Reach | Rate, entry: type[BaseModel]) -> dict[str, Any]:
    """What an entry has under the names of the declaration."""
    return {name: getattr(thing, name) for name in entry.model_fields if hasattr(thing, name)}


def _dimension(component: Component) -> int | None:
    """2 or 3; None if it supports both."""
    if isinstance(component, Criterion):
        return next(iter(component.sample)) if len(component.sample) == 1 else None
    return component.dimension if isinstance(component, (Vehicle, Avoider, Obstacle)) else None


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
    return ParameterEntry.model_validate(_shared(p, ParameterEntry))


@cache
def _schema(options: type) -> dict[str, Any]:
    """The options of a method as data; the catalogue is put together again where a simulator is added."""
    return TypeAdapter(options).json_schema()


def method_entry(method: Method, module: ModuleType) -> MethodEntry:
    """A search method as data, with the JSON schema of its options."""
    own = _shared(method, MethodEntry) | {
        "text": inspect.getdoc(module) or "",
        "options": _schema(method.options),
        "look": None if method.look is None else MethodLook.model_validate(asdict(method.look)),
    }
    return MethodEntry.model_validate(own)
