"""Simulators that do not repeat, each in another way, in this process.

d = 10 - 3 a - (b - 0.5)^2 + what the adversary adds; an instance is a process, `fresh` starts another one.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from campaigns.catalogue import ParameterEntry, ResultEntry, SimulatorEntry
from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from worker.engine.search.base import Batch
from worker.engine.systems.base import Floats, Reasons, Seeds
from worker.engine.systems.simulators.declared.simulator import Opening, Simulator
from worker.engine.systems.simulators.simulated import Simulated
from worker.running.catalogue import installed

ENTRY = SimulatorEntry(
    name="adversary",
    title="Adversary",
    text=__doc__ or "",
    parameters=[
        ParameterEntry(name=name, symbol=name, unit="", low=0.0, high=1.0, default=0.5, text=f"Parameter {name}")
        for name in "ab"
    ],
    results=[ResultEntry(name="d", title="Distance", quantity="d", unit="m", worse="low")],
)


@dataclass
class Call:
    """One call: its point, its number in its process and in the whole run, the process, and the run's own chance."""

    a: float
    b: float
    number: int
    total: int
    process: int
    chance: np.random.Generator


@dataclass
class World:
    """What all processes of a run share."""

    chance: np.random.Generator = field(default_factory=lambda: np.random.default_rng(7))
    calls: Iterator[int] = field(default_factory=lambda: itertools.count(1))
    processes: Iterator[int] = field(default_factory=lambda: itertools.count(1))


def _seeded(seed: int) -> float:
    return float(np.random.default_rng(seed).normal(0.0, 0.5))


SEARCHED = 2_500
"""Calls of the searches and a few more; which later one is the two hundredth depends on how many validation makes."""

ADVERSARIES: dict[str, Callable[[Call], float]] = {
    "none": lambda call: 0.0,
    "noise": lambda call: call.chance.normal(0.0, 0.3),
    "tiny noise": lambda call: call.chance.normal(0.0, 1e-13),
    "now and then too low": lambda call: -9.5 if call.total % 200 == 0 and call.total <= SEARCHED else 0.0,
    "now and then a little low": lambda call: -2.0 if call.total % 150 == 0 else 0.0,
    "drift": lambda call: 1e-4 * call.total,
    "noise in one corner": lambda call: call.chance.normal(0.0, 0.3) if call.a > 0.9 else 0.0,
    "noise of the process": lambda call: _seeded(call.process),
    "by call count": lambda call: _seeded(call.number),
    "seeded by time": lambda call: _seeded(call.total // 40),
    "rarely a violation": lambda call: -8.0 if call.a > 0.9 and call.chance.random() < 0.2 else 0.0,
    "violates in a fresh process": lambda call: -9.0 if call.process > 2 and call.a > 0.9 else 0.0,
    "a coin": lambda call: 0.0 if call.chance.random() < 0.5 else -0.5,
}


class Adversary(Simulated):
    """Evaluates the formula, one call at a time."""

    add: Callable[[Call], float] = ADVERSARIES["none"]
    lost: Callable[[Call], int] = staticmethod(lambda call: OK)
    world: World = World()
    started = 0

    def fresh(self) -> Adversary:
        return type(self)(self.entry, self.opening)

    def __init__(self, entry: SimulatorEntry, opening: Opening) -> None:
        super().__init__(entry, opening)
        self.process, self.number = next(self.world.processes), 0

    @property
    def digest(self) -> str:
        return "adversary" * 2

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        costs, status = np.full((len(vectors), 1), np.nan), np.zeros(len(vectors), dtype=np.uint8)
        reasons: Reasons = {}
        for k, (a, b) in enumerate(vectors.tolist()):
            self.number += 1
            call = Call(a, b, self.number, next(self.world.calls), self.process, self.world.chance)
            status[k] = type(self).lost(call)
            if status[k] == OK:
                costs[k, 0] = 10 - 3 * a - (b - 0.5) ** 2 + type(self).add(call)
            elif status[k] != EXCLUDED:
                reasons[k] = "no answer within 5 s" if status[k] == TIMEOUT else "its process ended with exit code 3"
        return Batch(costs, status), reasons


@contextmanager
def adversary(
    how: str = "none", lost: Callable[[Call], int] | None = None, declared: bool = True
) -> Iterator[type[Adversary]]:
    """The simulator `adversary` of this installation, in a world of its own; lost: the status of each call."""
    body = {"add": staticmethod(ADVERSARIES[how]), "world": World(), "repeatable": declared}
    if lost is not None:
        body["lost"] = staticmethod(lost)
    made = type("Made", (Adversary,), body)
    installed.simulators()["adversary"] = Simulator(ENTRY, lambda opening: made(ENTRY, opening))
    installed.catalogue.cache_clear()
    try:
        yield made
    finally:
        del installed.simulators()["adversary"]
        installed.catalogue.cache_clear()


def never(call: Call) -> int:
    """Every call fails."""
    return FAILED
