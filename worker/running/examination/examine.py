"""Examines the file of a component in stages and stops at the first mistake."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from worker.running.examination import reading
from worker.running.examination.mistake import Mistake
from worker.running.examination.naming import NAME
from worker.running.examination.time_limit import Overdue, limited

PACKAGE = "worker.engine.components.own"
RATE = (
    "it moves by itself (moving, states, or t in its body) and declares no rate, so no run with it is cleared: write "
    "rate=Rate(...), how fast it turns"
)

SWITCHES = (
    "it reads the time and declares no switches, so a change between the instants of the integration may be missed, "
    "which the scope of a verdict states: write switches=..., a function (p, horizon) that returns the instants at "
    "which it changes abruptly, or an empty list if it never does"
)
REACH = (
    "it declares no reach, so no run with it is cleared whose criterion measures to centres: write reach=Reach(...), "
    "the largest distance of a point inside it from the centre that body reports"
)
MEASURED = (
    "it does not declare to which point of the obstacles it measures, so no run with it is cleared: write "
    'measured_to="centre" or "surface", or "none" if it measures no distance'
)


@dataclass(frozen=True)
class Examined:
    """The result: role and name of a component that can be used, or the mistake with its line, 0 if unknown."""

    role: str = ""
    name: str = ""
    title: str = ""
    simulated: bool = True
    """False for a controller of a vehicle that cannot be used: nothing could be simulated with it."""
    text: str = ""
    line: int = 0
    note: str = ""
    """What does not hold of runs with a component that can be used."""
    overdue: bool = False
    """Whether it took too long, which may pass."""


def examine(file: Path, vehicles: Mapping[str, str], limit: float = 0.0) -> Examined:
    """Examine a file of the operator's folders; the process may then be unfit for other work.

    vehicles: the modules of the operator's own vehicles, by name. limit: time for importing it, and for simulating
    it [s]; 0 for none.
    """
    try:
        return _examined(file, vehicles, limit)
    except Mistake as mistake:
        return Examined(text=mistake.text, line=mistake.line, overdue=isinstance(mistake, Overdue))


def _examined(file: Path, vehicles: Mapping[str, str], limit: float) -> Examined:
    if not NAME.fullmatch(file.stem):
        raise Mistake(
            f"the file is called {file.name}, expected small letters, digits and _ such as my_robot.py: rename it"
        )
    source = reading.read(file)
    reading.check(source)
    # What follows loads the compiler, which takes a second.
    from worker.engine.kernels.component import Component, Criterion, Environment, Fault, Obstacle, unswitched
    from worker.running.examination import purity
    from worker.running.examination.compiling import compile_each
    from worker.running.examination.declaring import declared_by
    from worker.running.examination.distances import note_of
    from worker.running.examination.flying import flown

    def own(name: str) -> Component | None:
        try:
            found: Component | None = getattr(importlib.import_module(vehicles[name]), "component", None)
        except (Exception, SystemExit):
            return None
        return found

    module = f"{PACKAGE}.{file.stem}"
    with limited(limit, file, "while importing it"):
        component = declared_by(source, module)
    purity.check(source, module)
    with limited(limit, file, "while simulating the nominal values"):
        calls = flown(component, source, own)
    compile_each(source, module, calls)
    notes = []
    if isinstance(component, Obstacle):
        notes += [RATE] * (component.moving and component.rate is None) + [REACH] * (component.reach is None)
    if isinstance(component, Criterion) and component.of == "obstacles" and not component.measured_to:
        notes += [MEASURED]
    if isinstance(component, Environment | Fault):
        notes += [SWITCHES] * unswitched(component)
    if isinstance(component, Criterion):
        with limited(limit, file, "while comparing its value with distances"):
            notes += filter(None, [note_of(component, own)])
    return Examined(component.role, component.name, component.title, bool(calls), note="; ".join(notes))
