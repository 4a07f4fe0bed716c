"""From a campaign to the system that it names, and to its problem; raises `CampaignUnusable` where there is none.

Start reading at `problem`.
"""

from __future__ import annotations

from collections.abc import Mapping

from campaigns import Campaign
from campaigns.asked.problem import Problem as Wrong
from campaigns.asked.spec import Simulator
from campaigns.checked.check import flyable, parameters
from worker.catalogue.installed import catalogue, simulators
from worker.catalogue.simulator import Opening
from worker.problem.problem import Problem
from worker.reference import Reference
from worker.systems.base import CampaignUnusable, System
from worker.systems.closed_loop.assemble import LANES
from worker.systems.closed_loop.system import ClosedLoop


def problem(campaign: Campaign) -> Problem:
    """The problem of a campaign, with the system that it names."""
    return Problem(campaign, system(campaign))


def system(campaign: Campaign) -> System:
    """The system that a campaign names."""
    return closed_loop(campaign) if campaign.simulator is None else _simulator(campaign, campaign.simulator)


def closed_loop(campaign: Campaign, compiled: bool = True, lanes: int = LANES) -> ClosedLoop:
    """The closed loop of a campaign's scenario; in plain Python unless `compiled`."""
    return ClosedLoop(campaign, Reference, compiled, lanes)


def _simulator(campaign: Campaign, asked: Simulator) -> System:
    """A simulator of this installation, opened; what it returns must be what it declares."""
    problems = flyable(campaign, catalogue())
    if problems:
        raise CampaignUnusable(problems)
    nominal = {path: value for path, (_, value) in parameters(campaign, catalogue()).items()}
    result = campaign.criterion.result or ""
    opened = simulators()[asked.name].open(Opening(nominal, result))
    wrong = _undeclared(opened, nominal, result)
    if wrong:
        raise CampaignUnusable([Wrong("simulator.name", asked.name, wrong)])
    found: System = opened
    return found


def _undeclared(opened: object, nominal: Mapping[str, float], result: str) -> str:
    """What of an opened simulator is not as its package declares it; empty where all is."""
    if not isinstance(opened, System):
        return f"its package opens {type(opened).__name__}, which is not a worker.systems.base.System"
    if {p.path: p.nominal for p in opened.parameters} != nominal:
        return "its parameters are not those that its package declares, at the values asked for"
    if opened.results[0].name != result or opened.results[0].worse != "low":
        return f"its first result is {opened.results[0].name}, not {result}"
    if not opened.repeatable:
        return "it does not repeat bit by bit, which searches and replays rely on here"
    return ""
