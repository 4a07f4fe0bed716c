"""How a package declares a simulator: its entry in the catalogue, and what opens it. Start reading at `Simulator`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from campaigns.catalogue import SimulatorEntry


@dataclass(frozen=True)
class Opening:
    """What a campaign asks of a simulator: nominal values by path (simulator.x), and the result that decides."""

    nominal: Mapping[str, float]
    result: str


@dataclass(frozen=True)
class Simulator:
    """A simulator of an installed package: `simulator` in a module that an entry point of `clearance.simulators` names.

    `open` returns a `worker.systems.base.System` whose paths are `simulator.` and the names of the parameters, and
    whose first result is the one asked for.
    """

    entry: SimulatorEntry
    open: Callable[[Opening], Any]
