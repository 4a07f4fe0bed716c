"""Creates the system that a campaign names, and its problem; raises `CampaignUnusable` if that is not possible."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from campaigns import Campaign, Catalogue
from campaigns.asked.problem import Problem as Wrong
from campaigns.checked.check import parameters, simulation_problems
from worker.engine.problem.problem import Problem
from worker.engine.reference.reference import Reference
from worker.engine.systems.base import CampaignUnusable, Slotted, System, slotted
from worker.engine.systems.closed_loop.assemble import LANES
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.engine.systems.simulators.called import Called
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.described import BadDescriptor, Described
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.fmu import DescribedFmu
from worker.engine.systems.simulators.declared.folder import digest_of_place, files_of_place, reached_from
from worker.engine.systems.simulators.declared.function import declared_in, loaded
from worker.engine.systems.simulators.declared.reached import Reached
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.declared.simulator import Simulator as Declared
from worker.engine.systems.simulators.declared.unchanged import Unchanged
from worker.engine.systems.simulators.fmus import simulator as fmus
from worker.engine.systems.simulators.functions import InProcess, Isolated
from worker.running.catalogue.files import BadFile, PythonFunction, read_file
from worker.running.catalogue.inline import InlineProgram
from worker.running.catalogue.installed import catalogue, installed, simulators


def problem(campaign: Campaign) -> Problem:
    """The problem of a campaign, on the system that it names."""
    return Problem(campaign, system(campaign))


def system(campaign: Campaign) -> System:
    """The system that a campaign names."""
    if campaign.simulator is None:
        return closed_loop(campaign)
    known = catalogue()
    if problems := simulation_problems(campaign, known):
        raise CampaignUnusable(problems)
    return simulated(campaign, simulators()[campaign.simulator.name], known)


def closed_loop(campaign: Campaign, compiled: bool = True, lanes: int = LANES) -> ClosedLoop:
    """The closed loop of a campaign's scenario; in plain Python unless `compiled`."""
    return ClosedLoop(campaign, installed(), Reference, compiled, lanes)


def flights(campaign: Campaign, compiled: bool = True, lanes: int = LANES) -> Flights:
    """The trajectories of a campaign's scenario, without what confirms them."""
    return Flights(campaign, installed(), compiled, lanes)


def simulated(campaign: Campaign, simulator: Declared | Described | PythonFunction, known: Catalogue) -> Slotted:
    """Open this simulator for a campaign that the catalogue permits, and check it against its declaration."""
    nominal = {path: value for path, (_, value) in parameters(campaign, known).items()}
    result = campaign.criterion.result or ""
    opened: Any
    opening = Opening(nominal, result)
    if isinstance(simulator, Described):
        opened = _program(simulator, opening)
    elif isinstance(simulator, PythonFunction):
        opened = _python(simulator, opening)
    else:
        opened = simulator.open(opening)
    wrong = _undeclared(opened, nominal, result)
    if wrong:
        raise CampaignUnusable([Wrong("simulator.name", simulator.entry.name, wrong)])
    found, settings = slotted(opened), campaign.simulator
    return found if settings is None or (settings.calls == 1 and not settings.retries) else Called(found, settings)


def _python(simulator: PythonFunction, opening: Opening) -> Slotted:
    """A Python function; one of a file as the file is now, which must still be what the catalogue shows."""
    name = simulator.declaration.name
    files = Unchanged(files_of_place(simulator.place)) if simulator.place else None  # before anything of them is read
    file = simulator.place.get("file")
    if file is not None and simulator.call is None:
        try:
            found = [f for f in read_file(Path(file)) if f.declaration.name == name]
        except BadFile as error:
            raise CampaignUnusable([Wrong("simulator.name", name, f"it cannot be used any more: {error}")]) from None
        if [f.entry for f in found] != [simulator.entry]:
            text = "its file has other parameters or results than when this process started: start the run again"
            raise CampaignUnusable([Wrong("simulator.name", name, text)])
        simulator = found[0]
    digest = digest_of_place(simulator.place) if simulator.place else ""
    imports = reached_from(simulator.place) if simulator.place else Reached()
    basics = simulator.entry, opening, simulator.declaration, digest, imports.unknown
    if simulator.declaration.settings.isolated:
        return Isolated(simulator.place, *basics, files)
    call = simulator.call
    if call is None:
        try:
            call = declared_in(loaded(Path(simulator.place["file"]), first=False))[simulator.place["name"]].call
        except (Exception, SystemExit) as error:
            text = f"its file cannot be imported: {type(error).__name__}: {error}"
            raise CampaignUnusable([Wrong("simulator.name", name, text)]) from None
        if other := _loaded_from_elsewhere(imports.files):
            raise CampaignUnusable([Wrong("simulator.name", name, other)])
    return InProcess(call, *basics, files)


def _loaded_from_elsewhere(files: Mapping[str, Path]) -> str:
    """A sentence on the first module that this process has loaded from another file than these; empty if none."""
    for name, path in files.items():
        file = getattr(sys.modules.get(name), "__file__", None)
        if file is not None and Path(file).resolve() != path.resolve():
            return (
                f"it imports {name} of {path}, but this process has loaded {file}: rename one, or declare isolated=True"
            )
    return ""


def _program(simulator: Described, opening: Opening) -> CommandSimulator:
    """A program or an FMU, by its descriptor as it is now, which must still be the one that the catalogue shows."""
    described, changed = simulator, ""
    files = Unchanged(described.covered)  # before anything of them is read
    if isinstance(described, InlineProgram):
        return CommandSimulator(described, opening, unchanged=files)
    try:
        described = read(described.folder)
        if described.entry != simulator.entry:
            changed = (
                "its descriptor has other parameters or results than when this process started: start the run again"
            )
    except BadDescriptor as error:
        changed = f"its descriptor cannot be used any more: {error}"
    if changed:
        raise CampaignUnusable([Wrong("simulator.name", simulator.entry.name, changed)])
    if not isinstance(described, DescribedFmu):
        return CommandSimulator(described, opening, unchanged=files)
    try:
        return fmus.opened(described, opening, files)
    except fmus.FmuUnusable as error:
        raise CampaignUnusable([Wrong("simulator.name", simulator.entry.name, str(error))]) from None


def _undeclared(opened: object, nominal: Mapping[str, float], result: str) -> str:
    """The first difference between an opened simulator and its declaration; empty if there is none."""
    if not isinstance(opened, System):
        return f"its `open` must return a worker.engine.systems.base.System, not {type(opened).__name__}"
    if {p.path: p.nominal for p in opened.parameters} != nominal:
        return "its parameters differ from those that its package declares, or from the requested nominal values"
    if opened.results[0].name != result or opened.results[0].worse != "low":
        return f"its first result must be {result}, worse when low, not {opened.results[0].name}"
    return ""
