"""The last look at the files of a simulator before results of its evaluations are stored.

A simulator looks at its files only now and then: what it evaluates between a change and its next look has a value.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from campaigns.asked.problem import Problem as Wrong
from campaigns.stored.blocks import Block
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.store import Store
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.simulators.simulated import Simulated


def check(problem: Problem) -> None:
    """Raise `CampaignUnusable` if the files have changed since the run opened them, here or on a node that
    evaluates."""
    system, simulator = problem.system, problem.campaign.simulator
    if isinstance(system, Simulated) and (changed := system.changed(now=True, everywhere=True)):
        raise CampaignUnusable([Wrong("simulator.name", simulator.name if simulator else "", changed)])


class Assisted:
    """The `Store` of a worker that assists: it stores no block without a look, as it does not end the stage."""

    def __init__(self, store: Store, problem: Problem) -> None:
        self._store, self._problem = store, problem

    def __getattr__(self, name: str) -> Any:
        return getattr(self._store, name)

    def count(self, position: int, blocks: Sequence[Block]) -> None:
        check(self._problem)
        self._store.count(position, blocks)
