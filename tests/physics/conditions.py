"""Single faults and environment components in a loop, for tests of their stated effects."""

from __future__ import annotations

from typing import Any

from campaigns import Campaign, library, load_file
from clearance.testing.problems import Problem
from tests.physics.scenes import changed, uncompiled
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Environment, Fault
from worker.running.catalogue.installed import components

CASE = load_file(library()["unicycle_static"])
FAULTS = {name: part for (role, name), part in components().items() if isinstance(part, Fault)}
PARTS = FAULTS | {name: part for (_, name), part in components().items() if isinstance(part, Environment)}


def short(campaign: Campaign, steps: int, *names: str, **given: float) -> Problem:
    """The campaign's loop for a few steps from its start, with these faults and environment in it."""
    scenario, inputs = campaign.scenario, components()["vehicle", campaign.scenario.vehicle.component].inputs
    faults: list[dict[str, Any]] = []
    around: list[dict[str, Any]] = []
    for name in names:
        part = PARTS[name]
        document = {"component": name, "parameters": given}
        if isinstance(part, Environment):
            around.append(document)
        elif part.path == "actuator":
            faults += [document | {"on": signal.name} for signal in inputs]
        else:
            faults.append(document)
    period = scenario.guidance.period or 5 * scenario.step * ("guidance_delay" in names)
    return uncompiled(
        changed(
            campaign,
            faults=faults,
            environment=around,
            horizon=steps * scenario.step,
            guidance={"period": period},
        )
    )


def loop_with(name: str, on: str = "", scenario: dict[str, Any] | None = None, **parameters: float) -> Problem:
    """Case 1 with one fault or part of the environment, in plain Python."""
    part = {"component": name, "parameters": parameters} | ({"on": on} if on else {})
    where = "environment" if isinstance(PARTS[name], Environment) else "faults"
    return uncompiled(changed(CASE, **{where: [part]}, **(scenario or {})))


def parameters(part: Fault | Environment, **given: float) -> Any:
    """A component's parameters, or the constants it derives from them, the rest at their defaults."""
    fields = part.parameters(**given)
    return fields if part.derived is None else part.derived.constants(*plain(part.derived.derive)(fields, ()))
