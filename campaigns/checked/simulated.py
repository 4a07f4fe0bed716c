"""Validates a campaign that names a simulator: the simulator, its parameters and the deciding result."""

from __future__ import annotations

from collections.abc import Iterator

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign, Simulator
from campaigns.catalogue import Catalogue, ParameterEntry, SimulatorEntry
from campaigns.checked import limits, texts

PREFIX = "simulator"
"""The prefix of its parameters' paths: simulator.x."""
NONE = "it has none: name the folder that contains the simulator's own folder in CLEARANCE_SIMULATORS"


def simulated(campaign: Campaign, simulator: Simulator, catalogue: Catalogue) -> Iterator[Problem]:
    """The problems with the simulator that a campaign names, and with fields that only a scenario has."""
    entry = catalogue.simulator(simulator.name)
    if entry is None:
        names = [s.name for s in catalogue.simulators]
        text = f"no such simulator in this installation; {texts.known(simulator.name, names) if names else NONE}"
        yield Problem("simulator.name", simulator.name, catalogue.why_not("simulator", simulator.name, text))
    else:
        yield from limits.refused("simulator.parameters", entry.parameters, simulator.parameters)
        yield from _decides(campaign, entry)
    if campaign.criterion.parameters:
        text = "a simulator's result has no parameters; remove this"
        yield Problem("criterion.parameters", str(campaign.criterion.parameters), text)
    if campaign.criterion.from_centre:
        yield Problem("criterion.from_centre", "true", "a simulator's result does not have this option; remove it")
    if campaign.objectives:
        text = "further criteria are components of a scenario; remove this for a simulator"
        yield Problem("objectives", f"{len(campaign.objectives)} objectives", text)
    for name in campaign.encounter.intended:
        if name != "influence":
            text = "this check does not apply to a simulator, which models no encounter; remove this"
            yield Problem(f"encounter.intended.{name}", name, text)


def parameters(campaign: Campaign, catalogue: Catalogue) -> dict[str, tuple[ParameterEntry, float]]:
    """Every parameter of the simulator by path, with its entry and nominal value; empty for an unknown one."""
    simulator = campaign.simulator
    entry = None if simulator is None else catalogue.simulator(simulator.name)
    return {} if simulator is None or entry is None else limits.valued(PREFIX, entry.parameters, simulator.parameters)


def _decides(campaign: Campaign, entry: SimulatorEntry) -> Iterator[Problem]:
    name = campaign.criterion.result or ""
    result = entry.result(name)
    if result is None:
        text = f"no such result of {entry.name}; {texts.known(name, [r.name for r in entry.results])}"
        yield Problem("criterion.result", name, text)
    elif result.worse == "high":
        others = ", ".join(r.name for r in entry.results if r.worse == "low") or "it has none"
        text = f"this is worse when high and cannot decide; name one that is worse when low ({others})"
        yield Problem("criterion.result", name, text)
