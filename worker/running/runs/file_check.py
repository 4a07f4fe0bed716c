"""The last look at the files of a simulator before evaluations of it, or results made of them, are stored.

A simulator looks at its files only now and then: what it evaluates between a change and its next look has a value, and
what is requested after that look has failed. Neither is stored.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from campaigns.asked.problem import Problem as Wrong
from campaigns.stored.blocks import Block
from campaigns.stored.records import Ahead, Columns
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.store import Store
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.simulators.simulated import Simulated


class FilesChanged(CampaignUnusable):
    """The files have changed since the run opened them; everything that is stored is of the files before.

    A run that is opened again is then compared with the files as they are.
    """


def check(problem: Problem) -> None:
    """Raise `FilesChanged` if the files have changed since the run opened them, or `CampaignUnusable` if they have on a
    node that evaluates, of which evaluations may have been stored meanwhile."""
    check_here(problem)
    if isinstance(problem.system, Simulated) and (changed := problem.system.changed(everywhere=True)):
        raise CampaignUnusable([_wrong(problem, changed)])


def check_here(problem: Problem) -> None:
    """The same for the files of this machine alone."""
    if isinstance(problem.system, Simulated) and (changed := problem.system.changed(now=True)):
        raise FilesChanged([_wrong(problem, changed)])


def _wrong(problem: Problem, changed: str) -> Wrong:
    simulator = problem.campaign.simulator
    return Wrong("simulator.name", simulator.name if simulator else "", changed)


class Checked:
    """A `Store` that stores no evaluation and no block without a look at the files."""

    def __init__(self, store: Store, problem: Problem) -> None:
        self._store, self._problem = store, problem

    def __getattr__(self, name: str) -> Any:
        return getattr(self._store, name)

    def append(self, position: int, first: int, columns: Columns, ahead: Ahead | None = None) -> None:
        check_here(self._problem)
        self._store.append(position, first, columns, *([] if ahead is None else [ahead]))

    def keep(self, position: int, columns: Columns) -> None:
        check_here(self._problem)
        self._store.keep(position, columns)

    def count(self, position: int, blocks: Sequence[Block]) -> None:
        check(self._problem)
        self._store.count(position, blocks)
