"""The closed loop of components as a `worker.engine.systems.base.System`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from numba.core.errors import NumbaError

from campaigns import Campaign
from campaigns.results.validate import Beyond
from campaigns.stored.records import Trace
from worker.engine.search.base import Batch
from worker.engine.systems.base import (
    CampaignUnusable,
    Comparison,
    ComponentLoop,
    Confirmed,
    Floats,
    Parameter,
    PolynomialLoop,
    Reasons,
    Seeds,
    Settings,
    Shown,
    Stopping,
)
from worker.engine.systems.closed_loop import about_trim, beyond, confirm, encounter, refused
from worker.engine.systems.closed_loop.assemble import LANES
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.parts import Installed
from worker.engine.systems.closed_loop.realisations import Realisations
from worker.engine.systems.closed_loop.trace import trace


class ClosedLoop(Flights, ComponentLoop):
    """The closed loop of one campaign's scenario; repeatable to the bit on the same kind of machine."""

    realisations: Realisations

    def __init__(
        self,
        campaign: Campaign,
        installed: Installed,
        integrating: confirm.Integrating,
        compiled: bool = True,
        lanes: int = LANES,
    ) -> None:
        """integrating: the reference integrator, which is built on top of this package and therefore injected."""
        super().__init__(campaign, installed, compiled, lanes)
        self._integrating = integrating
        declared = [(f"{s.prefix}.{p.name}", p) for s in self.loop.sections for p in s.parameters]
        self.parameters = tuple(
            Parameter(path, p.unit, float(self.nominal[k]), p.low, p.high, p.text, p.symbol)
            for k, (path, p) in enumerate(declared)
        )
        self.settings = Settings(lanes, self.step, "RK4")

    @property
    def digest(self) -> str:
        """The digest of the compiled loop."""
        return self.loop.digest

    @property
    def reference(self) -> str:
        """The name of the reference integrator."""
        return self._integrating(self).name

    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        return self.simulate_vectors(vectors, seeds=seeds)

    def confirm(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Confirmed]:
        return confirm.confirmed(self, self._integrating, vectors, seeds, cancelled)

    def compare(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Comparison]:
        return confirm.compared(self, self._integrating, vectors, seeds, cancelled)

    def trace(self, name: str, values: Mapping[str, float], seed: int | None = None) -> Trace:
        return trace(self.under(seed), name, values)

    def encounter(self, nominal: Trace | None) -> Shown | None:
        return None if nominal is None else encounter.shown(self, nominal)

    def beyond(
        self, names: Sequence[str], vectors: Floats, seeds: Sequence[int | None], below: float, cancelled: Stopping
    ) -> Beyond | None:
        return beyond.met(self, names, vectors, seeds, below, cancelled)

    def about_trim(self) -> PolynomialLoop | None:
        return about_trim.about_trim(self)

    def warm(self) -> None:
        """Compile; a component that the compiler refuses raises `CampaignUnusable` with file, line and sentence."""
        try:
            self.loop.warm()
        except NumbaError as error:
            raise CampaignUnusable([refused.by_compiler(error)]) from None

    @property
    def source(self) -> Path:
        """The Python file that an evaluation executes."""
        return Path(str(self.loop.module.__file__))
