"""Small closed loops around one component, with shipped components as the others.

A vehicle is driven by a stand-in controller with constant inputs, because the controller that fits it may be missing.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from worker.engine.kernels.component import (
    Avoider,
    Component,
    Controller,
    Criterion,
    Declared,
    Environment,
    Fault,
    Obstacle,
    Signal,
    Vehicle,
)
from worker.engine.kernels.layout import Parts, Placed, Section
from worker.engine.kernels.maths import kernel
from worker.running.examination.naming import FOLDERS, shipped_file

Own = Callable[[str], Component | None]
"""The operator's own vehicle of this name, if it can be used."""

DRIVEN = {
    (2, "enu"): ("unicycle", "pid_speed"),
    (3, "ned"): ("fixed_wing_linear", "autopilot_wings_level"),
    (3, "enu"): ("fixed_wing_linear", "autopilot_wings_level"),
}
"""A shipped vehicle and its controller, by dimension and world axes; none in space has z up, and most components do not
depend on the axes."""
AVOIDERS = {(2, "force"): "none", (2, "velocity"): "closest_approach", (3, "force"): "none_3d",
            (3, "velocity"): "closest_approach_3d"}  # fmt: skip
OBSTACLES = {2: "circle", 3: "sphere"}


class NoParameters(NamedTuple):
    """The parameters of the stand-in controller, of which it has none."""


@kernel
def nothing(x: Any, demand: Any, p: Any) -> tuple[()]:
    return ()


def scenes(component: Component, own: Own) -> Iterator[Parts]:
    """Every closed loop that is needed to call each of its kernels; none if no vehicle exists for a controller."""
    if isinstance(component, Vehicle):
        controller = _standing_in(component)
        yield _parts(component, controller, _shipped_avoider(component.dimension, "force"))
    elif isinstance(component, Controller):
        vehicle = _driven(component, own)
        for demand in component.command if vehicle is not None else ():
            assert vehicle is not None
            yield _parts(vehicle, component, _shipped_avoider(vehicle.dimension, demand))
    elif isinstance(component, Avoider):
        yield _parts(*_pair(component.dimension, component.frame), component)
    else:
        for dimension in _dimensions(component):
            vehicle, controller = _pair(dimension, component.frame)
            yield _parts(vehicle, controller, _shipped_avoider(dimension, "force"), component)


def nominal(parts: Parts, sections: tuple[Section, ...]) -> list[float]:
    """The flat vector of nominal values: the default of each parameter, or a usual one within its limits."""
    values = {f"{s.prefix}.{p.name}": usual(p, s.prefix) for s in sections for p in s.parameters}
    solved: Mapping[str, float] = values
    return [*values.values(), *(parts.vehicle.trim.solve(solved) if parts.vehicle.trim else ())]


def usual(p: Declared, prefix: str) -> float:
    """The default of a parameter, or a usual value within its limits for a component with this prefix."""
    value = {"goal": 60.0, "criterion": 1e-3, "start": 0.0}.get(prefix, 30.0) if p.default is None else p.default
    return float(min(max(value, p.low), p.high))


def shipped(role: str, name: str) -> Any:
    """A component of this installation."""
    return importlib.import_module(f"worker.engine.components.{FOLDERS[role]}.{name}").component


def _parts(vehicle: Vehicle, controller: Controller, avoider: Avoider, *more: Component) -> Parts:
    of: dict[type, list[Any]] = {Obstacle: [], Environment: [], Fault: [], Criterion: []}
    for component in more:
        next(found for kind, found in of.items() if isinstance(component, kind)).append(component)
    criteria = of[Criterion]
    decides = [c for c in criteria if c.worse == "low"] or [shipped("criterion", "separation")]
    return Parts(
        vehicle,
        controller,
        avoider,
        tuple(of[Obstacle]) or (shipped("obstacle", OBSTACLES[vehicle.dimension]),),
        decides[0],
        tuple(of[Environment]),
        tuple(Placed(fault) for fault in of[Fault]),
        sampled=any(fault.path == "guidance" for fault in of[Fault]),
        objectives=tuple(c for c in criteria if c.worse == "high"),
    )


def _pair(dimension: int, frame: str | None) -> tuple[Vehicle, Controller]:
    vehicle, controller = (
        DRIVEN[dimension, frame or "enu"] if (dimension, frame or "enu") in DRIVEN else DRIVEN[2, "enu"]
    )
    return shipped("vehicle", vehicle), shipped("controller", controller)


def _shipped_avoider(dimension: int, demand: str) -> Avoider:
    avoider: Avoider = shipped("avoider", AVOIDERS[dimension, demand])
    return avoider


def _dimensions(component: Component) -> tuple[int, ...]:
    if isinstance(component, Criterion):
        return tuple(component.sample)
    if isinstance(component, Obstacle):
        return (component.dimension,)
    frame = component.frame if isinstance(component, Environment | Fault) else None
    return (3,) if frame == "ned" else (2,)


def _driven(controller: Controller, own: Own) -> Vehicle | None:
    """The first vehicle that it fits; None if its own vehicle cannot be used (yet)."""
    for name in controller.fits:
        found = shipped("vehicle", name) if shipped_file("vehicle", name) else own(name)
        if isinstance(found, Vehicle):
            return found
    return None


def _standing_in(vehicle: Vehicle) -> Controller:
    zeros = (0.0,) * len(vehicle.inputs)

    @kernel
    def command(t: float, x: Any, c: Any, demand: Any, p: Any) -> Any:
        return zeros, ()

    globals()[f"standing_in_{len(zeros)}"] = command  # the generated code calls kernels by name
    by_force: dict[str, Any] = {"force": nothing}
    signals: tuple[Signal, ...] = ()
    return Controller(
        "standing_in", "Constant inputs", (vehicle.name,), NoParameters, 0, signals, by_force, {"force": command},
        by_force,
    )  # fmt: skip
