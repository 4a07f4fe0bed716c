"""Imports a component's file and checks its declaration: fields, parameters, units, kernels: `declared_by`."""

from __future__ import annotations

import importlib
import inspect
import re
import typing
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any, Literal, get_args, get_origin

from worker.engine.kernels.component import (
    Avoider,
    Component,
    Controller,
    Criterion,
    Derived,
    Environment,
    Fault,
    Limit,
    Obstacle,
    ObstacleLook,
    Order,
    Rate,
    Reach,
    Signal,
    Trim,
    Vehicle,
    VehicleLook,
    declared,
)
from worker.engine.kernels.numba_internals import is_compiled
from worker.engine.kernels.parameters import Parameter
from worker.running.examination import units
from worker.running.examination.blame import mistake
from worker.running.examination.kernels import Slot, kernels
from worker.running.examination.mistake import Mistake, listed, meant
from worker.running.examination.naming import check_name
from worker.running.examination.reading import KINDS, Source, check_names

LARGEST = 1e12
"""Limits of parameters may not be larger than this."""

_TUPLES: dict[str, type] = {"signals": Signal, "inputs": Signal, "limits": Limit, "fits": str, "orders": Order}
_OBJECTS: dict[str, type] = {"derived": Derived, "trim": Trim, "reach": Reach}
_BY_DEMAND = ("prepare", "command", "references", "translate")


def declared_by(source: Source, module: str) -> Component:
    """The component that a file declares, imported as this module; raises `Mistake`."""
    try:
        loaded = importlib.import_module(module)
    except Mistake:
        raise
    except (Exception, SystemExit) as error:
        found = mistake(error, source.file, "while importing it")
        named = re.match(r"\w+ has no field '(\w+)'", found.text)
        raise Mistake(found.text, source.line_of(named[1]) if named else found.line) from None
    check_names(source)
    value = getattr(loaded, "component", None)
    if not isinstance(value, typing.get_args(Component)):
        raise Mistake(
            f"component is {_what(value)}, expected one of {', '.join(KINDS)}: write component = Vehicle(...)",
            source.line_of(),
        )
    component: Component = value
    _check_fields(component, source)
    for field in ("parameters", "start", "goal"):
        if hasattr(component, field):
            _check_parameters(getattr(component, field), field, source)
    for field, lack, why in _lacking(component):
        raise Mistake(f"{field} needs {lack}: {why}", source.line_of(field))
    for slot in kernels(component):
        _check_kernel(slot, source)
    return component


def _check_fields(component: Component, source: Source) -> None:
    check_name(component.role, component.name, source.line_of("name"))
    hints = typing.get_type_hints(type(component))
    for field in fields(component):
        value, line = getattr(component, field.name), source.line_of(field.name)
        allowed = _literals(hints[field.name])
        if allowed and value not in allowed:
            choices = ", ".join(map(repr, (a for a in allowed if a is not None)))
            raise Mistake(f"{field.name} is {value!r:.40}, expected {choices.replace(', ', ' or ')}: choose one", line)
        _check_field(field.name, value, component, line)


def _check_field(name: str, value: Any, component: Component, line: int) -> None:
    if name in ("title", "quantity") and (not isinstance(value, str) or not value.strip()):
        raise Mistake(f"{name} is {value!r:.40}, expected a few words: the pages show them", line)
    if name in _TUPLES or (name == "states" and isinstance(component, Vehicle)):
        _check_tuple(name, value, _TUPLES.get(name, Signal), line)
    elif name in ("states", "memory", "draws") and (isinstance(value, bool) or not isinstance(value, int) or value < 0):
        raise Mistake(f"{name} is {value!r:.40}, expected how many there are, a whole number such as 0 or 2", line)
    elif name in _OBJECTS and value is not None and not isinstance(value, _OBJECTS[name]):
        kind = _OBJECTS[name].__name__
        raise Mistake(f"{name} is {_what(value)}, expected {kind}(...): write {name}={kind}(...)", line)
    elif name in _BY_DEMAND and value is not None:
        if not isinstance(value, Mapping) or not set(value) <= {"force", "velocity"} or not value:
            raise Mistake(f"{name} is {_what(value)}, expected a dict by kind of demand: {{'force': function}}", line)
    elif name == "sample" and (not isinstance(value, Mapping) or not set(value) <= {2, 3} or not value):
        raise Mistake(f"{name} is {_what(value)}, expected a dict by dimension: {{2: in_plane, 3: in_space}}", line)
    elif name == "look" and value is not None:
        _check_look(value, component, line)


