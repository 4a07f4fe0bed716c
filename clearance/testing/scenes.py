"""A small campaign around any components, so that they can be simulated."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from campaigns.asked.load import load_document
from campaigns.catalogue import ComponentEntry, ParameterEntry
from clearance.testing.problems import Problem
from worker.engine.kernels.component import Avoider, Component, Controller, Criterion, Vehicle
from worker.engine.systems.base import Floats
from worker.running.catalogue.installed import catalogue, components, methods

HORIZON, STEP = 0.32, 0.005
"""[s]"""

NOT_INSTALLED = "install the package that declares it, so that its entry point is found"

FEW = 2
"""Lanes of the scenes that several components share."""

ONE = {
    "vehicle": ("vehicle.", "start."), "controller": ("controller.",), "avoider": ("avoider.", "goal."),
    "criterion": ("criterion.",),
}  # fmt: skip
"""Of which a scene has one; under what a campaign names its parameters."""


def entry(component: Component) -> ComponentEntry:
    """How the catalogue describes it."""
    found = catalogue().component(component.role, component.name)
    assert found is not None, f"the {component.role} {component.name!r} is not installed: {NOT_INSTALLED}"
    return found


class Scene(NamedTuple):
    """A campaign around some components; under what it names the parameters of each, in their order."""

    document: dict[str, object]
    prefixes: tuple[tuple[str, ...], ...]


def scene(*chosen: Component) -> Scene:
    """A campaign that simulates these components with the first others that fit.

    At most one vehicle, controller, avoider and criterion that decides.
    """
    decides = [c for c in chosen if not _beside(c)]
    vehicle = next((c for c in chosen if isinstance(c, Vehicle)), None) or _vehicle(chosen)
    controller = next((c for c in chosen if isinstance(c, Controller)), None) or controller_for(vehicle)
    several = {role: [c for c in decides if c.role == role] for role in (*ONE, "obstacle", "environment", "fault")}
    several |= {"vehicle": [vehicle], "controller": [controller]}
    for role in ("avoider", "obstacle", "criterion"):
        several[role] = several[role] or [_first(role, vehicle, controller)]
    (avoider,), (criterion,), beside = several["avoider"], several["criterion"], [c for c in chosen if _beside(c)]
    goal = _values(entry(avoider).goals, 60.0)
    scenario: dict[str, object] = {role: _part(several[role][0]) for role in ("vehicle", "controller", "avoider")}
    scenario |= {
        "start": _values(entry(vehicle).starts, 0.0),
        "goal": goal,
        "obstacles": [_part(c) for c in several["obstacle"]],
        "environment": [_part(c) for c in several["environment"]],
        "faults": [_fault(c, vehicle) for c in several["fault"]],
        "horizon": HORIZON,
        "step": STEP,
    }
    if any(entry(c).path == "guidance" for c in several["fault"]):  # only sampled guidance can be late
        scenario["guidance"] = {"period": 4 * STEP}
    # Some avoiders only hold a course and have no goal.
    path, value = next(((f"goal.{name}", at) for name, at in goal.items()), ("start.x", 0.0))
    document: dict[str, object] = {
        "name": "contract",
        "scenario": scenario,
        "uncertain": {path: {"low": value - 1, "high": value + 1}},
        "criterion": _criterion(criterion),
        "objectives": [_part(c) for c in beside],
        "stages": {"search": [{"method": next(iter(methods())), "evaluations": 1}]},
    }
    lists = {"obstacle": "obstacles", "environment": "environment", "fault": "faults"}
    places = {id(c): f"{lists[role]}.{k}." for role in lists for k, c in enumerate(several[role])}
    places |= {id(c): f"objectives.{k}." for k, c in enumerate(beside)}
    return Scene(document, tuple(ONE.get(c.role, ()) if id(c) not in places else (places[id(c)],) for c in chosen))


def around(component: Component) -> dict[str, object]:
    """A campaign that simulates this component with the first others that fit."""
    return scene(component).document


def problem(*chosen: Component, compiled: bool = True) -> Problem:
    """The compiled campaign of a scene, with half the horizon in plain Python; shared by its components.

    Of several components in `FEW` lanes, which compile in three quarters of the time.
    """
    document = json.loads(json.dumps(scene(*chosen).document))
    document["scenario"]["horizon"] = HORIZON if compiled else HORIZON / 2
    return _problem(json.dumps(document), compiled, FEW if compiled and len(chosen) > 1 else None)


@cache
def _problem(document: str, compiled: bool, lanes: int | None) -> Problem:
    return Problem(load_document(json.loads(document)), compiled, lanes)


def own(component: Component, among: tuple[Component, ...] = ()) -> dict[str, ParameterEntry]:
    """The parameters of a component by path, in its own scene or among others."""
    found: dict[str, ParameterEntry] = {}
    described, chosen = entry(component), among or (component,)
    for prefix in dict(zip(map(id, chosen), scene(*chosen).prefixes, strict=True))[id(component)]:
        entries = {"start.": described.starts, "goal.": described.goals}.get(prefix, described.parameters)
        found |= {prefix + p.name: p for p in entries}
    return found


def drawn(flown: Problem, of: Mapping[str, ParameterEntry], count: int, seed: int = 1) -> Floats:
    """Vectors (count, size) in which these parameters lie anywhere within their limits, often on them."""
    chance = np.random.default_rng(seed)
    vectors = np.repeat(flown.system.nominal[None, :], count, axis=0)
    for path, p in of.items():
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


def near(flown: Problem, of: Mapping[str, ParameterEntry], count: int, seed: int = 1) -> Floats:
    """Vectors (count, size) in which these parameters lie within a tenth of their nominal values."""
    chance = np.random.default_rng(seed)
    vectors = np.repeat(flown.system.nominal[None, :], count, axis=0)
    for path, p in of.items():
        k = flown.paths[path]
        vectors[:, k] = np.clip(vectors[:, k] * chance.uniform(0.9, 1.1, count), p.low, p.high)
    return vectors


def _criterion(component: Component) -> Mapping[str, object]:
    """A criterion with a small threshold, so that every flight counts; one within obstacles has to be stated."""
    stated = {"from_centre": True} if entry(component).measured_to == "centre" else {}
    return {"component": component.name, "threshold": 1e-3} | stated


def _beside(component: Component) -> bool:
    """Whether it is a criterion that cannot decide."""
    return isinstance(component, Criterion) and component.worse == "high"


def _part(component: Component) -> dict[str, object]:
    return {"component": component.name, "parameters": _values(entry(component).parameters, 30.0)}


def _fault(component: Component, vehicle: Vehicle) -> Mapping[str, object]:
    return _part(component) | {"on": vehicle.inputs[0].name if entry(component).path == "actuator" else ""}


def _values(entries: list[ParameterEntry], otherwise: float) -> dict[str, float]:
    """A value for everything that must be given."""
    return {p.name: float(np.clip(otherwise, p.low, p.high)) for p in entries if p.default is None}


def of_role(role: str) -> list[Any]:
    return [c for (r, _), c in components().items() if r == role]


def _vehicle(components: Sequence[Component]) -> Vehicle:
    fits = [set(c.fits) for c in components if isinstance(c, Controller)]
    dimensions = {entry(c).dimension for c in components} - {None}
    demand = next((c.demand for c in components if isinstance(c, Avoider)), None)
    # The one with the fewest states: its loop is compiled in a fraction of the time of an aircraft's.
    found: Vehicle = next(
        v
        for v in sorted(of_role("vehicle"), key=lambda v: len(v.states))
        if dimensions <= {v.dimension}
        and all(v.name in names for names in fits)
        and any(v.name in c.fits and demand in (None, *c.command) for c in of_role("controller"))
    )
    return found


def controller_for(vehicle: Vehicle) -> Controller:
    found: Controller = next(c for c in of_role("controller") if vehicle.name in c.fits)
    return found


def _first(role: str, vehicle: Vehicle, controller: Controller) -> Component:
    found: Component = next(
        c
        for c in of_role(role)
        if entry(c).dimension in (None, vehicle.dimension)
        and (role != "criterion" or c.worse == "low")
        and (role != "avoider" or c.demand in controller.command)
    )
    return found
