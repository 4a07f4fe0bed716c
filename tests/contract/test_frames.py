"""Every component in space whose answer has a vertical sense or a handedness of its own declares its frame.

A made-up vehicle shows what each component does in one derivative of the loop: wind, demand, obstacles, distances. The
world is mirrored (z to -z; x and y exchanged) with every quantity whose text names its axes, and the answer has to be
the mirrored one. What is not has "up", "right" or "heading" built in.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from campaigns import Catalogue, check
from campaigns.asked.load import load_document
from campaigns.checked.check import simulation_problems
from clearance.testing.scenes import around, entry, own
from worker.engine.kernels.component import Component, Controller, Parameter, Signal, Vehicle
from worker.engine.kernels.layout import Parts, Placed
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.catalogue.installed import catalogue, components

ROLES = ("avoider", "obstacle", "environment", "fault", "criterion")
MIRRORS = ("z", "xy")

CASES = 60


class Start(NamedTuple):
    x: Annotated[float, Parameter("m", "Start, x")] = 0.0
    y: Annotated[float, Parameter("m", "Start, y")] = 0.0
    z: Annotated[float, Parameter("m", "Start, z")] = 0.0
    vx: Annotated[float, Parameter("m/s", "Velocity, x")] = 0.0
    vy: Annotated[float, Parameter("m/s", "Velocity, y")] = 0.0
    vz: Annotated[float, Parameter("m/s", "Velocity, z")] = 0.0


class Nothing(NamedTuple):
    """It has nothing to set."""


def _turned(x: Any, e: Any) -> Any:
    """The state as navigation reports it: displaced, turned from x towards y, faster."""
    s, c = math.sin(e.heading), math.cos(e.heading)
    k = 1.0 + e.speed / math.sqrt(x[3] ** 2 + x[4] ** 2 + x[5] ** 2)
    return (
        x[0] + e.x, x[1] + e.y, x[2] + e.z, k * (c * x[3] - s * x[4]), k * (s * x[3] + c * x[4]), k * x[5],
    )  # fmt: skip


def _pose(x: Any, p: Any) -> Any:
    level = math.hypot(x[3], x[4])
    return x[0], x[1], x[2], 0.0, -math.atan2(x[5], level), math.atan2(x[4], x[3])


def _begin(start: Start, p: Any) -> Any:
    return tuple(start)


def _derivative(t: float, x: Any, u: Any, env: Any, p: Any) -> Any:
    return env.wind_x, env.wind_y, env.wind_z, *u


def _position(x: Any, p: Any) -> Any:
    return x[0], x[1], x[2]


def _velocity(x: Any, p: Any) -> Any:
    return x[3], x[4], x[5]


def _outside(x: Any, p: Any) -> float:
    return 0.0


def _measured(x: Any, e: Any, p: Any) -> Any:
    return _turned(x, e)


def _nothing(x: Any, demand: Any, p: Any) -> Any:
    return ()


def _command(t: float, x: Any, c: Any, demand: Any, p: Any) -> Any:
    return demand, ()


VEHICLE = Vehicle(
    name="anything",
    title="Anything",
    dimension=3,
    parameters=Nothing,
    start=Start,
    states=tuple(Signal(n, n, "") for n in Start._fields),
    inputs=tuple(Signal(n, n, "") for n in ("ux", "uy", "uz")),
    limits=(),
    begin=_begin,
    derivative=_derivative,
    position=_position,
    velocity=_velocity,
    pose=_pose,
    outside=_outside,
    measured=_measured,
)
KINDS = ("force", "velocity")
CONTROLLER = Controller(
    name="as_asked",
    title="As asked",
    fits=("anything",),
    parameters=Nothing,
    states=0,
    signals=(),
    prepare=dict.fromkeys(KINDS, _nothing),
    command=dict.fromkeys(KINDS, _command),
    references=dict.fromkeys(KINDS, _nothing),
)


@cache
def rig(role: str, name: str) -> Loop:
    """The component among others that have no frame; of what errs the avoider looks at obstacles' velocities too."""
    known: Any = components()
    component = known[role, name]
    path = entry(component).path
    others = known["avoider", "ge_cui_3d" if role == "fault" else "none_3d"]
    parts = Parts(
        VEHICLE,
        CONTROLLER,
        component if role == "avoider" else others,
        (component if role == "obstacle" else known["obstacle", "waypoint_sphere"],),
        known["criterion", "separation"],
        environment=(component,) if role == "environment" else (),
        faults=(Placed(component, 0),) if path else (),
        objectives=(component if role == "criterion" else known["criterion", "surface_separation"],),
    )
    return Loop(parts, lanes=1, compiled=False)


def drawn(loop: Loop, chance: np.random.Generator) -> dict[str, float]:
    """All values: positions around the origin, the obstacle approaching the vehicle, the rest moderate."""
    found = {}
    for section in loop.sections:
        for p in section.parameters:
            path = f"{section.prefix}.{p.name}"
            nominal = 1.0 if p.default is None else p.default
            if p.unit == "m" and p.name.endswith((".x", ".y", ".z")):
                value = chance.normal() * 30.0
            elif path.startswith("start.v"):
                value = chance.normal() * 10.0
            elif p.unit in ("rad", "m/s") or (nominal == 0.0 and p.unit):
                value = nominal + chance.normal() * (0.7 if "rad" in p.unit else 3.0)
            else:
                value = nominal * chance.uniform(0.8, 1.2)
            found[path] = float(np.clip(value, p.low, p.high))
    if chance.uniform() < 0.5:  # exactly head-on: some rules only speak there
        speed = [found[f"start.v{a}"] for a in "xyz"]
        for i, a in enumerate("xyz"):
            found[f"start.{a}"] = 0.0
            for name, k in (("position", 6.0), ("centre", 6.0), ("waypoint1", -6.0), ("goal", -6.0)):
                if f"obstacles.0.{name}.{a}" in found:
                    found[f"obstacles.0.{name}.{a}"] = k * speed[i]
            if f"goal.{a}" in found:
                found[f"goal.{a}"] = 20.0 * speed[i]
    return found


