"""Checks at the start of a run that components which are not shipped give the same result twice: `check`.

Searches, resumed runs and replays rest on it. Simulators and functions are measured in the nominal stage instead.
"""

from __future__ import annotations

import numpy as np

from campaigns import Campaign
from campaigns.asked.problem import Problem as Wrong
from campaigns.catalogue import Role
from campaigns.checked.check import parts
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import CampaignUnusable
from worker.running.catalogue import installed
from worker.running.runs.sources import OWN, within

SHIPPED = "worker.engine.components"


def check(campaign: Campaign, problem: Problem) -> None:
    """Simulate the nominal case again and again; raises `CampaignUnusable` if the bits differ."""
    others = [f"{role} {part.component}" for _, _, role, part in parts(campaign) if not shipped(role, part.component)]
    if not others:
        return
    system = problem.system
    batches = [system.evaluate(np.repeat(system.nominal[None, :], count, axis=0))[0] for count in (2, 1)]
    costs, status = (np.concatenate([getattr(b, name) for b in batches]) for name in ("costs", "status"))
    traces = [system.trace("nominal", {}) for _ in range(2)]
    bits = (
        {row.tobytes() for row in costs},
        {*status.tolist()},
        {None if t is None else t.data.tobytes() for t in traces},
    )
    if any(len(different) > 1 for different in bits):
        text = (
            "the nominal case, simulated several times, gave different results: a component is random or keeps state, "
            "so that no evaluation could be repeated; `clearance component check` finds most causes"
        )
        raise CampaignUnusable([Wrong("scenario", ", ".join(dict.fromkeys(others)), text)])


def shipped(role: Role, name: str) -> bool:
    """Whether a component is one of those that are shipped."""
    home = installed.source_of(installed.components()[role, name]).__name__
    return within(home, SHIPPED) and not within(home, OWN)
