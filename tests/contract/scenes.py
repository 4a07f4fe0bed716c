"""A small campaign around any one component, so that it can be flown. Start reading at `around`."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np

from campaigns.asked.load import load_document
from campaigns.catalogue import ComponentEntry, ParameterEntry
from worker.catalogue.installed import catalogue, components
from worker.kernels.component import Component, Controller, Criterion, Vehicle
from worker.systems.problem import Floats, Problem

HORIZON, STEP = 0.32, 0.005
"""[s]"""


def entry(component: Component) -> ComponentEntry:
    """How the catalogue describes it."""
    found = catalogue().component(component.role, component.name)
    assert found is not None
    return found


def around(component: Component) -> dict[str, Any]:
    """A campaign that flies this component with the first others that fit."""
    vehicle = component if isinstance(component, Vehicle) else _vehicle(component)
    controller = component if isinstance(component, Controller) else _controller(vehicle)
    chosen: dict[str, Component] = {"vehicle": vehicle, "controller": controller, component.role: component}
    for role in ("avoider", "obstacle", "criterion"):
        if role not in chosen or (role == "criterion" and _beside(component)):
            chosen[role] = _first(role, vehicle, controller)
    scenario: dict[str, Any] = {role: _part(chosen[role]) for role in ("vehicle", "controller", "avoider")}
    scenario |= {
        "start": _values(entry(vehicle).starts, 0.0),
        "goal": _values(entry(chosen["avoider"]).goals, 60.0),
        "obstacles": [_part(chosen["obstacle"])],
        "horizon": HORIZON,
        "step": STEP,
    }
    if component.role == "environment":
        scenario["environment"] = [_part(component)]
    if component.role == "fault":
        on = vehicle.inputs[0].name if entry(component).path == "actuator" else ""
        scenario["faults"] = [_part(component) | {"on": on}]
        if entry(component).path == "guidance":  # only sampled guidance can be late
            scenario["guidance"] = {"period": 4 * STEP}
    more: dict[str, Any] = {}
    # Some avoiders only hold a course and have no goal.
    path, value = next(((f"goal.{name}", at) for name, at in scenario["goal"].items()), ("start.x", 0.0))
    if _beside(component):
        more["objectives"] = [_part(component)]
    return more | {
        "name": f"{component.role} {component.name}",
        "scenario": scenario,
        "uncertain": {path: {"low": value - 1, "high": value + 1}},
        "criterion": _criterion(chosen["criterion"]),
        "stages": {"search": [{"method": "direct", "evaluations": 1}]},
    }


def problem(component: Component, compiled: bool = True) -> Problem:
    """That campaign, ready to fly; the same for components that share it."""
    document = around(component) | {"name": "contract"}
    return _problem(json.dumps(document), compiled)


@cache
def _problem(document: str, compiled: bool) -> Problem:
    return Problem(load_document(json.loads(document)), compiled)


def prefixes(component: Component) -> tuple[str, ...]:
    """Under what a campaign names its parameters."""
    return {
        "vehicle": ("vehicle.", "start."), "controller": ("controller.",), "avoider": ("avoider.", "goal."),
        "obstacle": ("obstacles.0.",), "environment": ("environment.0.",), "fault": ("faults.0.",),
        "criterion": ("objectives.0." if _beside(component) else "criterion.",),
    }[component.role]  # fmt: skip


def own(component: Component) -> dict[str, ParameterEntry]:
    """Its parameters by path."""
    found: dict[str, ParameterEntry] = {}
    described = entry(component)
    for prefix in prefixes(component):
        entries = {"start.": described.starts, "goal.": described.goals}.get(prefix, described.parameters)
        found |= {prefix + p.name: p for p in entries}
    return found


def drawn(component: Component, count: int, seed: int = 1) -> Floats:
    """Vectors (count, size) whose parameters of this component lie anywhere within its limits, often on them."""
    chance, flown = np.random.default_rng(seed), problem(component)
    vectors = np.repeat(flown.nominal[None, :], count, axis=0)
    for path, p in own(component).items():
        nominal = vectors[0, flown.paths[path]]
        ways = np.stack(
            [
                chance.uniform(p.low, p.high, count),
                np.full(count, p.low),
                np.full(count, p.high),
                np.full(count, nominal),
                np.clip(nominal * 10 ** chance.uniform(-3, 3, count), p.low, p.high),
                np.clip(nominal + chance.normal(size=count), p.low, p.high),
            ]
        )
        vectors[:, flown.paths[path]] = ways[chance.integers(0, len(ways), count), np.arange(count)]
    return vectors


def near(component: Component, count: int, seed: int = 1) -> Floats:
    """Vectors (count, size) whose parameters of this component lie within a tenth of their nominal values."""
    chance, flown = np.random.default_rng(seed), problem(component)
    vectors = np.repeat(flown.nominal[None, :], count, axis=0)
    for path, p in own(component).items():
        k = flown.paths[path]
        vectors[:, k] = np.clip(vectors[:, k] * chance.uniform(0.9, 1.1, count), p.low, p.high)
    return vectors


def _criterion(component: Component) -> dict[str, Any]:
    """With a small threshold, so that every flight counts; one within the obstacles has to be stated."""
    stated = {"from_centre": True} if entry(component).measured_to == "centre" else {}
    return {"component": component.name, "threshold": 1e-3} | stated


def _beside(component: Component) -> bool:
    """Whether it is a criterion that cannot decide."""
    return isinstance(component, Criterion) and component.worse == "high"


def _part(component: Component) -> dict[str, Any]:
    return {"component": component.name, "parameters": _values(entry(component).parameters, 30.0)}


def _values(entries: list[ParameterEntry], otherwise: float) -> dict[str, float]:
    """A value for everything that must be given."""
    return {p.name: float(np.clip(otherwise, p.low, p.high)) for p in entries if p.default is None}


def _of(role: str) -> list[Any]:
    return [c for (r, _), c in components().items() if r == role]


def _vehicle(component: Component) -> Vehicle:
    if isinstance(component, Controller):
        return next(v for v in _of("vehicle") if v.name in component.fits)
    dimension = entry(component).dimension
    demand = getattr(component, "demand", None)
    # The one with the fewest states: its loop is compiled in a fraction of the time of an aircraft's.
    return next(
        v
        for v in sorted(_of("vehicle"), key=lambda v: len(v.states))
        if dimension in (None, v.dimension)
        and any(v.name in c.fits and demand in (None, *c.command) for c in _of("controller"))
    )


def _controller(vehicle: Vehicle) -> Controller:
    return next(c for c in _of("controller") if vehicle.name in c.fits)


def _first(role: str, vehicle: Vehicle, controller: Controller) -> Component:
    return next(
        c
        for c in _of(role)
        if entry(c).dimension in (None, vehicle.dimension)
        and (role != "criterion" or c.worse == "low")
        and (role != "avoider" or c.demand in controller.command)
    )
