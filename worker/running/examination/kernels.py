"""The kernels of each kind of component: their arguments, and the shape of their results.

`worker.engine.kernels.signatures` states the same as types, with units.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from worker.engine.kernels.component import (
    Avoider,
    Component,
    Controller,
    Criterion,
    Environment,
    Fault,
    Obstacle,
    Signal,
    Vehicle,
)
from worker.running.examination import shapes
from worker.running.examination.shapes import Number, Numbers, Pair, Shape, numbers


@dataclass(frozen=True)
class Slot:
    """One kernel of a component: the field that names it, its function, its arguments, and what it returns.

    shape: None if the component chooses it. plain: it runs in plain Python and needs no decorator.
    """

    field: str
    function: Any
    arguments: tuple[str, ...]
    shape: Shape | None
    plain: bool = False


AXES = ("x", "y", "z")
POSE = Numbers(("x", "y", "z", "roll", "pitch", "yaw"), "the pose")
FAULTS: dict[str, tuple[str, Shape]] = {
    "perception": ("t index own v body p", shapes.SIGHT),
    "timing": ("t p", shapes.SEEN),
    "navigation": ("t p", shapes.ERRORS),
    "guidance": ("p", Number("the delay in guidance periods")),
}


def kernels(component: Component, driven: Vehicle | None = None) -> Iterator[Slot]:
    """The kernels that a component has; driven: the vehicle of a controller, which determines its results."""
    derived = component.derived
    if derived is not None:
        constants: Any = derived.constants
        yield _slot("derived", derived.derive, "p trim", Numbers(constants._fields, "the derived constants"))
    if isinstance(component, Controller):
        yield from _controller(component, driven)
    else:
        yield from next(of for kind, of in _OF.items() if isinstance(component, kind))(component)
    if isinstance(component, Environment | Fault) and component.switches is not None:
        yield Slot("switches", component.switches, ("p", "horizon"), None, plain=True)


def _slot(field: str, function: Any, arguments: str, shape: Shape | None) -> Slot:
    return Slot(field, function, tuple(arguments.split()), shape)


def _optional(field: str, function: Any, arguments: str, shape: Shape | None) -> Iterator[Slot]:
    """An optional kernel, if the component has it."""
    if function is not None:
        yield _slot(field, function, arguments, shape)


def _vehicle(v: Vehicle) -> Iterator[Slot]:
    state = _signals(v.states, "the states")
    place = Numbers(AXES[: v.dimension], "the position")
    yield _slot("begin", v.begin, "start p", state)
    yield _slot("derivative", v.derivative, "t x u env p", Numbers(state.names, "the rates of the states"))
    yield _slot("position", v.position, "x p", place)
    yield _slot("velocity", v.velocity, "x p", Numbers(place.names, "the velocity"))
    yield _slot("pose", v.pose, "x p", POSE)
    yield _slot("outside", v.outside, "x p", Number("0.0 inside the envelope, else the number of the exceeded limit"))
    yield _slot("measured", v.measured, "x e p", state)
    yield from _optional("settle", v.settle, "x p", state)
    yield from _optional("felt", v.felt, "x env p", state)


def _controller(c: Controller, driven: Vehicle | None) -> Iterator[Slot]:
    own = numbers(c.states, "the controller's states")
    inputs = None if driven is None else Pair(_signals(driven.inputs, "the vehicle's inputs"), own)
    demand = None if driven is None else numbers(driven.dimension, "the references")
    for kind, function in c.prepare.items():
        yield _slot(f"prepare[{kind!r}]", function, "x demand p", own)
    for kind, commanding in c.command.items():
        yield _slot(f"command[{kind!r}]", commanding, "t x c demand p", inputs)
    for kind, function in c.references.items():
        yield _slot(f"references[{kind!r}]", function, "x demand p", _signals(c.signals, "the signals"))
    for kind, function in (c.translate or {}).items():
        yield _slot(f"translate[{kind!r}]", function, "x demand p", demand)


def _avoider(a: Avoider) -> Iterator[Slot]:
    memory = numbers(a.memory, "the memory")
    axes = Numbers(AXES[: a.dimension], f"the {a.demand}")
    bodies = "bodies" if a.weigh is None else "weighed"
    yield _slot("steer", a.steer, f"t q v goal {bodies} memory p", Pair(axes, memory))
    yield _slot("remember", a.remember, "p", memory)
    yield from _optional("first", a.first, "t q v goal memory p", None)
    yield from _optional("weigh", a.weigh, "weighed number body t q v goal memory p", None)


def _obstacle(o: Obstacle) -> Iterator[Slot]:
    yield _slot("body", o.body, "t o q p", shapes.BODY if o.dimension == 2 else shapes.BODY3)
    yield from _optional("wake", o.wake, "p", numbers(o.states, "the states"))
    yield from _optional("move", o.move, "t o q v p", numbers(o.states, "the rates of the states"))


def _environment(e: Environment) -> Iterator[Slot]:
    noise = "t q v e p" if e.draw is None else "t q v e n p"
    yield _slot("blow", e.blow, noise, Pair(shapes.SURROUNDINGS, numbers(e.states, "the rates of the states")))
    yield from _optional("wake", e.wake, "p", numbers(e.states, "the states"))
    yield from _optional("draw", e.draw, "t p", numbers(e.draws, "the samples"))


def _fault(f: Fault) -> Iterator[Slot]:
    if f.path == "actuator":
        yield _slot(
            "kernel", f.kernel, "t u a p", Pair(Number("the input"), numbers(f.states, "the rates of the states"))
        )
    else:
        arguments, shape = FAULTS[f.path]
        yield _slot("kernel", f.kernel, arguments, shape)
    yield from _optional("rest", f.rest, "u p", numbers(f.states, "the states"))


def _criterion(c: Criterion) -> Iterator[Slot]:
    for dimension, function in c.sample.items():
        yield _slot(f"sample[{dimension}]", function, "t q v x u to p", numbers(1, "the channel"))
    yield _slot("value", c.value, "found p", Number())
    yield from _optional("excluded", c.excluded, "first p", shapes.Truth())


_OF: dict[type, Callable[[Any], Iterator[Slot]]] = {
    Vehicle: _vehicle, Avoider: _avoider, Obstacle: _obstacle, Environment: _environment, Fault: _fault,
    Criterion: _criterion,
}  # fmt: skip


def _signals(signals: tuple[Signal, ...], what: str) -> Numbers:
    return Numbers(tuple(s.name for s in signals), what)
