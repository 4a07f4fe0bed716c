"""The components that a campaign names, and the nominal values of their parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from campaigns import Campaign
from campaigns.asked.criteria import named
from campaigns.asked.load import Problem as Wrong
from campaigns.asked.spec import Part
from campaigns.catalogue import Catalogue, Role
from worker.engine.kernels.component import Component, NoTrim
from worker.engine.kernels.layout import Parts, Placed, Section
from worker.engine.systems.base import CampaignUnusable, Floats, Result


class Installed(NamedTuple):
    """What is installed: the components by role and name, and the same described as data."""

    components: Mapping[tuple[Role, str], Component]
    catalogue: Catalogue


def parts_of(campaign: Campaign, known: Mapping[tuple[Role, str], Component]) -> Parts:
    """The components that a checked campaign names."""
    scenario = campaign.given_scenario
    vehicle: Any = known["vehicle", scenario.vehicle.component]
    inputs = [s.name for s in vehicle.inputs]

    def several(role: Role, parts: Sequence[Part]) -> tuple[Any, ...]:
        return tuple(known[role, part.component] for part in parts)

    return Parts(
        vehicle,
        several("controller", [scenario.controller])[0],
        several("avoider", [scenario.avoider])[0],
        several("obstacle", scenario.obstacles),
        known["criterion", campaign.criterion.component],  # type: ignore[arg-type]
        several("environment", scenario.environment),
        tuple(
            Placed(fault, inputs.index(part.on) if part.on else 0)
            for fault, part in zip(several("fault", scenario.faults), scenario.faults, strict=True)
        ),
        sampled=scenario.guidance.period > 0,
        objectives=several("criterion", campaign.objectives),
    )


def results_of(parts: Parts) -> tuple[Result, ...]:
    """The criteria as results, the deciding one first; names are unique."""
    criteria = tuple(parts.criteria.values())
    names = named(criterion.name for criterion in criteria)
    return tuple(Result(n, c.title, c.quantity, c.unit, c.worse) for n, c in zip(names, criteria, strict=True))


def nominal_of(campaign: Campaign, parts: Parts, sections: Sequence[Section]) -> Floats:
    """The flat vector of nominal values, followed by the vehicle's trim; raises `CampaignUnusable` without a trim."""
    scenario, stated = campaign.given_scenario, {}
    stated["vehicle"] = scenario.vehicle.parameters
    stated["controller"] = scenario.controller.parameters
    stated["avoider"] = scenario.avoider.parameters
    stated["start"], stated["goal"] = scenario.start, scenario.goal
    stated["criterion"] = {**campaign.criterion.parameters, "threshold": campaign.criterion.threshold}
    # Further criteria have no threshold; the value for components that declare one is not used.
    for i, objective in enumerate(campaign.objectives):
        stated[f"objectives.{i}"] = {"threshold": 0.0, **objective.parameters}
    for name in ("obstacles", "environment", "faults"):
        stated |= {f"{name}.{i}": part.parameters for i, part in enumerate(getattr(scenario, name))}
    values = {f"{s.prefix}.{p.name}": _nominal(p, stated[s.prefix]) for s in sections for p in s.parameters}
    try:
        return np.array([*values.values(), *(parts.vehicle.trim.solve(values) if parts.vehicle.trim else ())])
    except NoTrim as error:
        raise CampaignUnusable([Wrong("scenario.vehicle", parts.vehicle.name, str(error))]) from None


def _nominal(parameter: Any, stated: Mapping[str, float]) -> float:
    value = stated.get(parameter.name, parameter.default)
    assert value is not None, f"{parameter.name} is required; check() reports it"
    return float(value)