def _check_tuple(name: str, value: Any, kind: type, line: int) -> None:
    sample = f"({kind.__name__}(...),)" if kind is not str else "('unicycle',)"
    if not isinstance(value, tuple) or any(not isinstance(each, kind) for each in value):
        what = f"a list; a tuple is expected: write {sample}" if isinstance(value, list) else _what(value)
        end = "" if isinstance(value, list) else f", expected a tuple such as {sample}: the comma makes it one"
        raise Mistake(f"{name} is {what}{end}", line)
    if not value and name in ("states", "inputs", "fits"):
        raise Mistake(f"{name} is empty: give at least one, such as {sample}", line)
    if kind is Signal:
        for signal in value:
            if not isinstance(signal.unit, str) or (advice := units.unknown(signal.unit)):
                raise Mistake(f"{name}: unknown unit {signal.unit!r} of {signal.name}: {advice}", line)
        names = [signal.name for signal in value]
        if len(set(names)) < len(names):
            raise Mistake(f"{name}: two have the same name ({', '.join(names)}): name each differently", line)


def _check_look(value: Any, component: Component, line: int) -> None:
    kind = VehicleLook if isinstance(component, Vehicle) else ObstacleLook
    if not isinstance(value, kind):
        raise Mistake(f"look is {_what(value)}, expected {kind.__name__}(...)", line)
    if isinstance(value, VehicleLook) and isinstance(component, Vehicle):
        used, of = [value.heading], component.start
    elif isinstance(value, ObstacleLook) and isinstance(component, Obstacle):
        used, of = [value.radius, value.height, *value.sides, value.angle], component.parameters
    else:
        return
    if not hasattr(of, "_fields"):
        return  # reported as the parameters' own mistake
    names = _names(of)
    for name in filter(None, used):
        if name not in names:
            raise Mistake(f"look names {name!r}, which is not one of its parameters: {meant(name, names)}", line)


def _names(of: type) -> list[str]:
    try:
        return [p.name for p in declared(of)]
    except (TypeError, NameError, AttributeError):
        return list(of._fields)  # type: ignore[attr-defined]


def _check_parameters(owner: Any, field: str, source: Source) -> None:
    line = source.line_of(field)
    if not (isinstance(owner, type) and issubclass(owner, tuple) and hasattr(owner, "_fields")):
        raise Mistake(f"{field} is {_what(owner)}, expected a NamedTuple class: class My(NamedTuple): ...", line)
    try:
        hints = typing.get_type_hints(owner, include_extras=True)
    except Exception as error:
        raise mistake(error, source.file, f"while reading the annotations of {owner.__name__}") from None
    for name, hint in hints.items():
        at = source.line_of_parameter(owner.__name__, name)
        meta = next((m for m in getattr(hint, "__metadata__", ()) if isinstance(m, Parameter)), None)
        if meta is None:
            raise Mistake(
                f"{owner.__name__}.{name} does not say what it is: write "
                f'{name}: Annotated[float, Parameter("unit", "Text", low, high)]',
                at,
            )
        defaults: Mapping[str, Any] = getattr(owner, "_field_defaults", {})
        _check_parameter(f"{owner.__name__}.{name}", meta, defaults.get(name), at)
    try:
        declared(owner)
    except TypeError as error:
        raise Mistake(" ".join(str(error).split()), line) from None
    names = [p.name for p in declared(owner)]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise Mistake(f"{owner.__name__} has two parameters named {twice[0]!r}: name each differently", line)


def _check_parameter(path: str, meta: Parameter, default: Any, line: int) -> None:
    if not isinstance(meta.unit, str) or not isinstance(meta.text, str) or not meta.text.strip():
        raise Mistake(f'{path}: expected Parameter("unit", "Text", low, high), where the text says what it is', line)
    if advice := units.unknown(meta.unit):
        raise Mistake(f"{path}: unknown unit {meta.unit!r}: {advice}", line)
    for label, value in (("low", meta.low), ("high", meta.high), ("the default", default)):
        if value is None and label == "the default":
            continue
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
            raise Mistake(
                f"{path}: {label} is {value!r:.40}, expected a number of at most {LARGEST:g} in magnitude", line
            )
    unit = f" {meta.unit}" if meta.unit else ""
    if not meta.low < meta.high:
        raise Mistake(f"{path}: low {meta.low:g} must be below high {meta.high:g}{unit}", line)
    if default is not None and not meta.low <= default <= meta.high:
        limits = f"its limits, {meta.low:g} to {meta.high:g}{unit}"
        raise Mistake(f"{path}: the default {default:g} must be within {limits}", line)


