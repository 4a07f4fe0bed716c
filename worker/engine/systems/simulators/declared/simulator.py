"""The declaration of a simulator: its catalogue entry and the function that opens it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from campaigns.catalogue import SimulatorEntry


@dataclass(frozen=True)
class Opening:
    """What a campaign requests from a simulator: nominal values by path (simulator.x), and the deciding result."""

    nominal: Mapping[str, float]
    result: str


@dataclass(frozen=True)
class Simulator:
    """A simulator of an installed package: the attribute `simulator` of an entry point in group `clearance.simulators`.

    `open` returns a `worker.engine.systems.base.System`. Its parameter paths are `simulator.` plus the parameter names;
    its first result is the requested one.
    """

    entry: SimulatorEntry
    open: Callable[[Opening], Any]
