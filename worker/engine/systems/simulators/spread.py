"""The base of simulators whose slots are here or, if this process has an evaluator, on the nodes of a cluster."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING

from worker.engine.systems.simulators.cluster.address import Evaluator
from worker.engine.systems.simulators.cluster.work import WORK, Files
from worker.engine.systems.simulators.pooled import Pooled

if TYPE_CHECKING:
    from worker.engine.systems.simulators.cluster.pool import DaskPool
    from worker.engine.systems.simulators.slots.pool import SlotPool


class Spread(Pooled):
    """A simulator of which each evaluation is one request to a slot of this machine or of a node."""

    evaluator: Evaluator | None = None

    def _spread_over(self, evaluator: Evaluator | None) -> None:
        """Evaluate there; None: here."""
        self.evaluator = evaluator
        self.elsewhere = "dask.distributed" if evaluator and evaluator.scheduler else ""

    @property
    @abstractmethod
    def _slots_here(self) -> int:
        """Processes side by side on this machine."""

    @property
    @abstractmethod
    def _files(self) -> Files:
        """What every node must have as it is here."""

    @property
    def slots(self) -> int:
        return self._slots_here if self.evaluator is None else self._opened().size

    @property
    def longest(self) -> float:
        return super().longest + (0.0 if self.evaluator is None else self.evaluator.patience)

    def changed(self, now: bool = False, everywhere: bool = False) -> str:
        found = super().changed(now)
        return found or (self._pool.changed() if everywhere and self._pool is not None else "")

    def warm(self) -> None:
        """Connect to the evaluator."""
        if self.evaluator is not None:
            self._opened()

    def _opened(self) -> SlotPool | DaskPool:
        if self.evaluator is None or self._pool is not None:
            return super()._opened()
        from worker.engine.systems.simulators.cluster.pool import DaskPool

        self._pool = DaskPool(self.evaluator, self._program(Path(WORK)), self._limits, self._files)
        return self._pool