def mirrored(loop: Loop, values: dict[str, float], mirror: str) -> dict[str, float]:
    """The values mirrored, according to the axes in each parameter's name and text."""
    texts = {f"{s.prefix}.{p.name}": (p.text, p.unit, p.low < 0) for s in loop.sections for p in s.parameters}
    found = dict(values)
    for path, value in values.items():
        text, unit, signed = texts[path]
        axis = re.search(r"(?:^|[., ])([xyz])$", path) or re.search(r"(?:, |^\w+ |v)([xyz])$", text)
        letter = axis[1] if axis else path[-1] if re.search(r"\.(d?v?)[xyz]$", path) else ""
        along_z = "along z" in text or "towards z" in text or "z axis" in text
        if mirror == "z":
            if signed and (letter == "z") != along_z:
                found[path] = -value
        elif letter in ("x", "y"):
            found[path] = values[path[: path.rindex(letter)] + ("y" if letter == "x" else "x")]
        elif "from x towards y" in text and unit == "rad":
            found[path] = (0.0 if text.startswith("Error") else math.pi / 2) - value
        elif "from x towards y" in text:
            found[path] = -value
        elif "from the x axis" in text:
            found[path] = math.pi / 2 - value
    return found


def reflected(vector: Any, mirror: str) -> Any:
    """Vectors of space one after the other, in the mirrored world."""
    rows = np.reshape(vector, (-1, 3))
    return (rows * (1, 1, -1) if mirror == "z" else rows[:, (1, 0, 2)]).ravel()


def answer(loop: Loop, values: dict[str, float]) -> tuple[Any, Any]:
    """What is done in the loop at two instants: vectors, and numbers that no mirror changes."""
    p = loop.extend(np.array(list(values.values())))
    x, g = loop.part("initial")(p), loop.part("initial_guidance")(p)
    g = loop.part("guide")(0.0, x, g, p) if loop.parts.avoider.memory else g
    vectors: list[float] = []
    numbers: list[float] = []
    for t in (0.3, 4.0):
        dx, channels = loop.part("closed_loop")(t, x, g, p)
        own_states, others = dx[:6], dx[len(x) - sum(o.states for o in loop.parts.obstacles) :]
        vectors += [*own_states, *(others if loop.parts.obstacles[0].states else ())]
        numbers += channels
    return np.array(vectors), np.array(numbers)


def has_a_sense(component: Component) -> bool:
    """Whether a mirrored world is answered otherwise than by the mirrored answer."""
    loop, chance = rig(component.role, component.name), np.random.default_rng(3)
    for _ in range(CASES):
        values = drawn(loop, chance)
        vectors, numbers = answer(loop, values)
        for mirror in MIRRORS:
            seen, also = answer(loop, mirrored(loop, values, mirror))
            size = 1e-6 * (1.0 + np.abs(vectors).max())
            if not np.allclose(seen, reflected(vectors, mirror), atol=size, rtol=1e-6, equal_nan=True):
                return True
            if not np.allclose(also, numbers, rtol=1e-6, atol=1e-6, equal_nan=True):
                return True
    return False


def in_space(component: Component) -> bool:
    return component.role in ROLES and entry(component).dimension in (None, 3)


def random(component: Component) -> bool:
    """A single realisation has a handedness by chance; the set of all has none."""
    return any(path.endswith(".seed") for path in own(component))


def of_one_input(component: Component) -> bool:
    """Numbers without axes: an actuator's, how late a demand is, the largest command on an input."""
    return entry(component).path in ("actuator", "guidance") or component.name == "peak_command"


EACH = [c for c in components().values() if in_space(c) and not random(c) and not of_one_input(c)]
DECLARED = [c for c in components().values() if entry(c).written_in]


# By day all that declare a frame, and a third of the others.
@pytest.mark.by_day(5)
@pytest.mark.parametrize(
    "component",
    [pytest.param(c, id=f"{c.role}-{c.name}", marks=() if entry(c).written_in or k % 3 == 0 else pytest.mark.nightly)
     for k, c in enumerate(EACH)],
)  # fmt: skip
def test_what_has_a_sense_of_up_or_right_declares_its_frame(component: Component) -> None:
    assert has_a_sense(component) == bool(entry(component).written_in)


def turned(described: Catalogue) -> Catalogue:
    """The catalogue of an installation whose vehicles in space have z up."""
    vehicles = [
        c.model_copy(update={"frame": "enu"}) if c.role == "vehicle" and c.dimension == 3 else c
        for c in described.components
    ]
    return described.model_copy(update={"components": vehicles})


@pytest.mark.parametrize("component", DECLARED, ids=lambda c: f"{c.role}-{c.name}")
def test_a_vehicle_with_other_axes_is_refused_with_both_named(component: Component) -> None:
    campaign = load_document(around(component))
    assert check(campaign, catalogue()) == []
    found = check(campaign, turned(catalogue()))
    assert [p for p in found if p.given == component.name and "z down" in p.message and "z up" in p.message]
    assert all(p.given in [c.name for c in DECLARED] for p in found)
    # What is stored can be shown.
    assert simulation_problems(campaign, turned(catalogue())) == []


def test_what_has_no_sense_of_its_own_fits_either() -> None:
    document = around(components()["obstacle", "waypoint_sphere"])
    campaign = load_document(document | {"scenario": document["scenario"] | {"avoider": {"component": "none_3d"}}})
    assert check(campaign, turned(catalogue())) == []
