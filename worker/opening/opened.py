"""Creates the system that a campaign names, and its problem; raises `CampaignUnusable` if that is not possible.

Start reading at `problem`.
"""

from __future__ import annotations

from collections.abc import Mapping

from campaigns import Campaign
from campaigns.asked.problem import Problem as Wrong
from campaigns.asked.spec import Simulator
from campaigns.checked.check import flyable, parameters
from worker.catalogue.descriptor import BadDescriptor, read
from worker.catalogue.installed import catalogue, simulators
from worker.catalogue.simulator import Opening, Program
from worker.problem.problem import Problem
from worker.reference import Reference
from worker.systems.base import CampaignUnusable, System
from worker.systems.closed_loop.assemble import LANES
from worker.systems.closed_loop.system import ClosedLoop
from worker.systems.simulators.called import Called
from worker.systems.simulators.command import CommandSimulator


def problem(campaign: Campaign) -> Problem:
    """The problem of a campaign, on the system that it names."""
    return Problem(campaign, system(campaign))


def system(campaign: Campaign) -> System:
    """The system that a campaign names."""
    return closed_loop(campaign) if campaign.simulator is None else _simulator(campaign, campaign.simulator)


def closed_loop(campaign: Campaign, compiled: bool = True, lanes: int = LANES) -> ClosedLoop:
    """The closed loop of a campaign's scenario; in plain Python unless `compiled`."""
    return ClosedLoop(campaign, Reference, compiled, lanes)


def _simulator(campaign: Campaign, asked: Simulator) -> System:
    """Open a simulator of this installation and check it against its declaration."""
    problems = flyable(campaign, catalogue())
    if problems:
        raise CampaignUnusable(problems)
    nominal = {path: value for path, (_, value) in parameters(campaign, catalogue()).items()}
    result = campaign.criterion.result or ""
    simulator, opening = simulators()[asked.name], Opening(nominal, result)
    opened = _program(simulator, opening) if isinstance(simulator, Program) else simulator.open(opening)
    wrong = _undeclared(opened, nominal, result)
    if wrong:
        raise CampaignUnusable([Wrong("simulator.name", asked.name, wrong)])
    found: System = opened
    return Called(found, asked) if asked.calls > 1 or asked.retries else found


def _program(simulator: Program, opening: Opening) -> CommandSimulator:
    """A program, by its descriptor as it is now, which must still be the one that the catalogue shows."""
    described, changed = simulator.described, ""
    try:
        described = read(described.folder)
        if described.entry != simulator.entry:
            changed = (
                "its descriptor has other parameters or results than when this process started: restart the worker"
            )
    except BadDescriptor as error:
        changed = f"its descriptor cannot be used any more: {error}"
    if changed:
        raise CampaignUnusable([Wrong("simulator.name", simulator.entry.name, changed)])
    return CommandSimulator(described, opening)


def _undeclared(opened: object, nominal: Mapping[str, float], result: str) -> str:
    """The first difference between an opened simulator and its declaration; empty if there is none."""
    if not isinstance(opened, System):
        return f"its `open` must return a worker.systems.base.System, not {type(opened).__name__}"
    if {p.path: p.nominal for p in opened.parameters} != nominal:
        return "its parameters differ from those that its package declares, or from the requested nominal values"
    if opened.results[0].name != result or opened.results[0].worse != "low":
        return f"its first result must be {result}, worse when low, not {opened.results[0].name}"
    return ""
