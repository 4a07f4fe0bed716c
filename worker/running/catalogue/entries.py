"""Components and search methods as data of the catalogue: units, limits, defaults, looks, text."""

from __future__ import annotations

import inspect
from dataclasses import asdict
from functools import cache
from types import ModuleType
from typing import Any, Literal

from pydantic import TypeAdapter

from campaigns.catalogue import ComponentEntry, MethodEntry, ParameterEntry, ReachEntry
from campaigns.looks import MethodLook, ObstacleLook, VehicleLook
from worker.engine.kernels.component import (
    Avoider,
    Component,
    Controller,
    Criterion,
    Declared,
    Fault,
    Obstacle,
    Vehicle,
    declared,
)
from worker.engine.search.base import Method


def component_entry(component: Component, module: ModuleType) -> ComponentEntry:
    """A component as data; its text is that of the module that declares it."""
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
        text=inspect.getdoc(module) or "",
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


def method_entry(method: Method, module: ModuleType) -> MethodEntry:
    """A search method as data, with the JSON schema of its options."""
    return MethodEntry(
        name=method.name,
        title=method.title,
        kind=method.kind,
        text=inspect.getdoc(module) or "",
        how=method.how,
        source=method.source,
        evaluations=method.evaluations,
        starts=method.starts,
        family=method.family,
        families={option: dict(by) for option, by in method.families.items()},
        whole_budget=method.whole_budget,
        effort=method.effort,
        parallel=method.parallel,
        at_once=method.at_once,
        suits=method.suits,
        proposed=dict(method.proposed),
        options=_schema(method.options),
        look=None if method.look is None else MethodLook.model_validate(asdict(method.look)),
    )