def _lacking(c: Component) -> Iterator[tuple[str, str, str]]:
    """Fields that need one another."""
    if isinstance(c, Controller):
        kinds = set(c.command)
        for field, functions in (("prepare", c.prepare), ("references", c.references), ("translate", c.translate)):
            if functions is not None and set(functions) != kinds:
                yield (
                    field,
                    f"the same kinds of demand as command ({listed(sorted(kinds))})",
                    "give one function for each",
                )
    if isinstance(c, Avoider) and (c.weigh is None) != (c.first is None):
        yield ("weigh", "first", "the fold over the obstacles begins with its result") if c.weigh else (
            "first", "weigh", "first begins the fold over the obstacles that weigh continues",
        )  # fmt: skip
    if isinstance(c, Avoider) and c.memory and c.remember is Avoider.remember:
        yield "memory", "remember", "it gives the memory at the start"
    if isinstance(c, Obstacle) and c.states and (c.wake is None or c.move is None):
        yield "states", "wake and move", "they give the states at the start and their rates"
    if isinstance(c, Environment) and c.states and c.wake is None:
        yield "states", "wake", "it gives the states at the start"
    if isinstance(c, Environment) and (c.draw is None) != (c.draws == 0):
        yield ("draws", "draw", "it returns so many samples") if c.draw is None else ("draw", "draws", "say how many")
    if isinstance(c, Environment | Fault) and c.whole and c.switches is None:
        yield "whole", "switches", "it is the index of one of the instants that they return"
    if isinstance(c, Fault) and c.states and (c.rest is None or c.path != "actuator"):
        yield "states", "rest, and the path 'actuator'", "only actuator faults have states"
    if isinstance(c, Criterion) and c.worse == "low":
        if c.excluded is None:
            yield "worse", "excluded", "it says which starts show nothing, such as one at or below the threshold"
        names = _names(c.parameters)
        if not names or names[0] != "threshold":
            yield "parameters", "threshold as its first field", "the value must stay above it"
    for order in () if isinstance(c, Criterion) else c.orders:
        for name in (*order.low, *order.high):
            if name not in (names := _names(c.parameters)):
                yield "orders", f"a parameter {name!r}", meant(name, names)
    if isinstance(c, Obstacle):
        yield from _misnamed(c)


def _misnamed(c: Obstacle) -> Iterator[tuple[str, str, str]]:
    """Names of reach and rate that nothing of the obstacle has."""
    rate, names = c.rate or Rate(), _names(c.parameters)
    for field, used in (("reach", c.reach.of if c.reach else ()), ("rate", (*rate.of, *rate.per, rate.used))):
        for name in filter(None, used):
            if name not in names:
                yield field, f"a parameter {name!r}", meant(name, names)
    points = sorted({name.rpartition(".")[0] for name in names if "." in name})
    for leg in rate.legs:
        if leg not in points:
            yield "rate", f"parameters '{leg}.x' and '{leg}.y'", meant(leg, points)
    constants = c.derived.constants._fields if c.derived else ()  # type: ignore[attr-defined]
    if rate.stops and rate.stops not in constants:
        known = meant(rate.stops, constants) if constants else "the obstacle derives none"
        yield "rate", f"a derived constant {rate.stops!r}", known


def _check_kernel(slot: Slot, source: Source) -> None:
    field = slot.field.partition("[")[0]
    line = source.line_of(field)
    if not callable(slot.function):
        raise Mistake(f"{slot.field} is {_what(slot.function)}, expected a function decorated with @kernel", line)
    function = getattr(slot.function, "py_func", slot.function)
    name = getattr(function, "__name__", slot.field)
    at = source.functions[name].lineno if name in source.functions else line
    if slot.plain:
        return
    if not is_compiled(slot.function):
        raise Mistake(f"{name} is used as {slot.field} and lacks the decorator: write @kernel above it", at)
    _check_arguments(name, slot, function, at)


def _check_arguments(name: str, slot: Slot, function: Any, line: int) -> None:
    names = list(inspect.signature(function).parameters)
    expected = f"{name}({', '.join(slot.arguments)})"
    if len(names) != len(slot.arguments):
        raise Mistake(
            f"{name} has {len(names)} arguments ({', '.join(names) or 'none'}), and as {slot.field} it is called with "
            f"{len(slot.arguments)}: write {expected}",
            line,
        )
    if sorted(names) == sorted(slot.arguments) and names != list(slot.arguments):
        raise Mistake(
            f"the arguments of {name} are in another order ({', '.join(names)}), and they are passed by position: "
            f"write {expected}",
            line,
        )


def _literals(hint: Any) -> tuple[Any, ...]:
    """The values that a field may have, if they are listed."""
    if get_origin(hint) is Literal:
        return get_args(hint)
    found = [_literals(arm) for arm in get_args(hint) if get_origin(arm) is Literal]
    return (*found[0], None) if found else ()


def _what(value: Any) -> str:
    if value is None:
        return "None"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    if isinstance(value, str | int | float):
        return f"{value!r:.60}"
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"
